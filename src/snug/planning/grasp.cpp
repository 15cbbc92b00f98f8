// Grasp: ways to turn a box, rehearsed in every rollout.
#include "snug/planning/grasp.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/core/check.hpp"
#include "snug/core/parallel.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/skills/side_pick.hpp"

namespace snug::planning {
namespace {

Vector3 up_axis(const packing::Orientation& orientation) {
  return orientation.up_sign * Vector3::Unit(static_cast<int>(orientation.up));
}

/// The orientation that takes the same space with the other end up, and of the two the one whose centre of mass is
/// nearer.
packing::Orientation mirrored(const packing::Orientation& orientation, const Vector3& com) {
  packing::Orientation best = orientation;
  double nearest = 0.0;
  for (const int turn : {0, 2}) {
    packing::Orientation other = orientation;
    other.up_sign = -orientation.up_sign;
    // Quarter turns count from different directions when the other end is up: the parity is settled by the extents.
    other.yaw_quarter = (orientation.yaw_quarter + turn) % 4;
    if (!packing::extents(other, Vector3(1.0, 2.0, 3.0))
             .isApprox(packing::extents(orientation, Vector3(1.0, 2.0, 3.0)))) {
      other.yaw_quarter = (other.yaw_quarter + 1) % 4;
    }
    const Vector3 off = packing::rotation(other) * com - packing::rotation(orientation) * com;
    const double distance = off.head<2>().norm();
    if (best == orientation || distance < nearest) {
      best = other;
      nearest = distance;
    }
  }
  return best;
}

constexpr double kThere = 0.02;        ///< m, more than boxes arrive off the place where they are expected
constexpr double kTurnedThere = 0.05;  ///< rad, the same

class GraspPlanner {
 public:
  GraspPlanner(const GraspRequest& request, const packing::Orientation& orientation)
      : request_(request),
        nominal_(request.rollouts.empty() ? nullptr : request.rollouts[0].get()),
        travel_(travel_bottom(request.layout, request.packed_top)),
        X_WP_(request.X_WP) {
    grasp_.orientation = grasp_.held_as = orientation;
    grasp_.program.name = "pack";
    grasp_.episodes.resize(request.rollouts.size());
    for (std::size_t i = 0; i < request.rollouts.size(); ++i) request.rollouts[i]->restore(request.states[i]);
  }

  /// False when this way of turning does not apply.
  bool make(skills::Reorientation reorientation) {
    grasp_.reorientation = reorientation;
    const bool applies = reorientation == skills::Reorientation::None        ? pick()
                         : reorientation == skills::Reorientation::SideGrasp ? pick_side_where_it_stands()
                         : reorientation == skills::Reorientation::Regrasp   ? regrasp()
                                                                             : pivot();
    if (!applies || nominal_ == nullptr) return applies;
    if (is_fine() && !grasp_.episodes[0].is_complete()) grasp_.problem = GraspProblem::Rollout;
    if (is_fine()) run_samples();
    if (is_fine() && is_heavy() && !holds_enough(0)) grasp_.problem = GraspProblem::TooHeavy;
    if (is_fine() && is_heavy() && grasp_.success_rate < request_.scenario.rehearsal.least_rate) {
      grasp_.problem = GraspProblem::TooHeavy;
    }
    return true;
  }
  [[nodiscard]] Grasp take() { return std::move(grasp_); }
  [[nodiscard]] bool stands() const { return (X_WP_.R * up_axis(grasp_.orientation)).z() > std::cos(max_lean()); }
  [[nodiscard]] bool is_upside_down() const {
    return (X_WP_.R * up_axis(grasp_.orientation)).z() < -std::cos(max_lean());
  }

