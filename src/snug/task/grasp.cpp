// Grasp: ways to turn a box, tried in every lane.
#include "snug/task/grasp.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/core/parallel.hpp"
#include "snug/task/uncertainty.hpp"

namespace snug::task {
namespace {

constexpr double kUpright = 0.26;  ///< rad, a box may lie this far from level to be picked again

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

class GraspPlanner {
 public:
  GraspPlanner(const GraspRequest& request, const packing::Orientation& orientation)
      : request_(request), lane_(*request.lanes[0]), travel_(travel_bottom(request.layout, request.packed_top)) {
    grasp_.orientation = grasp_.held_as = orientation;
    grasp_.program = request.program;
    grasp_.episodes.resize(request.lanes.size());
    X_WP_ =
        arrival_pose(request.scenario, lane_.simulation().sequence().items[static_cast<std::size_t>(request.box.item)]);
    for (std::size_t i = 0; i < request.lanes.size(); ++i) request.lanes[i]->restore(request.states[i]);
  }

  /// False when this way of turning does not apply.
  bool make(TurnManner manner) {
    grasp_.turn = manner;
    const bool applies = manner == TurnManner::None       ? pick()
                         : manner == TurnManner::SidePick ? pick_side_at_aligner()
                         : manner == TurnManner::SetAside ? set_aside()
                                                          : flip();
    if (!applies) return false;
    if (grasp_.problem.empty()) grasp_.problem = grasp_.episodes[0].failure;
    if (grasp_.problem.empty()) run_samples();
    return true;
  }
  [[nodiscard]] Grasp take() { return std::move(grasp_); }
  [[nodiscard]] bool stands() const { return (X_WP_.R * up_axis(grasp_.orientation)).z() > std::cos(kUpright); }
  [[nodiscard]] bool is_upside_down() const {
    return (X_WP_.R * up_axis(grasp_.orientation)).z() < -std::cos(kUpright);
  }

 private:
  [[nodiscard]] Matrix3 goal() const { return request_.layout.X_WT.R * packing::rotation(grasp_.held_as); }

  void execute(const std::vector<motion::Waypoint>& rows) {
    append(grasp_.program, drivable(request_.layout, grasp_.program, rows));
    merge(grasp_.episodes[0], lane_.run(grasp_.program));
  }

  /// Whether it hangs from the cup now.
  bool holds(const char* otherwise) {
    grasp_.problem = grasp_.episodes[0].failure;
    if (!grasp_.problem.empty()) return false;
    if (!lane_.is_held(request_.box.item)) {
      grasp_.problem = otherwise;
      return false;
    }
    grasp_.X_PS = lane_.state().gripper.cup.X_PS;
    return true;
  }

  bool pick_from_above(const Matrix3& R_WP_next, bool again) {
    execute(plan_pick(request_.scenario, request_.layout, request_.box, X_WP_, R_WP_next, travel_, again));
    return holds(again ? "the cup did not hold it after it was turned" : "the cup did not hold it");
  }

  bool pick() {
    (void)pick_from_above(goal(), false);
    return true;
  }

  /// By the side that looks along `face`, which is then turned up.
  void pick_side(const Vector3& face, bool again) {
    const auto rows =
        plan_side_pick(request_.scenario, request_.layout, request_.box, X_WP_, face, goal(), travel_, again);
    if (rows.empty()) {
      grasp_.problem = "its side is too low for the cup";
      return;
    }
    const auto is_out_of_reach = [&](const motion::Waypoint& row) {
      return request_.reaches && !request_.reaches(row.X_WE);
    };
    if (std::ranges::any_of(rows, is_out_of_reach)) {
      grasp_.problem = "its side is out of reach";
      return;
    }
    execute(rows);
    if (!holds("the cup did not hold it by its side")) return;
    execute({plan_turn_up(request_.scenario, request_.box, X_WP_, grasp_.X_PS, face, travel_, again)});
    (void)holds("the cup lost it while it was turned up");
  }

  /// The two sides that the aligner's plates leave open.
  bool pick_side_at_aligner() {
    const Matrix3& R_WA = request_.scenario.aligner->X_WA.R;
    for (const Vector3& face : {Vector3(R_WA.col(0)), Vector3(R_WA.col(1))}) {
      const double along = (X_WP_.R.transpose() * face).dot(up_axis(grasp_.orientation));
      if (std::abs(along) < std::cos(kUpright)) continue;
      if (along < 0.0) grasp_.held_as = mirrored(grasp_.orientation, request_.box.inertia.com);
      pick_side(face, false);
      return true;
    }
    return false;
  }

