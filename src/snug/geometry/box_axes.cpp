// BoxAxes: separations along face normals and edge cross products, after Gottschalk's OBB test, with unit axes.
#include <cmath>
#include <limits>

#include "snug/geometry/internal/box_axes.hpp"
#include "snug/geometry/internal/box_topology.hpp"
#include "snug/geometry/internal/tolerances.hpp"

namespace snug::geometry::internal {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Separation along the unit direction n_A: what lies between the two support planes.
double separation_along(const BoxPair& pair, const Vector3& n_A) noexcept {
  const Vector3 n_B = pair.R_AB.transpose() * n_A;
  return n_A.dot(pair.p_AB) - n_A.cwiseAbs().dot(pair.half_A) - n_B.cwiseAbs().dot(pair.half_B);
}

/// a_i x b_j, unit, from A to B; separation -infinity when the edges are parallel.
BoxAxis edge_axis(const BoxPair& pair, int i, int j) noexcept {
  const int i1 = next(i);
  const int i2 = next(i1);
  const double c1 = pair.R_AB(i1, j);
  const double c2 = pair.R_AB(i2, j);
  const double length_squared = c1 * c1 + c2 * c2;
  BoxAxis result;
  result.separation = -kInfinity;
  if (!(length_squared > kParallelSquared)) return result;
  Vector3 n_A = Vector3::Zero();
  const double scale = 1.0 / std::sqrt(length_squared);
  n_A[i1] = -c2 * scale;
  n_A[i2] = c1 * scale;
  if (n_A.dot(pair.p_AB) < 0.0) n_A = -n_A;
  const int j1 = next(j);
  const int j2 = next(j1);
  result.n_A = n_A;
  result.separation = separation_along(pair, n_A);
  result.axis = {AxisKind::Edge, box_edge(i, n_A[i1] > 0.0, n_A[i2] > 0.0),
                 box_edge(j, n_A.dot(pair.R_AB.col(j1)) < 0.0, n_A.dot(pair.R_AB.col(j2)) < 0.0)};
  return result;
}

/// The nine cross products. An axis is worked out in full only when its unnormalised form beats the best so far.
bool find_edge_axis(const BoxPair& pair, const Matrix3& abs_R, double margin, BoxAxes& out) noexcept {
  double best = out.best_face.separation;
  for (int i = 0; i < 3; ++i) {
    const int i1 = next(i);
    const int i2 = next(i1);
    for (int j = 0; j < 3; ++j) {
      const int j1 = next(j);
      const int j2 = next(j1);
      const double c1 = pair.R_AB(i1, j);
      const double c2 = pair.R_AB(i2, j);
      const double gap = std::abs(pair.p_AB[i2] * c1 - pair.p_AB[i1] * c2) -
                         (pair.half_A[i1] * abs_R(i2, j) + pair.half_A[i2] * abs_R(i1, j) +
                          pair.half_B[j1] * abs_R(i, j2) + pair.half_B[j2] * abs_R(i, j1));
      // gap / length > best, without root and division.
      const double bound = best * best * (c1 * c1 + c2 * c2);
      const bool beats = best < 0.0 ? (gap >= 0.0 || gap * gap < bound) : (gap > 0.0 && gap * gap > bound);
      if (!beats) continue;
      const BoxAxis axis = edge_axis(pair, i, j);
      if (!(axis.separation > best)) continue;
      best = axis.separation;
      out.best_edge = axis;
      if (best > margin) return false;
    }
  }
  return true;
}

}  // namespace

void BoxPair::place(const Pose& X_WA, const Pose& X_WB) noexcept {
  R_AB.noalias() = X_WA.R.transpose() * X_WB.R;
  p_AB.noalias() = X_WA.R.transpose() * (X_WB.p - X_WA.p);
}

Vector3 face_normal(const BoxPair& pair, const BoxAxes& axes, int which) noexcept {
  const bool positive = (axes.face_index[static_cast<std::size_t>(which)] & 1) != 0;
  if (which < 3) return (positive ? 1.0 : -1.0) * Vector3::Unit(which);
  return (positive ? -1.0 : 1.0) * pair.R_AB.col(which - 3);
}