 private:
  [[nodiscard]] double max_lean() const { return request_.scenario.skills.pick.max_lean; }
  [[nodiscard]] bool is_fine() const { return grasp_.problem == GraspProblem::None; }
  /// As it shall stand, in the middle of the container.
  [[nodiscard]] Pose goal() const {
    return request_.layout.X_WT * Pose{packing::rotation(grasp_.held_as), Vector3::Zero()};
  }
  [[nodiscard]] bool is_first() const { return request_.location == Location::Aligner; }

  /// It is carried more slowly than others.
  [[nodiscard]] bool is_heavy() const { return request_.layout.is_fast && grasp_.swing && grasp_.swing->pace < 1.0; }
  /// In this world the cup held as many times its load as it has to.
  [[nodiscard]] bool holds_enough(std::size_t world) const {
    return request_.rollouts[world]->state().gripper.least_hold_factor >= request_.scenario.place_limits.hold_factor;
  }

  /// Where the tool is.
  [[nodiscard]] const motion::Waypoint& last() const {
    return grasp_.program.waypoints.empty() ? request_.from : grasp_.program.waypoints.back();
  }

  /// Where the tool is near the first waypoint already it does not move to it.
  void execute(std::vector<motion::Waypoint> waypoints) {
    const bool is_there = grasp_.program.waypoints.empty() && waypoints.size() > 1 &&
                          (waypoints[0].X_WE.p - last().X_WE.p).norm() < kThere &&
                          angle_between(waypoints[0].X_WE.R, last().X_WE.R) < kTurnedThere;
    if (is_there && request_.layout.is_fast && nominal_ != nullptr) waypoints[0].X_WE = last().X_WE;
    append(grasp_.program, drivable(request_.layout, last(), waypoints, grasp_.swing));
    if (nominal_ != nullptr) merge(grasp_.episodes[0], nominal_->run(grasp_.program));
  }

  /// Whether it hangs from the cup now.
  bool holds() {
    if (nominal_ == nullptr) return false;
    if (!grasp_.episodes[0].is_complete()) {
      grasp_.problem = GraspProblem::Rollout;
      return false;
    }
    if (!nominal_->is_held(request_.box.item)) {
      grasp_.problem = GraspProblem::NotHeld;
      return false;
    }
    grasp_.X_PS = nominal_->state().gripper.cup.X_PS;
    grasp_.X_EP = grasp_.program.waypoints.back().X_WE.inverse() * *nominal_->pose_of(request_.box.item);
    return true;
  }

  /// It hangs, from now on, with the face up that looks along `face_W`.
  void hang_by(const Vector3& face_W) {
    int axis = 0;
    const Vector3 face_P = X_WP_.R.transpose() * face_W;
    face_P.cwiseAbs().maxCoeff(&axis);
    grasp_.swing = swing_of(request_.scenario, request_.box, std::copysign(1.0, face_P[axis]) * Vector3::Unit(axis));
  }

  bool pick_from_above(const Pose& X_WP_next, skills::PickKind kind) {
    hang_by(Vector3::UnitZ());
    execute(plan_pick(request_.scenario, request_.layout, request_.box, X_WP_, X_WP_next, travel_, kind));
    return holds();
  }

  /// The box held like R_WP is brought to its place next: of the two orientations that take the same space there the
  /// one that leaves the wrist less to do.
  void spare_wrist(const Matrix3& R_WP) {
    const skills::CellLayout& layout = request_.layout;
    if (!layout.is_fast || !layout.pan_axis) return;
    const double pan = motion::pan_between(layout.pan_axis->p_WB, X_WP_.p, layout.X_WT.p);
    const auto turn_of_wrist = [&] { return std::abs(pan - turn_between(layout, {R_WP, X_WP_.p}, goal())); };
    const packing::Orientation asked = grasp_.held_as;
    const double as_asked = turn_of_wrist();
    grasp_.held_as.yaw_quarter = (asked.yaw_quarter + 2) % 4;
    if (turn_of_wrist() >= as_asked) grasp_.held_as = asked;
  }

