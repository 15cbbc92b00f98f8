// Reach: whether the scenario's robot can bring a box to a place, by its joints alone.
#include "snug/planning/reach.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <utility>

#include "snug/motion/tool_yaw.hpp"
#include "snug/robot/inverse.hpp"
#include "snug/robot/load_arm.hpp"

namespace snug::planning {
namespace {

constexpr int kPosesAlongWay = 16;  ///< asked for between begin and end

class Reach {
 public:
  Reach(const model::Scenario& scenario, skills::CellLayout layout, const model::Sequence& sequence, ToolReach reaches)
      : layout_(std::move(layout)),
        cup_(scenario.cup),
        seal_margin_(scenario.skills.pick.seal_margin),
        reaches_(std::move(reaches)) {
    for (std::size_t i = 0; i < sequence.items.size(); ++i) {
      boxes_[sequence.items[i].parcel] = skills::make_planned_box(scenario, sequence, model::ItemIndex(i));
    }
  }

  [[nodiscard]] bool can(const packing::Placement& placement) const {
    const auto found = boxes_.find(placement.item);
    if (found == boxes_.end()) return true;
    const skills::PlannedBox& box = found->second;
    const Pose X_WP = layout_.X_WT * placement.X_TP;
    const double height = -2.0 * skills::lowest_corner(X_WP.R, box.size);
    Pose X_WE{motion::upright_tool(layout_.neutral_yaw), X_WP.p + X_WP.R * cup_offset(cup_, seal_margin_, box, X_WP.R)};
    for (const double bottom : {X_WP.p.z() - 0.5 * height, travel_bottom(layout_, 0.0)}) {
      X_WE.p.z() = bottom + height + cup_.hold_length;
      if (!reaches_({X_WE, X_WE})) return false;
    }
    return true;
  }

 private:
  skills::CellLayout layout_;
  model::CupParams cup_;
  double seal_margin_;
  ToolReach reaches_;
  std::map<std::string, skills::PlannedBox> boxes_;
};

}  // namespace

ToolReach make_tool_reach(const model::Scenario& scenario) {
  std::error_code error;
  if (!scenario.robot || !std::filesystem::exists(robot::urdf_path(scenario), error)) return {};
  const auto inverse = std::make_shared<const robot::InverseKinematics>(robot::load_arm(scenario));
  const robot::JointVector posture = robot::joint_vector(scenario.robot->posture);
  return [inverse, posture](const motion::Way& way) {
    const auto first = inverse->nearest(way.start(), posture);
    if (!first) return false;
    robot::JointVector q = *first;
    for (int i = 1; way.is_motion() && i <= kPosesAlongWay; ++i) {
      const auto next = inverse->refine(way.at(static_cast<double>(i) / kPosesAlongWay), q);
      if (!next) return false;
      q = *next;
    }
    return true;
  };
}

bool can_follow(const ToolReach& reaches, const skills::CellLayout& layout, const motion::Waypoint& before,
                std::span<const motion::Waypoint> waypoints) {
  if (!layout.is_fast || !reaches) return true;
  Pose X_WE = before.X_WE;
  return std::ranges::all_of(waypoints, [&](const motion::Waypoint& one) {
    const Pose X_WE_before = std::exchange(X_WE, one.X_WE);
    return motion::is_contact(one.motion_class) || reaches({X_WE_before, X_WE, layout.pan_axis});
  });
}

std::function<bool(const packing::Placement&)> make_reach(const model::Scenario& scenario,
                                                          const skills::CellLayout& layout,
                                                          const model::Sequence& sequence) {
  auto reaches = make_tool_reach(scenario);
  if (!reaches) return {};
  const auto reach = std::make_shared<const Reach>(scenario, layout, sequence, std::move(reaches));
  return [reach](const packing::Placement& placement) { return reach->can(placement); };
}

}  // namespace snug::planning
