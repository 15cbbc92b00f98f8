// BoxBox: picks the axis, then builds the manifold that belongs to it.
#include <algorithm>
#include <cmath>

#include "snug/geometry/internal/box_axes.hpp"
#include "snug/geometry/internal/box_box.hpp"
#include "snug/geometry/internal/box_clip.hpp"
#include "snug/geometry/internal/box_topology.hpp"
#include "snug/geometry/internal/polytope_pair.hpp"
#include "snug/geometry/internal/segment.hpp"

namespace snug::geometry::internal {

namespace {

/// The axis of the contact: the remembered one while it is as good as the best, else the best face unless an edge is
/// better by more than half the allowance. `separation` receives the largest of all.
BoxAxis choose(const BoxPair& pair, const BoxAxes& axes, const Axis& remembered, double& separation) noexcept {
  const bool has_edge = axes.best_edge.axis.kind == AxisKind::Edge;
  separation = has_edge ? axes.best_edge.separation : axes.best_face.separation;
  const double slack = allowance(separation);
  if (remembered.kind != AxisKind::None && !(remembered == axes.best_face.axis)) {
    const BoxAxis old = evaluate(pair, remembered);
    const double least = remembered.kind == AxisKind::Edge ? std::max(axes.best_face.separation, separation - slack)
                                                           : separation - slack;
    if (old.separation >= least) return old;
  } else if (remembered.kind != AxisKind::None && axes.best_face.separation >= separation - slack) {
    return axes.best_face;
  }
  return axes.best_face.separation >= separation - 0.5 * slack ? axes.best_face : axes.best_edge;
}

/// README.md, "Seams": apart or hardly overlapping along n, and flush along a second face axis.
bool is_corner_pair(const BoxPair& pair, const BoxAxes& axes, const BoxAxis& chosen) noexcept {
  if (chosen.separation <= -kCornerSlop) return false;
  for (int k = 0; k < 6; ++k) {
    if (std::abs(axes.face[static_cast<std::size_t>(k)]) > kCornerSlop) continue;
    if (std::abs(face_normal(pair, axes, k).dot(chosen.n_A)) <= kCornerCosine) return true;
  }
  return false;
}

void clip(const BoxPair& pair, bool ref_is_A, int face, const Vector3& n_A, bool swapped,
          BoxPolygon& polygon) noexcept {
  if (ref_is_A) {
    clip_box_face({pair.half_A, pair.half_B, pair.R_AB, pair.p_AB, face, n_A, !swapped}, polygon);
  } else {
    const Matrix3 R_BA = pair.R_AB.transpose();
    clip_box_face({pair.half_B, pair.half_A, R_BA, -(R_BA * pair.p_AB), face, -(R_BA * n_A), swapped}, polygon);
  }
}

/// Of the rectangle along the reference face that holds all corners, m^2.
double rectangle_area(const BoxPolygon& polygon) noexcept {
  const BoxClipPoint& first = polygon.points[0];
  double low_u = first.u, high_u = first.u, low_v = first.v, high_v = first.v;
  for (int i = 1; i < polygon.count; ++i) {
    const BoxClipPoint& corner = polygon.points[static_cast<std::size_t>(i)];
    low_u = std::min(low_u, corner.u), high_u = std::max(high_u, corner.u);
    low_v = std::min(low_v, corner.v), high_v = std::max(high_v, corner.v);
  }
  return (high_u - low_u) * (high_v - low_v);
}

/// Writes the corners within the margin.
void emit_polygon(const PairCall& call, const BoxPolygon& polygon, bool ref_is_A, int face, const Vector3& half_ref,
                  const Vector3& n_A, Manifold& out) noexcept {
  const Pose& X_WR = ref_is_A ? call.X_WA : call.X_WB;
  const int ax = face / 2;
  const int au = next(ax);
  const int av = next(au);
  const Vector3 base = X_WR.p + ((face & 1) != 0 ? half_ref[ax] : -half_ref[ax]) * X_WR.R.col(ax);
  const Vector3 n_W = call.X_WA.R * n_A;
  const Vector3 out_of_ref = ref_is_A ? n_W : Vector3(-n_W);
  set_normal(call.swapped, n_W, out);
  out.face_area = rectangle_area(polygon);
  for (int i = 0; i < polygon.count; ++i) {
    const BoxClipPoint& corner = polygon.points[static_cast<std::size_t>(i)];
    if (!(corner.phi <= call.margin)) continue;
    const Vector3 p_ref = base + corner.u * X_WR.R.col(au) + corner.v * X_WR.R.col(av);
    const Vector3 p_inc = p_ref + corner.phi * out_of_ref;
    if (ref_is_A) {
      emit(call.swapped, p_ref, p_inc, corner.phi, corner.code_ref, corner.code_inc, out);
    } else {
      emit(call.swapped, p_inc, p_ref, corner.phi, corner.code_inc, corner.code_ref, out);
    }
  }
}

bool face_contact(const BoxPair& pair, const BoxAxis& chosen, double separation, const PairCall& call,
                  Manifold& out) noexcept {
  const bool ref_is_A = chosen.axis.kind == AxisKind::FaceA;
  const int face = ref_is_A ? chosen.axis.a : chosen.axis.b;
  BoxPolygon polygon;
  clip(pair, ref_is_A, face, chosen.n_A, call.swapped, polygon);
  if (polygon.count == 0 || polygon.least_phi > separation + allowance(separation)) return false;
  // The allowance must not carry a contact over the margin.
  if (separation > 0.0 && polygon.least_phi > call.margin) return false;
  emit_polygon(call, polygon, ref_is_A, face, ref_is_A ? pair.half_A : pair.half_B, chosen.n_A, out);
  return true;
}

int largest(const Vector3& v) noexcept {
  int axis = std::abs(v[1]) > std::abs(v[0]) ? 1 : 0;
  if (std::abs(v[2]) > std::abs(v[axis])) axis = 2;
  return axis;
}

/// Ends of edge e of a box, in the box frame.
void edge_ends(const Vector3& half, int e, Vector3& p, Vector3& q) noexcept {
  const std::array<int, 4>& edge = kBoxEdges[static_cast<std::size_t>(e)];
  for (int k = 0; k < 3; ++k) {
    p[k] = (edge[0] >> k & 1) != 0 ? half[k] : -half[k];
    q[k] = (edge[1] >> k & 1) != 0 ? half[k] : -half[k];
  }
}

/// An edge almost flat on a face touches along the whole of it: the polygon over the face that is nearly square to the
/// normal, when there is one and the polygon holds the point that the axis belongs to.
bool near_face_contact(const BoxPair& pair, const BoxAxis& chosen, const PairCall& call, Manifold& out) noexcept {
  const Vector3 n_B = pair.R_AB.transpose() * chosen.n_A;
  const int axis_A = largest(chosen.n_A), axis_B = largest(n_B);
  const double cosine_A = std::abs(chosen.n_A[axis_A]), cosine_B = std::abs(n_B[axis_B]);
  if (std::max(cosine_A, cosine_B) <= kNearFaceCosine) return false;
  const bool ref_is_A = cosine_A >= cosine_B;
  const int face = ref_is_A ? box_face(axis_A, chosen.n_A[axis_A] > 0.0) : box_face(axis_B, n_B[axis_B] < 0.0);
  BoxPolygon polygon;
  clip(pair, ref_is_A, face, chosen.n_A, call.swapped, polygon);
  if (polygon.count < 2 || std::abs(polygon.least_phi - chosen.separation) >= kMiss) return false;
  emit_polygon(call, polygon, ref_is_A, face, ref_is_A ? pair.half_A : pair.half_B, chosen.n_A, out);
  return true;
}

/// Two edges that cross. False when the edges do not meet across the axis, unless `forced`.
bool edge_contact(const BoxPair& pair, const BoxAxis& chosen, const PairCall& call, bool forced,
                  Manifold& out) noexcept {
  Vector3 a0, a1, b0, b1;
  edge_ends(pair.half_A, chosen.axis.a, a0, a1);
  edge_ends(pair.half_B, chosen.axis.b, b0, b1);
  b0 = pair.R_AB * b0 + pair.p_AB;
  b1 = pair.R_AB * b1 + pair.p_AB;
  const SegmentPair crossing = crossing_points(a0, a1, b0, b1, chosen.separation * chosen.n_A);
  const double miss = (crossing.p_b - crossing.p_a - chosen.separation * chosen.n_A).norm();
  if (miss > kMiss && !forced) return false;
  if (near_face_contact(pair, chosen, call, out)) return true;
  const Vector3 n_W = call.X_WA.R * chosen.n_A;
  const Vector3 p_WA = call.X_WA * crossing.p_a;
  set_normal(call.swapped, n_W, out);
  emit(call.swapped, p_WA, p_WA + chosen.separation * n_W, chosen.separation, edge_code(chosen.axis.a),
       edge_code(chosen.axis.b), out);
  return true;
}

/// What is left when rounding leaves no polygon: the deepest corner over the face plane.
void corner_contact(const BoxPair& pair, const BoxAxis& chosen, const PairCall& call, Manifold& out) noexcept {
  const bool ref_is_A = chosen.axis.kind == AxisKind::FaceA;
  const Vector3 toward = ref_is_A ? Vector3(-(pair.R_AB.transpose() * chosen.n_A)) : chosen.n_A;
  const Vector3& half = ref_is_A ? pair.half_B : pair.half_A;
  Vector3 corner;
  int vertex = 0;
  for (int k = 0; k < 3; ++k) {
    corner[k] = toward[k] > 0.0 ? half[k] : -half[k];
    if (toward[k] > 0.0) vertex |= 1 << k;
  }
  const Vector3 n_W = call.X_WA.R * chosen.n_A;
  const double phi = chosen.separation;
  set_normal(call.swapped, n_W, out);
  if (ref_is_A) {
    const Vector3 p_WB = call.X_WB * corner;
    emit(call.swapped, p_WB - phi * n_W, p_WB, phi, face_code(chosen.axis.a), vertex_code(vertex), out);
  } else {
    const Vector3 p_WA = call.X_WA * corner;
    emit(call.swapped, p_WA, p_WA + phi * n_W, phi, vertex_code(vertex), face_code(chosen.axis.b), out);
  }
}

/// The contact that belongs to the axis, if the features of the axis meet.
bool contact_along(const BoxPair& pair, const BoxAxis& axis, double separation, const PairCall& call,
                   Manifold& out) noexcept {
  switch (axis.axis.kind) {
    case AxisKind::None:
      return false;
    case AxisKind::Edge:
      return edge_contact(pair, axis, call, false, out);
    default:
      return face_contact(pair, axis, separation, call, out);
  }
}

}  // namespace

namespace {

/// The best face of the other box, when it separates as well as the chosen one does; -1: it does not.
int find_tied_face(const BoxAxes& axes, const BoxAxis& chosen) noexcept {
  const int first = chosen.axis.kind == AxisKind::FaceA ? 3 : 0;
  int slot = first;
  for (int k = first + 1; k < first + 3; ++k) {
    if (axes.face[static_cast<std::size_t>(k)] > axes.face[static_cast<std::size_t>(slot)]) slot = k;
  }
  return axes.face[static_cast<std::size_t>(slot)] >= chosen.separation - allowance(chosen.separation) ? slot : -1;
}

/// Index of the axis, a column of R, that is parallel to d; -1: none.
int parallel_axis(const Matrix3& R, const Vector3& d) noexcept {
  for (int k = 0; k < 3; ++k) {
    if (R.col(k).cross(d).squaredNorm() < kEdgesParallelSquared) return k;
  }
  return -1;
}

/// The edge along axis k that lies farthest along n, both in the frame of the box.
int support_edge(int k, const Vector3& n) noexcept { return box_edge(k, n[next(k)] > 0.0, n[next(next(k))] > 0.0); }

/// Two parallel edges that meet with a face of each on either side: neither face has a better claim to the normal than
/// the other, so it lies halfway between them. Both ends of the edges' common part.
bool parallel_edge_contact(const BoxPair& pair, const BoxAxes& axes, const BoxAxis& chosen, const PairCall& call,
                           Manifold& out) noexcept {
  if (chosen.separation > kBias) return false;
  const int slot = chosen.axis.kind == AxisKind::Edge ? -1 : find_tied_face(axes, chosen);
  if (slot < 0) return false;
  const Vector3 other = face_normal(pair, axes, slot);
  const double cosine = chosen.n_A.dot(other);
  if (cosine > kSameNormal || cosine < kOppositeEdges) return false;
  const Vector3 d = chosen.n_A.cross(other).normalized(), n = (chosen.n_A + other).normalized();
  const int axis_A = parallel_axis(Matrix3::Identity(), d), axis_B = parallel_axis(pair.R_AB, d);
  if (axis_A < 0 || axis_B < 0) return false;
  const int edge_A = support_edge(axis_A, n), edge_B = support_edge(axis_B, Vector3(-(pair.R_AB.transpose() * n)));
  Vector3 a0, a1, b0, b1;
  edge_ends(pair.half_A, edge_A, a0, a1);
  edge_ends(pair.half_B, edge_B, b0, b1);
  b0 = pair.R_AB * b0 + pair.p_AB, b1 = pair.R_AB * b1 + pair.p_AB;
  const Vector3 along = (a1 - a0).normalized();
  const double t0 = along.dot(b0 - a0), t1 = along.dot(b1 - a0);
  const double low = std::max(0.0, std::min(t0, t1)), high = std::min((a1 - a0).norm(), std::max(t0, t1));
  if (!(high - low > kMiss)) return false;
  // The edges meet: what lies between them is along n alone.
  const Vector3 between = b0 - a0 - t0 * along;
  const double separation = n.dot(between);
  if ((between - separation * n).norm() > kEdgeMiss) return false;
  if (separation < chosen.separation - allowance(chosen.separation)) return false;
  const Vector3 n_W = call.X_WA.R * n;
  set_normal(call.swapped, n_W, out);
  int end = 0;
  for (const double t : {low, high}) {
    const Vector3 p_A = a0 + t * along;
    const double share = (t - t0) / (t1 - t0);
    const double phi = n.dot(b0 + share * (b1 - b0) - p_A);
    const std::uint32_t second = end++ == 0 ? 0U : kSecond;
    if (!(phi <= call.margin)) continue;
    const Vector3 p_WA = call.X_WA * p_A;
    emit(call.swapped, p_WA, p_WA + phi * n_W, phi, edge_code(edge_A) | second, edge_code(edge_B) | second, out);
  }
  return out.count > 0;
}

}  // namespace

void collide_boxes(const Box& A, const Box& B, const PairCall& call, Axis& axis, Manifold& out) noexcept {
  out.face_area = 0.0;
  if (axis.kind != AxisKind::None &&
      quick_separation(A.half, call.X_WA, B.half, call.X_WB, axis) > call.margin + kTie) {
    return;
  }
  BoxPair pair{A.half, B.half, {}, {}};
  pair.place(call.X_WA, call.X_WB);
  BoxAxes axes;
  if (!find_axes(pair, call.margin, axes)) {
    axis = axes.best_face.axis;
    return;
  }
  double separation = 0.0;
  const BoxAxis chosen = choose(pair, axes, axis, separation);
  axis = chosen.axis;
  out.is_corner_pair = is_corner_pair(pair, axes, chosen);
  if (out.is_corner_pair) return;
  if (parallel_edge_contact(pair, axes, chosen, call, out)) return;
  if (contact_along(pair, chosen, separation, call, out)) return;
  if (separation > 0.0) return collide_apart(A, B, pair.R_AB, pair.p_AB, chosen.n_A, call, out);
  // What was chosen for the sake of the past, or by preference, has nothing to show: the best of the other kind.
  for (const BoxAxis& other : {axes.best_face, axes.best_edge}) {
    if (other.axis == chosen.axis || other.separation < separation - allowance(separation)) continue;
    axis = other.axis;
    if (contact_along(pair, other, separation, call, out)) return;
  }
  const bool by_edge = axes.best_edge.axis.kind == AxisKind::Edge;
  axis = by_edge ? axes.best_edge.axis : axes.best_face.axis;
  if (by_edge) {
    edge_contact(pair, axes.best_edge, call, true, out);
  } else {
    corner_contact(pair, axes.best_face, call, out);
  }
}

}  // namespace snug::geometry::internal