BoxAxis evaluate(const BoxPair& pair, const Axis& axis) noexcept {
  BoxAxis result;
  result.separation = -kInfinity;
  if (axis.kind == AxisKind::FaceA && axis.a < 6) {
    result.axis = {AxisKind::FaceA, axis.a, 0};
    result.n_A = ((axis.a & 1) != 0 ? 1.0 : -1.0) * Vector3::Unit(axis.a / 2);
    result.separation = separation_along(pair, result.n_A);
  } else if (axis.kind == AxisKind::FaceB && axis.b < 6) {
    result.axis = {AxisKind::FaceB, 0, axis.b};
    result.n_A = ((axis.b & 1) != 0 ? -1.0 : 1.0) * pair.R_AB.col(axis.b / 2);
    result.separation = separation_along(pair, result.n_A);
  } else if (axis.kind == AxisKind::Edge && axis.a < 12 && axis.b < 12) {
    const BoxAxis found = edge_axis(pair, axis.a / 4, axis.b / 4);
    if (found.axis == axis) return found;
  }
  return result;
}

double quick_separation(const Vector3& half_A, const Pose& X_WA, const Vector3& half_B, const Pose& X_WB,
                        const Axis& axis) noexcept {
  const Vector3 p_AB_W = X_WB.p - X_WA.p;
  if (axis.kind == AxisKind::FaceA && axis.a < 6) {
    const int i = axis.a / 2;
    const Vector3 n_W = X_WA.R.col(i);
    const Vector3 n_B = X_WB.R.transpose() * n_W;
    return std::abs(n_W.dot(p_AB_W)) - half_A[i] - n_B.cwiseAbs().dot(half_B);
  }
  if (axis.kind == AxisKind::FaceB && axis.b < 6) {
    const int j = axis.b / 2;
    const Vector3 n_W = X_WB.R.col(j);
    const Vector3 n_A = X_WA.R.transpose() * n_W;
    return std::abs(n_W.dot(p_AB_W)) - half_B[j] - n_A.cwiseAbs().dot(half_A);
  }
  if (axis.kind == AxisKind::Edge && axis.a < 12 && axis.b < 12) {
    const Vector3 cross = X_WA.R.col(axis.a / 4).cross(X_WB.R.col(axis.b / 4));
    const double length_squared = cross.squaredNorm();
    if (!(length_squared > kParallelSquared)) return -kInfinity;
    const Vector3 n_A = X_WA.R.transpose() * cross;
    const Vector3 n_B = X_WB.R.transpose() * cross;
    const double gap = std::abs(cross.dot(p_AB_W)) - n_A.cwiseAbs().dot(half_A) - n_B.cwiseAbs().dot(half_B);
    return gap / std::sqrt(length_squared);
  }
  return -kInfinity;
}

bool find_axes(const BoxPair& pair, double margin, BoxAxes& out) noexcept {
  const Matrix3 abs_R = pair.R_AB.cwiseAbs();
  const Vector3 p_B = pair.R_AB.transpose() * pair.p_AB;
  const Vector3 reach_B = abs_R * pair.half_B;
  const Vector3 reach_A = abs_R.transpose() * pair.half_A;
  int best = 0;
  for (int k = 0; k < 6; ++k) {
    const bool of_A = k < 3;
    const int axis = of_A ? k : k - 3;
    const double distance = of_A ? pair.p_AB[axis] : p_B[axis];
    const double reach = of_A ? pair.half_A[axis] + reach_B[axis] : pair.half_B[axis] + reach_A[axis];
    const auto slot = static_cast<std::size_t>(k);
    out.face[slot] = std::abs(distance) - reach;
    // The face of A looks along +p_AB, that of B against it.
    out.face_index[slot] = box_face(axis, of_A == (distance >= 0.0));
    // Negated so that a NaN leaves through the same door as a gap.
    if (out.face[slot] > out.face[static_cast<std::size_t>(best)] + kTie) best = k;
    if (!(out.face[slot] <= margin)) {
      best = k;
      break;
    }
  }
  const auto slot = static_cast<std::size_t>(best);
  out.best_face.axis = best < 3 ? Axis{AxisKind::FaceA, out.face_index[slot], 0}
                                : Axis{AxisKind::FaceB, 0, out.face_index[slot]};
  out.best_face.separation = out.face[slot];
  if (!(out.best_face.separation <= margin)) return false;
  out.best_face.n_A = face_normal(pair, out, best);
  if (!find_edge_axis(pair, abs_R, margin, out)) {
    out.best_face = out.best_edge;
    return false;
  }
  return true;
}

}  // namespace snug::geometry::internal
