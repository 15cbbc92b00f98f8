// Remedy motions: waypoints of what is done about a trouble, from what is believed and where the robot stands.
#include "snug/session/remedy_motions.hpp"

#include <algorithm>
#include <utility>

#include "snug/cup/pick_length.hpp"
#include "snug/planning/rollout.hpp"
#include "snug/skills/primitives.hpp"
#include "snug/skills/surroundings.hpp"

namespace snug::session {
namespace {

using motion::MotionClass;
using planning::Scene;

/// Straight up from where the tool is, with the held box.
motion::Waypoint plan_lift(const Scene& scene, const plant::Feedback& robot, const Carried& held) {
  motion::Waypoint up = motion::make_waypoint(MotionClass::PostPick, held.box.id, robot.X_WE, {.vacuum = true}, "_up");
  const double hanging = -2.0 * skills::lowest_corner(held.R_WP, held.box.size) + scene.rules().cup.hold_length;
  up.X_WE.p.z() = std::max(up.X_WE.p.z(), scene.travel_bottom() + hanging);
  return up;
}

/// After `waypoints`, at whose end it hangs from the cup: the box to `place`.
std::vector<motion::Waypoint> plan_put_down(const Scene& scene, const plant::Feedback& robot, const Carried& held,
                                            const skills::FlipPlace& place, std::vector<motion::Waypoint> waypoints) {
  const auto down = plan_set_down(scene.belief.nominal(), held.box, place, held.R_WP, held.X_PS, scene.travel_bottom());
  const motion::Waypoint here = motion::make_waypoint(MotionClass::PostPick, held.box.id, robot.X_WE, robot.io);
  waypoints.insert(waypoints.end(), down.begin(), down.end());
  motion::Program program;
  planning::append(program, drivable(scene.cell.layout, here, waypoints, held.swing));
  return std::move(program.waypoints);
}

/// A pick of the box where it lies or leans, so that it can be put down like R_WP.
std::vector<motion::Waypoint> plan_pick_to_return(const Scene& scene, model::ItemIndex item, const Matrix3& R_WP) {
  const skills::PlannedBox box = scene.planned_box(item);
  const Pose& X_WP = scene.X_WP(item);
  const Pose X_WP_next{R_WP, scene.rules().aligner->X_WA.p};
  const double travel = scene.travel_bottom();
  const model::Scenario& nominal = scene.belief.nominal();
  if (planning::is_upright(X_WP.R, scene.rules().skills.pick.max_lean))
    return plan_pick(nominal, scene.cell.layout, box, X_WP, X_WP_next, travel, skills::PickKind::FromAfar);
  return plan_leaning_pick(nominal, scene.cell.layout, box, X_WP, X_WP_next, travel);
}

}  // namespace

Matrix3 rotation_at_aligner(const Scene& scene, model::ItemIndex item) {
  const Matrix3& R_WA = scene.rules().aligner->X_WA.R;
  const Matrix3& R_WP = scene.X_WP(item).R;
  return R_WA * packing::rotation(packing::nearest_orientation(R_WA.transpose() * skills::leveling(R_WP) * R_WP));
}

std::vector<motion::Waypoint> plan_retreat(const Scene& scene, const plant::Feedback& robot, const std::string& id) {
  motion::Waypoint up = motion::make_waypoint(MotionClass::PostPlace, id, robot.X_WE, {}, "_retreat");
  const double over = scene.rules().cup.free_length + scene.rules().skills.travel.retreat;
  up.X_WE.p.z() = std::max(up.X_WE.p.z(), scene.travel_bottom() + over);
  const motion::Waypoint let_go =
      motion::make_waypoint(MotionClass::Place, id, robot.X_WE, {.blow_off = true}, "_release");
  std::vector<motion::Waypoint> waypoints{let_go, up};
  return scene.cell.layout.is_fast ? with_detaching(scene.cell.layout, waypoints) : waypoints;
}

std::vector<motion::Waypoint> plan_press_on(const Scene& scene, model::ItemIndex item) {
  return plan_press(scene.belief.nominal(), scene.cell.layout, scene.planned_box(item), scene.X_WP(item),
                    scene.travel_bottom());
}

std::vector<motion::Waypoint> plan_to_bench(const Scene& scene, const plant::Feedback& robot, const Carried& held) {
  return plan_put_down(scene, robot, held, *scene.cell.layout.flip_place, {plan_lift(scene, robot, held)});
}

std::vector<motion::Waypoint> plan_return(const Scene& scene, const plant::Feedback& robot, model::ItemIndex item,
                                          const std::optional<Carried>& held) {
  const skills::PlannedBox box = scene.planned_box(item);
  const Pose& X_WA = scene.rules().aligner->X_WA;
  const Matrix3 R_WP = held ? held->R_WP : rotation_at_aligner(scene, item);
  const Pose arrival = scene.arrival_of(item);
  const Vector3 middle = Vector3::Constant(scene.rules().recovery.return_distance) +
                         0.5 * ((X_WA.R.transpose() * R_WP).cwiseAbs() * box.size);
  skills::FlipPlace place{X_WA * middle, Vector3::UnitX()};
  place.p_WF.z() = arrival.p.z() + skills::lowest_corner(arrival.R, box.size);
  if (held) return plan_put_down(scene, robot, *held, place, {plan_lift(scene, robot, *held)});
  std::vector<motion::Waypoint> pick = plan_pick_to_return(scene, item, R_WP);
  const auto onto = std::ranges::find(pick, MotionClass::RePick, &motion::Waypoint::motion_class);
  const Pose X_ES{Matrix3::Identity(), cup::pick_length(scene.rules().cup) * Vector3::UnitZ()};
  const Carried picked{box, R_WP, scene.X_WP(item).inverse() * onto->X_WE * X_ES, std::nullopt};
  return plan_put_down(scene, robot, picked, place, std::move(pick));
}

bool can_return(const Scene& scene, model::ItemIndex item) {
  if (!scene.box(item) || scene.is_under_obstacle(item)) return false;
  if (scene.locate(item) == planning::Location::Aligner) return false;
  const planning::ToolReach& reaches = scene.cell.reaches;
  return !reaches ||
         std::ranges::all_of(plan_pick_to_return(scene, item, rotation_at_aligner(scene, item)), [&](const auto& one) {
           return reaches({one.X_WE, one.X_WE});
         });
}

std::vector<motion::Waypoint> plan_home(const Scene& scene, const plant::Feedback& robot) {
  const motion::Waypoint home = motion::make_waypoint(MotionClass::Home, {}, scene.rules().controller.X_WE_start);
  const motion::Waypoint from = motion::make_waypoint(MotionClass::Home, {}, robot.X_WE);
  motion::Program program;
  planning::append(program, drivable(scene.cell.layout, from, {home}));
  return std::move(program.waypoints);
}

}  // namespace snug::session
