// CandidateCost: what a place is worth, less what it costs to turn the box for it.
#include "snug/planning/candidate_cost.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "snug/motion/tool_yaw.hpp"

namespace snug::planning {

std::optional<GraspOutline> outline_of(const Scene& scene, const StandingBox& box,
                                       const packing::Orientation& orientation, model::ItemIndex without) {
  const skills::CellLayout& layout = scene.cell.layout;
  const skills::PlannedBox planned = scene.planned_box(box.item);
  const Pose X_WE_over{motion::upright_tool(layout.neutral_yaw), layout.X_WT.p};
  const motion::Waypoint from = motion::make_waypoint(motion::MotionClass::PostPlace, {}, X_WE_over);
  return outline_grasp({scene.belief.nominal(),
                        layout,
                        {},
                        {},
                        {},
                        from,
                        planned,
                        box.X_WP,
                        box.location,
                        scene.packed_top(without),
                        1,
                        scene.cell.reaches},
                       orientation);
}

double cost_of(const Scene& scene, const StandingBox& box, const packing::Placement& placement) {
  if (!scene.cell.layout.is_fast || placement.flips == 0) return 0.0;
  const settings::RehearsalSettings& settings = scene.rules().rehearsal;
  const auto outline = outline_of(scene, box, placement.orientation, box.item);
  const bool is_by_side = outline && outline->reorientation == skills::Reorientation::SideGrasp;
  return is_by_side ? settings.side_grasp_cost : settings.reorientation_cost;
}

double utility_of(const Scene& scene, const packing::Candidate& candidate, double success_rate, double cost) {
  const double expected = (candidate.expected_percent > 0.0 ? candidate.expected_percent : 100.0) - cost;
  return success_rate * expected + (1.0 - success_rate) * packing::filling_percent(scene.container_state());
}

void sort_by_utility(const Scene& scene, const StandingBox& box, std::vector<packing::Candidate>& candidates) {
  if (!scene.cell.layout.is_fast) return;
  std::vector<std::pair<double, packing::Candidate>> ordered;
  for (packing::Candidate& one : candidates) {
    const double utility = utility_of(scene, one, 1.0, cost_of(scene, box, one.placement));
    ordered.emplace_back(utility, std::move(one));
  }
  std::ranges::stable_sort(ordered, std::greater(), [](const auto& one) { return one.first; });
  std::ranges::transform(ordered, candidates.begin(), [](auto& one) { return std::move(one.second); });
}

}  // namespace snug::planning