  bool set_aside() {
    if (!request_.layout.flip_place) return false;
    const FlipPlace& place = *request_.layout.flip_place;
    const Matrix3 R_WP = orientation_before_flip(X_WP_.R, up_axis(grasp_.orientation), -place.direction);
    if (!pick_from_above(R_WP, false)) return true;
    execute(plan_set_down(request_.scenario, request_.box, place, R_WP, grasp_.X_PS, travel_));
    const std::optional<Pose> seen = lane_.pose_of(request_.box.item);
    if (!seen || seen->R.row(2).cwiseAbs().maxCoeff() < std::cos(kUpright)) {
      grasp_.problem = "it does not stand where it was put down";
      return true;
    }
    X_WP_ = *seen;
    pick_side(-place.direction, true);
    return true;
  }

  /// Upside down takes two rounds.
  bool flip() {
    if (!request_.layout.flip_place) return false;
    for (int round = 0; round < 4 && grasp_.problem.empty(); ++round) {
      const Vector3 up_P = up_axis(grasp_.orientation);
      Vector3 next_up = up_P;
      if (is_upside_down()) {  // any other axis first
        int axis = 0;
        X_WP_.R.row(2).cwiseAbs().minCoeff(&axis);
        next_up = Vector3::Unit(axis);
      }
      const bool is_done = stands();
      const Matrix3 R_next =
          is_done ? goal() : orientation_before_flip(X_WP_.R, next_up, request_.layout.flip_place->direction);
      if (!pick_from_above(R_next, round > 0) || is_done) break;
      if (round >= 2) {
        grasp_.problem = "it did not come to lie on the side that was wanted";
        break;
      }
      turn_over(next_up);
    }
    return true;
  }

  /// One quarter turn over an edge, let go.
  void turn_over(const Vector3& up_P) {
    execute(plan_flip(request_.scenario, request_.box, *request_.layout.flip_place,
                      orientation_before_flip(X_WP_.R, up_P, request_.layout.flip_place->direction), grasp_.X_PS,
                      travel_));
    if (const std::optional<Pose> seen = lane_.pose_of(request_.box.item)) X_WP_ = *seen;
    const double level = X_WP_.R.row(2).cwiseAbs().maxCoeff();
    if (level < std::cos(kUpright)) grasp_.problem = "it did not come to lie flat after the flip";
  }

  void run_samples() {
    const int samples = static_cast<int>(request_.lanes.size()) - 1;
    parallel_for(samples, request_.threads, [&](int i, int) {
      const auto slot = static_cast<std::size_t>(i) + 1;
      merge(grasp_.episodes[slot], request_.lanes[slot]->run(grasp_.program));
    });
    int good = 0;
    const Matrix3 R_WP = request_.lanes[0]->pose_of(request_.box.item)->R;
    for (std::size_t i = 0; i < request_.lanes.size(); ++i) {
      const Lane& lane = *request_.lanes[i];
      grasp_.states.push_back(lane.state());
      const std::optional<Pose> X_WP = lane.pose_of(request_.box.item);
      const bool is_good = lane.is_held(request_.box.item) && X_WP && angle_between(X_WP->R, R_WP) < kUpright;
      if (i > 0 && is_good) ++good;
    }
    grasp_.share = samples > 0 ? static_cast<double>(good) / samples : 1.0;
  }

  const GraspRequest& request_;
  Lane& lane_;
  double travel_;
  Pose X_WP_;  ///< of the box where it stands, as planned or seen
  Grasp grasp_;
};

}  // namespace

Grasp plan_grasp(const GraspRequest& request, const packing::Orientation& orientation) {
  const GraspPlanner first(request, orientation);
  std::vector<TurnManner> manners{TurnManner::SidePick, TurnManner::SetAside, TurnManner::Flip};
  if (first.stands()) manners = {TurnManner::None};
  if (first.is_upside_down()) manners = {TurnManner::Flip};
  Grasp best;
  best.orientation = orientation;
  best.problem = "nothing flat to turn it on";
  best.episodes.resize(request.lanes.size());
  bool is_first = true;
  for (const TurnManner manner : manners) {
    GraspPlanner planner(request, orientation);
    if (!planner.make(manner)) continue;
    Grasp grasp = planner.take();
    const bool is_better = is_first || (grasp.problem.empty() && (!best.problem.empty() || grasp.share > best.share));
    if (is_better) best = std::move(grasp);
    is_first = false;
    if (best.problem.empty() && best.share >= 1.0) break;
  }
  return best;
}

}  // namespace snug::task
