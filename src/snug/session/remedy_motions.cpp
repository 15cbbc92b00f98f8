// Remedy motions: waypoints of what is done about a trouble, from what is believed and where the robot stands.
#include "snug/session/remedy_motions.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "snug/cup/pick_length.hpp"
#include "snug/planning/rollout.hpp"
#include "snug/skills/primitives.hpp"
#include "snug/skills/surroundings.hpp"

namespace snug::session {
namespace {

using motion::MotionClass;
using planning::rotation_at_aligner;
using planning::Scene;

/// Straight up from where the tool is, with the held box.
motion::Waypoint plan_lift(const Scene& scene, const plant::Feedback& robot, const Carried& held) {
  motion::Waypoint up = motion::make_waypoint(MotionClass::PostPick, held.box.id, robot.X_WE, {.vacuum = true}, "_up");
  const double hanging = -2.0 * skills::lowest_corner(held.R_WP, held.box.size) + scene.rules().cup.hold_length;
  up.X_WE.p.z() = std::max(up.X_WE.p.z(), scene.travel_bottom(held.item) + hanging);
  return up;
}

/// After `waypoints`, at whose end it hangs from the cup: the box to `place`.
std::vector<motion::Waypoint> plan_put_down(const Scene& scene, const plant::Feedback& robot, const Carried& held,
                                            const skills::FlipPlace& place, std::vector<motion::Waypoint> waypoints) {
  const auto down =
      plan_set_down(scene.belief.nominal(), held.box, place, held.R_WP, held.X_PS, scene.travel_bottom(held.item));
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

/// Picked where it lies or leans, and put down at `place` like R_WP.
std::vector<motion::Waypoint> plan_move(const Scene& scene, const plant::Feedback& robot, model::ItemIndex item,
                                        const Matrix3& R_WP, const skills::FlipPlace& place) {
  std::vector<motion::Waypoint> pick = plan_pick_to_return(scene, item, R_WP);
  const auto onto = std::ranges::find(pick, MotionClass::RePick, &motion::Waypoint::motion_class);
  const Pose X_ES{Matrix3::Identity(), cup::pick_length(scene.rules().cup) * Vector3::UnitZ()};
  const Carried picked{item, scene.planned_box(item), R_WP, scene.X_WP(item).inverse() * onto->X_WE * X_ES,
                       std::nullopt};
  return plan_put_down(scene, robot, picked, place, std::move(pick));
}

/// Beside the aligner's corner, on what holds boxes there.
skills::FlipPlace place_at_aligner(const Scene& scene, model::ItemIndex item, const Matrix3& R_WP) {
  const Vector3 size = scene.planned_box(item).size;
  const Pose& X_WA = scene.rules().aligner->X_WA;
  const Pose arrival = scene.arrival_of(item);
  const Vector3 middle =
      Vector3::Constant(scene.rules().recovery.return_distance) + 0.5 * ((X_WA.R.transpose() * R_WP).cwiseAbs() * size);
  skills::FlipPlace place{X_WA * middle, Vector3::UnitX()};
  place.p_WF.z() = arrival.p.z() + skills::lowest_corner(arrival.R, size);
  return place;
}

/// No other box stands there.
bool is_free(const Scene& scene, model::ItemIndex item, const skills::FlipPlace& place, const Matrix3& R_WP) {
  constexpr double kBesideOther = 0.01;  // m
  const auto half = [&](model::ItemIndex one, const Matrix3& R) -> Vector3 {
    return 0.5 * (R.cwiseAbs() * scene.planned_box(one).size);
  };
  for (std::size_t i = 0; i < scene.belief.boxes.size(); ++i) {
    const model::ItemIndex other(i);
    if (other == item || !scene.box(other)) continue;
    const Vector3 apart =
        (scene.X_WP(other).p - place.p_WF).cwiseAbs() - half(item, R_WP) - half(other, scene.X_WP(other).R);
    if (apart.x() < kBesideOther && apart.y() < kBesideOther) return false;
  }
  return true;
}

/// How what hangs may stand: with the tool over it first, then as it hangs; each turned about the vertical.
std::vector<Matrix3> rotations_to_put_down(const Scene& scene, model::ItemIndex item, const Pose& X_PS) {
  const Matrix3& R_WA = scene.rules().aligner->X_WA.R;
  const Matrix3& R_WP = scene.X_WP(item).R;
  const Matrix3 to_below =
      Eigen::Quaterniond::FromTwoVectors(R_WP * X_PS.R.col(2), -Vector3::UnitZ()).toRotationMatrix();
  const Matrix3 under_tool = R_WA * packing::rotation(packing::nearest_orientation(R_WA.transpose() * to_below * R_WP));
  std::vector<Matrix3> rotations;
  for (const Matrix3& base : {under_tool, rotation_at_aligner(scene, item)}) {
    for (const int quarters : {0, 2, 1, 3}) {
      const Matrix3 R = exp_rotation(0.5 * std::numbers::pi * quarters * R_WA.col(2)) * base;
      const bool is_new = std::ranges::none_of(rotations, [&](const Matrix3& one) { return R.isApprox(one, 1e-6); });
      if (is_new) rotations.push_back(R);
    }
  }
  return rotations;
}

/// m: how far below the tool the box hangs now, and while it is turned.
double hanging_below(const Scene& scene, const plant::Feedback& robot, const Carried& held) {
  const Pose X_ES{Matrix3::Identity(), scene.rules().cup.hold_length * Vector3::UnitZ()};
  const Pose X_WP = robot.X_WE * X_ES * held.X_PS.inverse();
  const Vector3 p_EP = X_WP.p - robot.X_WE.p;
  constexpr double kTurned = 0.3;  // rad
  const bool is_turned = std::acos(std::clamp((held.R_WP * X_WP.R.transpose())(2, 2), -1.0, 1.0)) > kTurned;
  return is_turned ? p_EP.norm() + 0.5 * held.box.size.norm()
                   : -p_EP.z() - skills::lowest_corner(X_WP.R, held.box.size);
}

}  // namespace

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
  const Matrix3 R_WP = held ? held->R_WP : rotation_at_aligner(scene, item);
  const skills::FlipPlace place = place_at_aligner(scene, item, R_WP);
  if (held) return plan_put_down(scene, robot, *held, place, {plan_lift(scene, robot, *held)});
  return plan_move(scene, robot, item, R_WP, place);
}

std::vector<motion::Waypoint> plan_take_out(const Scene& scene, const plant::Feedback& robot, model::ItemIndex item) {
  const Matrix3 R_WP = rotation_at_aligner(scene, item);
  const std::optional<skills::FlipPlace>& bench = scene.cell.layout.flip_place;
  if (!bench || scene.is_under_obstacle(item) || scene.is_under_box(item)) return {};
  if (!is_free(scene, item, *bench, R_WP)) return {};
  std::vector<motion::Waypoint> waypoints = plan_move(scene, robot, item, R_WP, *bench);
  const planning::ToolReach& reaches = scene.cell.reaches;
  const bool can = !reaches || std::ranges::all_of(waypoints, [&](const motion::Waypoint& one) {
    return reaches({one.X_WE, one.X_WE});
  });
  if (!can) return {};
  return waypoints;
}

std::vector<std::vector<motion::Waypoint>> plan_put_aside(const Scene& scene, const plant::Feedback& robot,
                                                          model::ItemIndex item, const Pose& X_PS) {
  std::vector<std::vector<motion::Waypoint>> ways;
  const planning::ToolReach& reaches = scene.cell.reaches;
  const std::vector<Matrix3> rotations = rotations_to_put_down(scene, item, X_PS);
  for (const bool is_at_aligner : {true, false}) {
    if (!is_at_aligner && !scene.cell.layout.flip_place) break;
    for (const Matrix3& R_WP : rotations) {
      const skills::FlipPlace place =
          is_at_aligner ? place_at_aligner(scene, item, R_WP) : *scene.cell.layout.flip_place;
      if (!is_free(scene, item, place, R_WP)) continue;
      const Carried held{item, scene.planned_box(item), R_WP, X_PS, std::nullopt};
      motion::Waypoint up = plan_lift(scene, robot, held);
      const double over = scene.travel_bottom(item) + hanging_below(scene, robot, held);
      up.X_WE.p.z() = std::max(up.X_WE.p.z(), over);
      std::vector<motion::Waypoint> way = plan_put_down(scene, robot, held, place, {std::move(up)});
      const bool can = !reaches || std::ranges::all_of(way, [&](const motion::Waypoint& one) {
        return reaches({one.X_WE, one.X_WE});
      });
      if (can) ways.push_back(std::move(way));
    }
  }
  return ways;
}

bool is_aligner_free(const Scene& scene, model::ItemIndex item) {
  for (std::size_t i = 0; i < scene.belief.boxes.size(); ++i) {
    const model::ItemIndex other(i);
    if (other != item && scene.box(other) && scene.locate(other) == planning::Location::Aligner) return false;
  }
  return true;
}

bool can_return(const Scene& scene, model::ItemIndex item) {
  if (!scene.box(item) || scene.is_under_obstacle(item) || scene.is_under_box(item)) return false;
  if (scene.locate(item) == planning::Location::Aligner || !is_aligner_free(scene, item)) return false;
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
