// BoxAxes: separations along face normals and edge cross products, after Gottschalk's OBB test, with unit axes.
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "snug/geometry/internal/box_axes.hpp"
#include "snug/geometry/internal/box_topology.hpp"
#include "snug/geometry/internal/tolerances.hpp"

namespace snug::geometry::internal {

namespace {

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

/// One of the nine cross products. It is worked out in full only when its unnormalised form beats the best so far.
template <int i, int j>
bool is_worth_normalising(const BoxPair& pair, const Matrix3& abs_R, double best) noexcept {
  constexpr int i1 = next(i);
  constexpr int i2 = next(i1);
  constexpr int j1 = next(j);
  constexpr int j2 = next(j1);
  const double c1 = pair.R_AB(i1, j);
  const double c2 = pair.R_AB(i2, j);
  const double length_squared = c1 * c1 + c2 * c2;
  if (length_squared <= kParallelSquared) return false;
  const double gap = std::abs(pair.p_AB[i2] * c1 - pair.p_AB[i1] * c2) -
                     ((pair.half_A[i1] * abs_R(i2, j) + pair.half_A[i2] * abs_R(i1, j)) +
                      (pair.half_B[j1] * abs_R(i, j2) + pair.half_B[j2] * abs_R(i, j1)));
  // gap / length > best, without root and division.
  const double bound = best * best * length_squared;
  return best < 0.0 ? (gap >= 0.0 || gap * gap < bound) : (gap > 0.0 && gap * gap > bound);
}

bool find_edge_axis(const BoxPair& pair, const Matrix3& abs_R, double margin, BoxAxes& out) noexcept {
  // An edge axis that ties with the face axis is the face axis.
  double best = out.best_face.separation + kMiss;
  const auto go_on = [&]<int i, int j>(std::integral_constant<int, i>, std::integral_constant<int, j>) {
    if (!is_worth_normalising<i, j>(pair, abs_R, best)) return true;
    const BoxAxis axis = edge_axis(pair, i, j);
    if (!(axis.separation > best)) return true;
    best = axis.separation;
    out.best_edge = axis;
    return best <= margin;
  };
  constexpr std::integral_constant<int, 0> x;
  constexpr std::integral_constant<int, 1> y;
  constexpr std::integral_constant<int, 2> z;
  return go_on(x, x) && go_on(x, y) && go_on(x, z) && go_on(y, x) && go_on(y, y) && go_on(y, z) && go_on(z, x) &&
         go_on(z, y) && go_on(z, z);
}

/// When the best face is parallel to a face of the other box, each edge axis is a face axis again. "Parallel" when the
/// tilt moves no corner by more than a quarter of kBias: then the best face would be chosen whatever the edges say.
bool edges_repeat_faces(const BoxPair& pair, int best) noexcept {
  const Vector3 c = best < 3 ? Vector3(pair.R_AB.row(best)) : Vector3(pair.R_AB.col(best - 3));
  const Vector3 squares = c.cwiseAbs2();
  const double tilt_squared = std::min({squares[0] + squares[1], squares[1] + squares[2], squares[2] + squares[0]});
  const double reach_squared = 2.0 * (pair.half_A.squaredNorm() + pair.half_B.squaredNorm());
  return tilt_squared * reach_squared < 0.0625 * kBias * kBias;
}

/// Gaps along the six face normals and which face looks at the other box.
void find_face_gaps(const BoxPair& pair, const Matrix3& abs_R, BoxAxes& out) noexcept {
  const Vector3 p_B = pair.R_AB.transpose() * pair.p_AB;
  const Vector3 gap_A = pair.p_AB.cwiseAbs() - pair.half_A - abs_R * pair.half_B;
  const Vector3 gap_B = p_B.cwiseAbs() - pair.half_B - abs_R.transpose() * pair.half_A;
  for (int k = 0; k < 3; ++k) {
    const auto slot = static_cast<std::size_t>(k);
    out.face[slot] = gap_A[k];
    out.face[slot + 3] = gap_B[k];
    // The face of A looks along +p_AB, that of B against it.
    out.face_index[slot] = box_face(k, pair.p_AB[k] >= 0.0);
    out.face_index[slot + 3] = box_face(k, p_B[k] < 0.0);
  }
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
  find_face_gaps(pair, abs_R, out);
  std::size_t best = 0;
  for (std::size_t k = 1; k < 6; ++k) {
    if (out.face[k] > out.face[best] + kTie) best = k;
  }
  out.best_face.axis =
      best < 3 ? Axis{AxisKind::FaceA, out.face_index[best], 0} : Axis{AxisKind::FaceB, 0, out.face_index[best]};
  out.best_face.separation = out.face[best];
  // A NaN in any of the six must not pass as a contact; all six enter the sum.
  const double sum = (out.face[0] + out.face[1] + out.face[2]) + (out.face[3] + out.face[4] + out.face[5]);
  if (!(out.best_face.separation <= margin) || std::isnan(sum)) return false;
  out.best_face.n_A = face_normal(pair, out, static_cast<int>(best));
  if (edges_repeat_faces(pair, static_cast<int>(best)) || find_edge_axis(pair, abs_R, margin, out)) return true;
  out.best_face = out.best_edge;
  return false;
}

}  // namespace snug::geometry::internal
