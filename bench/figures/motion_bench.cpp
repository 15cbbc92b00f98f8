// measure_motions: how long it takes to plan one item's motion.
#include "bench/figures/internal/motion_bench.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bench/figures/internal/cpu_time.hpp"
#include "snug/cell/aligner_feed.hpp"
#include "snug/cell/joint_pace.hpp"
#include "snug/cell/simulation.hpp"
#include "snug/motion/controller.hpp"
#include "snug/packing/agent.hpp"
#include "snug/planning/reach.hpp"
#include "snug/planning/rollout.hpp"
#include "snug/skills/item_plan.hpp"
#include "snug/skills/surroundings.hpp"

namespace snug::bench::internal {
namespace {

constexpr std::size_t kPlaces = 4;  ///< of every decision

double top_of(const packing::ContainerState& state) {
  double top = 0.0;
  for (const packing::PlacedBox& box : state.boxes) top = std::max(top, packing::bounding_extent(box).high.z());
  return top;
}

/// Plans motions of the items of one sequence, from the intent to the timed motion.
class MotionPlanner {
 public:
  MotionPlanner(const model::Scenario& scenario, const model::Sequence& sequence)
      : scenario_(scenario),
        sequence_(sequence),
        simulation_(scenario, sequence.name, {.tracking = motion::FastTracking{}}),
        layout_(skills::make_layout(scenario, cell::find_pan_axis(scenario))),
        reaches_(planning::make_tool_reach(scenario)) {
    layout_.is_fast = true;
  }

  /// Duration of the motion, s. None: the box has to be set down to be turned, or the robot does not reach all of it.
  [[nodiscard]] std::optional<double> plan(int item, const packing::Candidate& candidate,
                                           const packing::ContainerState& state) const {
    const auto index = static_cast<std::size_t>(item);
    const skills::PlannedBox box = skills::make_planned_box(scenario_, sequence_, model::ItemIndex(item));
    const Pose X_WP = cell::pose_at_aligner(scenario_, sequence_.items[index], 0);
    const double top = top_of(state);
    const motion::Waypoint home = motion::make_waypoint(motion::MotionClass::Home, {}, scenario_.controller.X_WE_start);
    const std::optional<Pick> pick = plan_pick_of(box, X_WP, candidate.placement.X_TP.R, travel_bottom(layout_, top));
    if (!pick) return std::nullopt;
    motion::Program program{.name = "motion", .waypoints = {}};
    planning::append(program, drivable(layout_, home, pick->rows, pick->swing));
    const Pose X_EP = pick->X_WE.inverse() * X_WP;
    const Pose X_PS = X_EP.inverse() * Pose{Matrix3::Identity(), scenario_.cup.hold_length * Vector3::UnitZ()};
    const packing::Candidate placed =
        skills::measured(state, candidate, box.size, scenario_.parcel_clearance, scenario_.skills.insertion);
    const skills::Insertion insertion = skills::choose_insertions(placed, box.size, scenario_.skills.insertion).front();
    const motion::Waypoint held = program.waypoints.back();
    const skills::PlaceRequest request{box, X_PS, placed.placement.X_TP, insertion, top, held.X_WE, X_EP};
    planning::append(program, drivable(layout_, held, plan_place(scenario_, layout_, request), pick->swing));
    if (!planning::can_follow(reaches_, layout_, home, program.waypoints)) return std::nullopt;
    const motion::PreparedProgram prepared = simulation_.prepare(std::move(program));
    return motion::compute_duration(prepared, scenario_.controller.X_WE_start);
  }

 private:
  struct Pick {
    std::vector<motion::Waypoint> rows;
    Pose X_WE;  ///< where the vacuum comes on
    motion::Swing swing;
  };

  /// From above, or by the side that is to be up; none when neither brings the box to stand like R_TP.
  [[nodiscard]] std::optional<Pick> plan_pick_of(const skills::PlannedBox& box, const Pose& X_WP, const Matrix3& R_TP,
                                                 double travel) const {
    const Pose X_next = layout_.X_WT * Pose{R_TP, Vector3::Zero()};
    const Vector3 face_W = X_WP.R * X_next.R.row(2).transpose();  // this face is to be up
    if (face_W.z() < -0.5) return std::nullopt;
    Pick pick;
    pick.rows = face_W.z() > 0.5 ? plan_pick(scenario_, layout_, box, X_WP, X_next, travel, skills::PickKind::First)
                                 : plan_side_pick(scenario_, layout_, box, X_WP, face_W, X_next, travel, false);
    const auto held = std::ranges::find_if(pick.rows, [](const motion::Waypoint& row) { return row.io.vacuum; });
    if (held == pick.rows.begin() || held == pick.rows.end()) return std::nullopt;
    pick.X_WE = std::prev(held)->X_WE;
    pick.swing = skills::swing_of(scenario_, box, X_WP.R.transpose() * face_W);
    return pick;
  }

  const model::Scenario& scenario_;
  const model::Sequence& sequence_;
  cell::Simulation simulation_;
  skills::CellLayout layout_;
  planning::ToolReach reaches_;
};

}  // namespace

MotionFigures measure_motions(const model::Scenario& scenario) {
  std::vector<double> seconds;
  for (const model::Sequence& sequence : scenario.sequences) {
    const MotionPlanner planner(scenario, sequence);
    packing::AgentInput input;
    input.settings = scenario.packing;
    const std::unique_ptr<packing::Agent> agent = packing::make_agent("margin", std::move(input));
    packing::ContainerState state = packing::make_container_state(*model::find_container(scenario, scenario.target));
    const std::vector<packing::Item> items = packing::make_items(scenario, sequence);
    for (std::size_t i = 0; i < items.size(); ++i) {
      const auto decision = agent->decide(state, items[i]);
      if (!decision) continue;
      for (std::size_t k = 0; k < std::min(kPlaces, decision->candidates.size()); ++k) {
        const double start = cpu_seconds();
        if (planner.plan(static_cast<int>(i), decision->candidates[k], state)) seconds.push_back(cpu_seconds() - start);
      }
      state = packing::with_candidate(std::move(state), items[i], decision->candidates.front());
    }
  }
  MotionFigures figures;
  figures.count = static_cast<int>(seconds.size());
  if (seconds.empty()) return figures;
  std::ranges::sort(seconds);
  figures.median_seconds = seconds[seconds.size() / 2];
  figures.p99_seconds = seconds[static_cast<std::size_t>(std::ceil(0.99 * static_cast<double>(seconds.size()))) - 1];
  figures.longest_seconds = seconds.back();
  return figures;
}

}  // namespace snug::bench::internal
