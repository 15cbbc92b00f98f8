// PlaceTask: what packing needs of the place of a robot and an aligner, by lengths and heights.
#include "snug/runs/internal/place_task.hpp"

#include <algorithm>
#include <numbers>
#include <optional>

#include "snug/core/input_error.hpp"
#include "snug/cup/pick_length.hpp"
#include "snug/geometry/bounds.hpp"
#include "snug/model/pose_edit.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/runs/internal/reach_points.hpp"

namespace snug::runs::internal {
namespace {

constexpr int kPointsAcross = 4;      ///< of the container, along each of its edges
constexpr double kSameLevel = 0.005;  ///< m
constexpr double kSameTop = 0.01;     ///< m: picks so near to each other are one

bool moves_with_robot(const PlaceOptions& options, const model::Body& body) {
  return std::ranges::find(options.stand_with_robot, body.name) != options.stand_with_robot.end();
}

void check_bodies(const model::Scenario& scenario, const PlaceOptions& options) {
  std::vector<std::string> names;
  for (const model::Body& one : scenario.bodies)
    if (one.kind == model::BodyKind::Static) names.push_back(one.name);
  for (const std::string& name : options.stand_with_robot) {
    if (std::ranges::find(names, name) != names.end()) continue;
    const std::string_view nearest = find_nearest(name, names);
    throw InputError("command line", "--with", "'" + name + "'",
                     "a static body of the scenario" +
                         (nearest.empty() ? std::string() : ", nearest is '" + std::string(nearest) + "'"));
  }
}

/// As near to the walls as the smallest box allows.
std::vector<Eigen::Vector2d> points_of(const model::Container& container, double least) {
  std::vector<Eigen::Vector2d> points;
  const Eigen::Vector2d half = (0.5 * container.inner_size.head<2>().array() - least).max(0.0);
  const auto share = [](int i) { return 2.0 * i / (kPointsAcross - 1) - 1.0; };
  for (int row = 0; row < kPointsAcross; ++row)
    for (int column = 0; column < kPointsAcross; ++column)
      points.emplace_back((container.X_WT * Vector3(share(column) * half.x(), share(row) * half.y(), 0.0)).head<2>());
  return points;
}

void find_ground(const model::Scenario& scenario, const PlaceOptions& options, PlaceTask& task) {
  for (const model::Body& body : scenario.bodies) {
    if (body.kind != model::BodyKind::Static || moves_with_robot(options, body)) continue;
    for (const model::PlacedShape& placed : body.shapes) {
      const geometry::Aabb box = geometry::bounds(placed.shape, body.X_WB * placed.X_BG);
      const Footprint outline{0.5 * (box.lower + box.upper).head<2>(), 0.5 * (box.upper - box.lower).head<2>(), 0.0};
      const double above = box.upper.z() - scenario.aligner->support_height;
      if (std::abs(above) <= kSameLevel) task.carrying.push_back(outline);
      if (above > kSameLevel) task.blocking.push_back(outline);
    }
  }
}

}  // namespace

Footprint PlaceTask::outline_of(const CornerPlace& corner) const {
  return {corner.p_W + Eigen::Rotation2Dd(corner.yaw) * Eigen::Vector2d(0.5 * stand), 0.5 * stand, corner.yaw};
}

Eigen::Vector2d PlaceTask::pick_middle(const CornerPlace& corner) const {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Vector3& p_A : picks_A) sum += corner.at(p_A);
  return sum / static_cast<double>(picks_A.size());
}

bool PlaceTask::is_free(const CornerPlace& corner) const {
  const Footprint outline = outline_of(corner);
  const auto is_in = [&](const Footprint& other) { return outline.is_near(other, 0.0); };
  if (outline.is_near(container, kFreeBetween) || std::ranges::any_of(blocking, is_in)) return false;
  return carrying.empty() || std::ranges::any_of(carrying, [&](const Footprint& face) { return face.holds(outline); });
}

PlaceTask make_place_task(const model::Scenario& scenario, const PlaceOptions& options) {
  const auto [container, tool_yaw] = find_target(scenario);
  if (!scenario.aligner) throw InputError(scenario.source_name, "aligner", "", "an aligner, to find its place");
  const std::vector<StandingItem> items = find_items(scenario);
  if (items.empty()) throw InputError(scenario.source_name, "sequences", "", "items that are picked at the aligner");
  check_bodies(scenario, options);

  PlaceTask task;
  task.tool_yaw = tool_yaw;
  task.pick_length = cup::pick_length(scenario.cup);
  task.X_WT = container->X_WT;
  const double wall = container->has_walls ? container->wall_thickness : 0.0;
  task.container = {container->X_WT.p.head<2>(), (0.5 * container->inner_size.head<2>().array() + wall).matrix(),
                    model::yaw_about_vertical(container->X_WT.R)};
  task.heights = layer_heights(*container, items);
  for (double& height : task.heights) height += scenario.cup.hold_length;
  task.heights.back() += scenario.skills.travel.clearance;
  task.stand.setZero();
  double least = items.front().size.x();
  for (const StandingItem& item : items) {
    task.picks_A.push_back(scenario.aligner->X_WA.inverse() * item.top);
    task.stand = task.stand.cwiseMax(2.0 * task.picks_A.back().head<2>());
    least = std::min({least, item.size.x(), item.size.y()});
  }
  const auto [low, high] = std::ranges::minmax(items, {}, &StandingItem::height);
  task.lowest_pick = low.height() + task.pick_length;
  task.highest_pick = high.height() + task.pick_length + kOverPick;
  task.points = points_of(*container, 0.5 * least);
  find_ground(scenario, options, task);
  return task;
}

std::vector<NeededPose> find_needed(const model::Scenario& scenario, const PlaceTask& task) {
  std::vector<NeededPose> all;
  for (const double turn : {0.0, 0.5 * std::numbers::pi}) {
    const Matrix3 R_WE = motion::upright_tool(task.tool_yaw + turn);
    for (const Eigen::Vector2d& point : task.points) {
      const auto over_floor = [&](double height) {
        return Pose{R_WE, {point.x(), point.y(), task.X_WT.p.z() + height}};
      };
      for (const double height : task.heights)
        all.push_back({over_floor(height), over_floor(task.heights.back()), "container"});
    }
    std::vector<Vector3> tops;
    for (const StandingItem& item : find_items(scenario)) {
      const auto is_same = [&](const Vector3& top) { return (top - item.top).norm() < kSameTop; };
      if (std::ranges::any_of(tops, is_same)) continue;
      tops.push_back(item.top);
      const Vector3 p_WE = item.top + Vector3(0.0, 0.0, task.pick_length);
      all.push_back({{R_WE, p_WE}, {R_WE, p_WE + Vector3(0.0, 0.0, kOverPick)}, "pick of " + item.name});
    }
  }
  return all;
}

}  // namespace snug::runs::internal