  bool pick() {
    spare_wrist(X_WP_.R);
    (void)pick_from_above(goal(), is_first() ? skills::PickKind::First : skills::PickKind::FromAfar);
    return true;
  }

  /// By the side that looks along `face`, which is then turned up.
  void pick_side(const Vector3& face, bool again) {
    hang_by(face);
    spare_wrist(skills::face_up(X_WP_.R, face));
    auto waypoints =
        plan_side_pick(request_.scenario, request_.layout, request_.box, X_WP_, face, goal(), travel_, again);
    if (waypoints.empty()) {
      grasp_.problem = GraspProblem::SideTooLow;
      return;
    }
    const auto reaches = [&](const motion::Way& way) { return !request_.reaches || request_.reaches(way); };
    if (!std::ranges::all_of(waypoints, [&](const auto& one) { return reaches({one.X_WE, one.X_WE}); })) {
      grasp_.problem = GraspProblem::OutOfReach;
      return;
    }
    const std::optional<motion::PanAxis>& pan_axis = request_.layout.pan_axis;
    // A fast tool comes to the second waypoint, level, without the upright one before, unless it would pass over the
    // box.
    if (request_.layout.is_fast && !again && reaches({last().X_WE, waypoints[1].X_WE, pan_axis}))
      waypoints.erase(waypoints.begin());
    execute(waypoints);
    if (!holds()) return;
    const motion::Waypoint up = plan_turn_up(request_.scenario, request_.box, X_WP_, grasp_.X_PS, face, travel_, again);
    Pose X_WE_over = up.X_WE;
    X_WE_over.p.head<2>() = request_.layout.X_WT.p.head<2>();
    if (request_.layout.is_fast && reaches({last().X_WE, X_WE_over, pan_axis})) return;  // on the way to its place
    execute({up});
    (void)holds();
  }

  /// At the aligner the two sides that its plates leave open, on the bench the one toward the robot.
  [[nodiscard]] std::vector<Vector3> open_faces() const {
    if (is_first()) {
      const Matrix3& R_WA = request_.scenario.aligner->X_WA.R;
      return {R_WA.col(0), R_WA.col(1)};
    }
    if (request_.location != Location::Bench || !request_.layout.flip_place) return {};
    return {-request_.layout.flip_place->direction};
  }

  bool pick_side_where_it_stands() {
    for (const Vector3& face : open_faces()) {
      const double along = (X_WP_.R.transpose() * face).dot(up_axis(grasp_.orientation));
      if (std::abs(along) < std::cos(max_lean())) continue;
      if (along < 0.0) grasp_.held_as = mirrored(grasp_.orientation, request_.box.inertia.com);
      pick_side(face, !is_first());
      return true;
    }
    return false;
  }

  /// The box was let go on the way: there it has to be perceived before the plan goes on.
  void end_stage() {
    if (const std::optional<Pose> seen = nominal_->pose_of(request_.box.item)) X_WP_ = *seen;
    grasp_.stages.push_back(grasp_.program.waypoints.size());
    grasp_.stage_poses.push_back(X_WP_);
    if (!is_upright(X_WP_.R, max_lean())) grasp_.problem = GraspProblem::DoesNotStand;
  }

  bool regrasp() {
    if (!request_.layout.flip_place) return false;
    const skills::FlipPlace& place = *request_.layout.flip_place;
    const Matrix3 R_WP = skills::orientation_before_flip(X_WP_.R, up_axis(grasp_.orientation), -place.direction);
    if (!pick_from_above({R_WP, place.p_WF}, is_first() ? skills::PickKind::First : skills::PickKind::FromAfar))
      return true;
    execute(plan_set_down(request_.scenario, request_.box, place, R_WP, grasp_.X_PS, travel_));
    end_stage();
    if (is_fine()) pick_side(-place.direction, true);
    return true;
  }

