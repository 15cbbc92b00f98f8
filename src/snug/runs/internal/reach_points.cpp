// Reach points: where the tool has to be for what packing does, whatever robot is to bring it there.
#include "snug/runs/internal/reach_points.hpp"

#include <algorithm>
#include <optional>

#include "snug/cell/aligner_feed.hpp"
#include "snug/core/input_error.hpp"
#include "snug/motion/tool_yaw.hpp"

namespace snug::runs::internal {

ReachTarget find_target(const model::Scenario& scenario) {
  const auto require = [&](bool is_there, const char* key, const char* expected) {
    if (!is_there) throw InputError(scenario.source_name, key, "", expected);
  };
  require(scenario.robot.has_value(), "robot", "a robot, to map what it reaches");
  require(scenario.tool.has_value(), "tool", "a tool, to map what it reaches");
  const model::Container* container = model::find_container(scenario, scenario.target);
  require(container != nullptr, "containers", "a container, to map what the tool reaches in it");
  const std::optional<double> yaw = motion::yaw_of(scenario.controller.X_WE_start.R);
  require(yaw.has_value(), "controller.start_pose", "a tool that points down");
  return {container, *yaw};
}

std::vector<StandingItem> find_items(const model::Scenario& scenario) {
  std::vector<StandingItem> items;
  if (!scenario.aligner) return items;
  for (const model::Sequence& sequence : scenario.sequences) {
    for (const model::Item& item : sequence.items) {
      const model::Parcel* parcel = model::find_parcel(scenario, item.parcel);
      if (parcel == nullptr) continue;
      const Pose X_WP = cell::pose_at_aligner(scenario, item, 0);
      const Vector3 size = X_WP.R.cwiseAbs() * model::collision_size(scenario, *parcel);
      items.push_back({item.parcel, X_WP.p + Vector3(0.0, 0.0, 0.5 * size.z()), size});
    }
  }
  return items;
}

std::array<double, 4> layer_heights(const model::Container& container, const std::vector<StandingItem>& items) {
  double low = 0.1, high = 0.1;
  if (!items.empty()) {
    const auto [least, most] = std::ranges::minmax(items, {}, &StandingItem::height);
    low = least.height();
    high = most.height();
  }
  const double rim = container.inner_size.z();
  low = std::min(low, rim);
  return {low, 0.5 * (low + rim), rim, rim + high};
}

}  // namespace snug::runs::internal
