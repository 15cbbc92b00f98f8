// Small geometry of scene parts: container walls, boxes standing at the aligner, paths of spring holders.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/core/check.hpp"
#include "snug/model/body.hpp"
#include "snug/model/parcel.hpp"

namespace snug::model {
namespace {

PlacedShape make_slab(const Vector3& low, const Vector3& high) {
  return {geometry::Box{0.5 * (high - low)}, Pose{Matrix3::Identity(), 0.5 * (low + high)}};
}

/// Position and speed of the quintic that goes from 0 to 1 with zero speed and acceleration at both ends.
struct Progress {
  double s = 0.0;
  double rate = 0.0;  ///< 1/s
};

Progress quintic(double time, double start, double duration) {
  const double u = std::clamp((time - start) / duration, 0.0, 1.0);
  return {u * u * u * (10.0 + u * (-15.0 + 6.0 * u)), 30.0 * u * u * (1.0 - u) * (1.0 - u) / duration};
}

HolderState state_within(const StraightMove& move, const Pose& X_WH_before, double time) {
  const Progress at = quintic(time, move.start, move.duration);
  const Vector3 turn_W = log_rotation(move.X_WH.R * X_WH_before.R.transpose());
  const Vector3 way_W = move.X_WH.p - X_WH_before.p;
  if (at.s >= 1.0) return {move.X_WH, {}};
  return {{exp_rotation(at.s * turn_W) * X_WH_before.R, X_WH_before.p + at.s * way_W},
          {at.rate * way_W, at.rate * turn_W}};
}

HolderState state_within(const SwingMove& move, const Pose& X_WH_before, double time) {
  const Progress at = quintic(time, move.start, move.duration);
  const Matrix3 R = exp_rotation(at.s * move.angle * move.axis_W);
  const Vector3 arm_W = R * (X_WH_before.p - move.p_WA);
  const Vector3 w_W = at.rate * move.angle * move.axis_W;
  return {{R * X_WH_before.R, move.p_WA + arm_W}, {w_W.cross(arm_W), w_W}};
}

}  // namespace

std::vector<PlacedShape> make_walls(const Container& container) {
  const Vector3 inner = 0.5 * container.inner_size;
  const double wall = container.has_walls ? container.wall_thickness : 0.0;
  const double bottom = -container.floor_thickness;
  const double rim = container.inner_size.z();
  const double x = inner.x() + wall;
  const double y = inner.y() + wall;
  const PlacedShape floor = make_slab({-x, -y, bottom}, {x, y, 0.0});
  if (!container.has_walls) return {floor};
  return {floor, make_slab({-x, -y, 0.0}, {-inner.x(), y, rim}), make_slab({inner.x(), -y, 0.0}, {x, y, rim}),
          make_slab({-inner.x(), -y, 0.0}, {inner.x(), -inner.y(), rim}),
          make_slab({-inner.x(), inner.y(), 0.0}, {inner.x(), y, rim})};
}

Pose kinematic_pose_at(const Body& body, double time) {
  if (body.path) return pose_at(*body.path, time);
  const double elapsed = std::max(0.0, time - body.appears_at);
  return {exp_rotation(elapsed * body.V_WB.angular) * body.X_WB.R, body.X_WB.p + elapsed * body.V_WB.linear};
}

Twist kinematic_twist_at(const Body& body, double time) { return body.path ? twist_at(*body.path, time) : body.V_WB; }

HolderState holder_at(const Spring& spring, double time) {
  HolderState state{spring.X_WH, {}};
  for (const HolderMove& move : spring.moves) {
    const double start = std::visit([](const auto& m) { return m.start; }, move);
    if (time < start) break;
    const Pose X_WH_before = state.X_WH;
    state = std::visit([&](const auto& m) { return state_within(m, X_WH_before, time); }, move);
  }
  return state;
}

Matrix3 standing_rotation(UpAxis up, int up_sign, double yaw) {
  const int k = static_cast<int>(up);
  Matrix3 R_AP = Matrix3::Zero();
  R_AP(0, (k + 1) % 3) = 1.0;
  R_AP(1, (k + 2) % 3) = 1.0;
  R_AP(2, k) = 1.0;
  if (up_sign < 0) {
    R_AP.row(1) *= -1.0;
    R_AP.row(2) *= -1.0;
  }
  // Quarter turns come out exact, so that standing boxes are flush with the plates.
  const double quarter = std::round(yaw / (0.5 * std::numbers::pi));
  double c = std::cos(yaw);
  double s = std::sin(yaw);
  if (std::abs(yaw - quarter * 0.5 * std::numbers::pi) < 1e-12) {
    c = std::round(c);
    s = std::round(s);
  }
  Matrix3 turn = Matrix3::Identity();
  turn.topLeftCorner<2, 2>() << c, -s, s, c;
  return turn * R_AP;
}

Pose standing_pose(const Aligner& aligner, const Vector3& size, const Matrix3& R_AP) {
  const Vector3 half_A = 0.5 * (R_AP.cwiseAbs() * size);
  const Vector3 p_AP(half_A.x(), half_A.y(), 0.0);
  Pose X_WP{aligner.X_WA.R * R_AP, aligner.X_WA * p_AP};
  X_WP.p.z() = aligner.support_height + half_A.z();
  return X_WP;
}

bool has_heavy_side_at_corner(const Matrix3& R_AP) {
  const Vector3 z_A = R_AP.col(2);
  if (std::abs(z_A.z()) > 0.5) return true;
  return z_A.x() + z_A.y() > 0.0;
}

}  // namespace snug::model