  /// Upside down takes two rounds.
  bool pivot() {
    if (!request_.layout.flip_place) return false;
    for (int round = 0; round < 4 && is_fine(); ++round) {
      const Vector3 up_P = up_axis(grasp_.orientation);
      Vector3 next_up = up_P;
      if (is_upside_down()) {  // any other axis first
        int axis = 0;
        X_WP_.R.row(2).cwiseAbs().minCoeff(&axis);
        next_up = Vector3::Unit(axis);
      }
      const bool is_done = stands();
      if (is_done) spare_wrist(X_WP_.R);
      const skills::FlipPlace& place = *request_.layout.flip_place;
      const Pose X_next =
          is_done ? goal() : Pose{skills::orientation_before_flip(X_WP_.R, next_up, place.direction), place.p_WF};
      const skills::PickKind first = is_first() ? skills::PickKind::First : skills::PickKind::FromAfar;
      if (!pick_from_above(X_next, round > 0 ? skills::PickKind::FromAbove : first) || is_done) break;
      if (round >= 2) {
        grasp_.problem = GraspProblem::DoesNotStand;
        break;
      }
      turn_over(next_up);
    }
    return true;
  }

  /// One quarter turn over an edge, let go.
  void turn_over(const Vector3& up_P) {
    execute(plan_flip(request_.scenario, request_.box, *request_.layout.flip_place,
                      skills::orientation_before_flip(X_WP_.R, up_P, request_.layout.flip_place->direction),
                      grasp_.X_PS, travel_));
    end_stage();
  }

  /// From waypoint `first` on where the box stands elsewhere than in the nominal rollout, as a session plans anew then.
  void follow_box(const Pose& X_WP_nominal, const Pose& X_WP, std::size_t first, motion::Program& program) const {
    const settings::RecoverySettings& recovery = request_.scenario.recovery;
    const bool is_as_rehearsed = (X_WP.p - X_WP_nominal.p).norm() <= recovery.as_rehearsed &&
                                 angle_between(X_WP.R, X_WP_nominal.R) <= recovery.turned_as_rehearsed;
    if (is_as_rehearsed || !is_upright(X_WP.R, max_lean())) return;
    const Pose X_moved = X_WP * X_WP_nominal.inverse();
    for (std::size_t i = first; i < program.waypoints.size(); ++i) {
      motion::Waypoint& waypoint = program.waypoints[i];
      waypoint.X_WE = X_moved * grasp_.program.waypoints[i].X_WE;
      waypoint = motion::rounded(waypoint);
    }
  }

  /// As a session sends it: it stops and perceives where the box was let go.
  void run_sample(Rollout& rollout, motion::Program& program, Episode& episode) const {
    for (std::size_t stage = 0; stage < grasp_.stages.size() && episode.is_complete(); ++stage) {
      const auto end = static_cast<std::ptrdiff_t>(grasp_.stages[stage]);
      motion::Program so_far = program;
      so_far.waypoints.erase(so_far.waypoints.begin() + end, so_far.waypoints.end());
      merge(episode, rollout.run(so_far));
      const std::optional<Pose> X_WP = rollout.pose_of(request_.box.item);
      if (X_WP) follow_box(grasp_.stage_poses[stage], *X_WP, grasp_.stages[stage], program);
    }
    if (episode.is_complete()) merge(episode, rollout.run(program));
  }

  void run_samples() {
    const int samples = static_cast<int>(request_.rollouts.size()) - 1;
    grasp_.programs.assign(request_.rollouts.size(), grasp_.program);
    parallel_for(samples, request_.threads, [&](int i, int) {
      const auto slot = static_cast<std::size_t>(i) + 1;
      run_sample(*request_.rollouts[slot], grasp_.programs[slot], grasp_.episodes[slot]);
    });
    double good = 0.0, all = 0.0;
    const Matrix3 R_WP = request_.rollouts[0]->pose_of(request_.box.item)->R;
    for (std::size_t i = 0; i < request_.rollouts.size(); ++i) {
      const Rollout& rollout = *request_.rollouts[i];
      grasp_.states.push_back(rollout.state());
      if (i == 0) continue;
      const std::optional<Pose> X_WP = rollout.pose_of(request_.box.item);
      const bool is_good = rollout.is_held(request_.box.item) && X_WP && angle_between(X_WP->R, R_WP) < max_lean() &&
                           (!is_heavy() || holds_enough(i));
      all += request_.weights[i];
      if (is_good) good += request_.weights[i];
    }
    grasp_.success_rate = all > 0.0 ? good / all : 1.0;
  }

