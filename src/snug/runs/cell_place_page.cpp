// The page of a search for places: what was found, with a map of the best.
#include "snug/runs/cell_place_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "snug/geometry/bounds.hpp"
#include "snug/model/pose_edit.hpp"
#include "snug/report/floor_plan.hpp"
#include "snug/report/page.hpp"
#include "snug/report/table.hpp"
#include "snug/robot/load_arm.hpp"
#include "snug/runs/internal/place_task.hpp"
#include "snug/runs/internal/reach_points.hpp"
#include "snug/runs/reach_map.hpp"

namespace snug::runs {
namespace {

using report::Markup;

std::vector<Eigen::Vector2d> outline_in(const Pose& X_W, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  std::vector<Eigen::Vector2d> corners;
  for (const auto& [x, y] : {std::pair(low.x(), low.y()), std::pair(high.x(), low.y()), std::pair(high.x(), high.y()),
                             std::pair(low.x(), high.y())})
    corners.emplace_back((X_W * Vector3(x, y, 0.0)).head<2>());
  return corners;
}

/// Things larger than this are ground that reaches beyond the map.
constexpr double kLargestThing = 3.0;  // m

report::FloorPlan plan_of(const model::Scenario& scenario, const ReachMap& map, double reach) {
  report::FloorPlan plan;
  plan.about = "the cell from above";
  for (const model::Body& body : scenario.bodies) {
    if (body.kind != model::BodyKind::Static) continue;
    for (const model::PlacedShape& placed : body.shapes) {
      const geometry::Aabb box = geometry::bounds(placed.shape, body.X_WB * placed.X_BG);
      const Eigen::Vector2d low = box.lower.head<2>(), high = box.upper.head<2>();
      if ((high - low).maxCoeff() > kLargestThing) continue;
      const bool is_ground = box.upper.z() <= scenario.aligner->support_height + 0.005;
      plan.outlines.push_back(
          {body.name, outline_in(Pose{}, low, high), is_ground ? report::PlanInk::Ground : report::PlanInk::Thing});
    }
  }
  const Eigen::Vector2d half = 0.5 * map.inner_size.head<2>();
  plan.outlines.push_back({map.container, outline_in(map.X_WT, -half, half)});
  Eigen::Vector2d stand = Eigen::Vector2d::Zero();
  for (const ReachPick& pick : map.picks)
    stand = stand.cwiseMax(2.0 * (scenario.aligner->X_WA.inverse() * pick.p_WS).head<2>());
  plan.outlines.push_back(
      {"aligner", outline_in(scenario.aligner->X_WA, Eigen::Vector2d::Zero(), stand), report::PlanInk::Thing, true});
  const Eigen::Vector2d foot(internal::kHalfFoot, internal::kHalfFoot), base = scenario.robot->X_WB.p.head<2>();
  plan.outlines.push_back({map.robot, outline_in(scenario.robot->X_WB, -foot, foot), report::PlanInk::Robot, true});
  plan.circles.push_back({base, reach, "as far as the tool reaches, pointing down"});
  double least = half.minCoeff();
  for (const internal::StandingItem& item : internal::find_items(scenario))
    least = std::min({least, 0.5 * item.size.x(), 0.5 * item.size.y()});
  const auto is_reached = [](const ReachPoint& point) { return point.verdict == ReachVerdict::Reached; };
  for (int i = 0; i < map.columns * map.rows; ++i) {
    const Vector3 p_T((i % map.columns + 0.5) / map.columns * map.inner_size.x() - half.x(),
                      (i / map.columns + 0.5) / map.rows * map.inner_size.y() - half.y(), 0.0);  // NOLINT: rows
    // Nearer to the walls no box has its middle.
    if ((p_T.head<2>().cwiseAbs().array() > half.array() - least).any()) continue;
    std::string missing;
    for (const ReachLayer& layer : map.layers) {
      const ReachPoint& point = layer.points[static_cast<std::size_t>(i)];
      if (is_reached(point)) continue;
      const std::string& what = map.whats[static_cast<std::size_t>(point.what)];
      missing += fmt::format("{}{}: {}{}{}", missing.empty() ? "" : "; ", layer.name, name_of(point.verdict),
                             what.empty() ? "" : ": ", what);
    }
    plan.dots.push_back({(map.X_WT * p_T).head<2>(),
                         missing.empty() ? report::PlanInk::Reached : report::PlanInk::Unreached,
                         missing.empty() ? "reached at all heights" : missing});
  }
  for (const ReachPick& pick : map.picks)
    plan.dots.push_back({pick.p_WS.head<2>(),
                         is_reached(pick.point) ? report::PlanInk::Reached : report::PlanInk::Unreached,
                         fmt::format("pick of {}: {}", pick.item, name_of(pick.point.verdict))});
  return plan;
}

std::vector<Markup> row_of(const std::string& name, const PlacedCell& place, int asked) {
  const auto add = [](std::vector<Markup>& row, const Pose& X_W) {
    for (int i = 0; i < 3; ++i) row.push_back(report::number(X_W.p[i], 3));
    row.push_back(report::number(model::yaw_about_vertical(X_W.R) * 180.0 / std::numbers::pi, 1));
  };
  std::vector<Markup> row = {name};
  add(row, place.X_WB);
  add(row, place.X_WA);
  row.insert(row.end(), {fmt::format("{} of {}", place.reached, asked), report::number(1e3 * place.margin, 0),
                         report::number(1e3 * place.travel, 0), place.missing});
  return row;
}

}  // namespace

std::string make_place_page(const model::Scenario& scenario, const PlaceSearch& search, const PlaceOptions& options) {
  report::Table table{{{"place", true},
                       {"base x, m"},
                       {"y"},
                       {"z"},
                       {"yaw, deg"},
                       {"aligner x, m"},
                       {"y"},
                       {"z"},
                       {"yaw, deg"},
                       {"poses reached"},
                       {"margin, mm"},
                       {"travel, mm"},
                       {"first that is not reached", true}},
                      {row_of("as it is", search.before, search.asked)},
                      {}};
  for (const PlacedCell& place : search.places)
    table.rows.push_back(row_of(fmt::format("{}", table.rows.size()), place, search.asked));
  Markup content = report::paragraph(
      fmt::format("Poses that are needed: the tool straight down, also turned by a quarter, over {} from its floor to "
                  "over its rim, and "
                  "at the picks: {}. The tool reaches {:.2f} m from the first axis. Margin: how far container and "
                  "picks could be moved "
                  "before one of them is out of reach. Travel: from the picks to the container, level.",
                  search.container, search.asked, search.reach));
  content += report::as_markup(table);
  if (search.places.empty()) return report::make_page("Places of " + search.robot, content);
  const model::Scenario placed =
      model::parse_scenario(write_place(scenario, search.places.front(), options), scenario.source_name);
  const ReachMap map = make_reach_map(placed, options.threads, options.check);
  content += report::figure(
      "Place 1 from above: points of the container and of the picks that the tool reaches at all heights, and how far "
      "it reaches. Point at another to see what prevents it.",
      report::floor_plan(plan_of(placed, map, search.reach)));
  return report::make_page("Places of " + search.robot, content);
}

}  // namespace snug::runs