  const GraspRequest& request_;
  Rollout* nominal_;  ///< null: nothing is rehearsed
  double travel_;
  Pose X_WP_;  ///< of the box where it stands, as believed or as the nominal rollout has it
  Grasp grasp_;
};

/// In the order in which they are tried.
std::vector<skills::Reorientation> reorientations_for(const GraspRequest& request,
                                                      const packing::Orientation& orientation) {
  const GraspPlanner planner(request, orientation);
  if (planner.stands()) return {skills::Reorientation::None};
  if (planner.is_upside_down()) return {skills::Reorientation::Pivot};
  return {skills::Reorientation::SideGrasp, skills::Reorientation::Regrasp, skills::Reorientation::Pivot};
}

}  // namespace

const char* describe(GraspProblem problem) {
  switch (problem) {
    case GraspProblem::None:
      return "";
    case GraspProblem::NotHeld:
      return "the cup did not hold it";
    case GraspProblem::SideTooLow:
      return "its side is too low for the cup";
    case GraspProblem::OutOfReach:
      return "its side is out of reach";
    case GraspProblem::DoesNotStand:
      return "it does not stand where it was put down";
    case GraspProblem::NoSurface:
      return "nothing flat to turn it on";
    case GraspProblem::Rollout:
      return "the nominal rollout ended early";
    case GraspProblem::TooHeavy:
      return "the cup would hold too few times the box's weight while it is lifted";
  }
  return "";
}

std::optional<GraspOutline> outline_grasp(const GraspRequest& request, const packing::Orientation& orientation) {
  SNUG_CHECK(request.rollouts.empty(), "nothing is rehearsed");
  for (const skills::Reorientation reorientation : reorientations_for(request, orientation)) {
    GraspPlanner planner(request, orientation);
    if (!planner.make(reorientation)) continue;
    const Grasp grasp = planner.take();
    const auto& waypoints = grasp.program.waypoints;
    const auto first = std::ranges::find_if(waypoints, [](const motion::Waypoint& one) {
      return one.motion_class == motion::MotionClass::PrePick || one.motion_class == motion::MotionClass::PreRePick;
    });
    if (first != waypoints.end()) return GraspOutline{reorientation, first->X_WE};
  }
  return std::nullopt;
}

Grasp plan_grasp(const GraspRequest& request, const packing::Orientation& orientation) {
  const std::vector<skills::Reorientation> reorientations = reorientations_for(request, orientation);
  Grasp best;
  best.orientation = orientation;
  best.problem = GraspProblem::NoSurface;
  best.episodes.resize(request.rollouts.size());
  bool is_first = true;
  for (const skills::Reorientation reorientation : reorientations) {
    if (std::ranges::find(request.refused, reorientation) != request.refused.end()) continue;
    GraspPlanner planner(request, orientation);
    if (!planner.make(reorientation)) continue;
    Grasp grasp = planner.take();
    const bool is_fine = grasp.problem == GraspProblem::None, was_fine = best.problem == GraspProblem::None;
    const bool is_better = is_first || (is_fine && (!was_fine || grasp.success_rate > best.success_rate));
    if (is_better) best = std::move(grasp);
    is_first = false;
    if (best.problem == GraspProblem::None && best.success_rate >= 1.0) break;
  }
  return best;
}

}  // namespace snug::planning
