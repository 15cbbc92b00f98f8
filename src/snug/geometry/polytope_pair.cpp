// PolytopePair: the same steps as BoxBox, written for any number of faces.
#include <algorithm>
#include <cmath>

#include "snug/geometry/internal/clip.hpp"
#include "snug/geometry/internal/closest.hpp"
#include "snug/geometry/internal/polytope_pair.hpp"
#include "snug/geometry/internal/segment.hpp"
#include "snug/geometry/internal/tolerances.hpp"

namespace snug::geometry::internal {

namespace {

struct PolytopeAxis {
  Axis axis;
  double separation = -kInfinity;  ///< between the cores, m
  Vector3 n = Vector3::UnitZ();    ///< unit, from A to B
};

struct PolytopeAxes {
  std::array<double, kMaxHullFaces> face_A;
  std::array<double, kMaxHullFaces> face_B;
  PolytopeAxis best_face;
  PolytopeAxis best_edge;
};

double separation_along(const PolytopePair& pair, const Vector3& n) noexcept {
  return -pair.B.support(-n) - pair.A.support(n);
}

Vector3 edge_direction(const Polytope& shape, int e) noexcept {
  const std::array<int, 4>& edge = shape.edge(e);
  return (shape.vertex(edge[1]) - shape.vertex(edge[0])).normalized();
}

/// Cross product of edges i and j, of directions d_a and d_b, outward from A; false when they are parallel or their
/// arcs of normals do not cross, so that the pair is no face of the Minkowski difference. Kept loose: a pair too many
/// costs time, one too few costs depth.
bool cross_edges(const PolytopePair& pair, int i, int j, const Vector3& d_a, const Vector3& d_b, Vector3& n) noexcept {
  constexpr double kLoose = 1e-9;
  const std::array<int, 4>& a = pair.A.edge(i);
  const std::array<int, 4>& b = pair.B.edge(j);
  if (d_b.dot(pair.A.normal(a[2])) * d_b.dot(pair.A.normal(a[3])) > kLoose) return false;
  const bool has_faces = b[2] >= 0;
  if (has_faces && d_a.dot(pair.B.normal(b[2])) * d_a.dot(pair.B.normal(b[3])) > kLoose) return false;
  n = d_a.cross(d_b);
  const double length_squared = n.squaredNorm();
  if (!(length_squared > kParallelSquared)) return false;
  n /= std::sqrt(length_squared);
  if (n.dot(pair.A.normal(a[2]) + pair.A.normal(a[3])) < 0.0) n = -n;
  return !has_faces || n.dot(pair.B.normal(b[2]) + pair.B.normal(b[3])) <= kLoose;
}

PolytopeAxis evaluate(const PolytopePair& pair, const Axis& axis) noexcept {
  PolytopeAxis result;
  if (axis.kind == AxisKind::FaceA && axis.a < pair.A.face_count()) {
    result.n = pair.A.normal(axis.a);
  } else if (axis.kind == AxisKind::FaceB && axis.b < pair.B.face_count()) {
    result.n = -pair.B.normal(axis.b);
  } else if (axis.kind != AxisKind::Edge || axis.a >= pair.A.edge_count() || axis.b >= pair.B.edge_count() ||
             !cross_edges(pair, axis.a, axis.b, edge_direction(pair.A, axis.a), edge_direction(pair.B, axis.b),
                          result.n)) {
    return result;
  }
  result.axis = axis;
  result.separation = separation_along(pair, result.n);
  return result;
}

/// False as soon as a face separates by more than the limit; the face is then in best_face.
bool find_face_axes(const PolytopePair& pair, double limit, PolytopeAxes& out) noexcept {
  for (const bool of_A : {true, false}) {
    const Polytope& shape = of_A ? pair.A : pair.B;
    for (int f = 0; f < shape.face_count(); ++f) {
      const Axis axis = of_A ? Axis{AxisKind::FaceA, f, 0} : Axis{AxisKind::FaceB, 0, f};
      const PolytopeAxis candidate = evaluate(pair, axis);
      (of_A ? out.face_A : out.face_B)[static_cast<std::size_t>(f)] = candidate.separation;
      const bool is_apart = !(candidate.separation <= limit);  // so that a NaN ends here, too
      if (is_apart || candidate.separation > out.best_face.separation + kTie) out.best_face = candidate;
      if (is_apart) return false;
    }
  }
  return true;
}

bool find_edge_axes(const PolytopePair& pair, double limit, PolytopeAxes& out) noexcept {
  double best = out.best_face.separation;
  std::array<Vector3, kMaxHullEdges> directions_B;
  for (int j = 0; j < pair.B.edge_count(); ++j) directions_B[static_cast<std::size_t>(j)] = edge_direction(pair.B, j);
  for (int i = 0; i < pair.A.edge_count(); ++i) {
    const Vector3 d_a = edge_direction(pair.A, i);
    for (int j = 0; j < pair.B.edge_count(); ++j) {
      Vector3 n;
      if (!cross_edges(pair, i, j, d_a, directions_B[static_cast<std::size_t>(j)], n)) continue;
      const double quick = n.dot(pair.B.vertex(pair.B.edge(j)[0]) - pair.A.vertex(pair.A.edge(i)[0]));
      if (!(quick > best)) continue;
      const double separation = separation_along(pair, n);
      if (!(separation > best)) continue;
      best = separation;
      out.best_edge = {{AxisKind::Edge, i, j}, separation, n};
      if (separation > limit) return false;
    }
  }
  return true;
}

PolytopeAxis choose(const PolytopePair& pair, const PolytopeAxes& axes, const Axis& remembered,
                    double& separation) noexcept {
  const bool has_edge = axes.best_edge.axis.kind == AxisKind::Edge;
  separation = has_edge ? axes.best_edge.separation : axes.best_face.separation;
  const double slack = allowance(separation);
  const PolytopeAxis old = evaluate(pair, remembered);
  const double least =
      remembered.kind == AxisKind::Edge ? std::max(axes.best_face.separation, separation - slack) : separation - slack;
  if (old.axis.kind != AxisKind::None && old.separation >= least) return old;
  return axes.best_face.separation >= separation - 0.5 * slack ? axes.best_face : axes.best_edge;
}

/// README.md, "Seams". Capsules are round and have no side walls.
bool is_corner_pair(const PolytopePair& pair, const PolytopeAxes& axes, const PolytopeAxis& chosen) noexcept {
  if (pair.B.is_segment() || chosen.separation <= -kCornerSlop) return false;
  for (int f = 0; f < pair.A.face_count(); ++f) {
    if (std::abs(axes.face_A[static_cast<std::size_t>(f)]) <= kCornerSlop &&
        std::abs(pair.A.normal(f).dot(chosen.n)) <= kCornerCosine) {
      return true;
    }
  }
  for (int f = 0; f < pair.B.face_count(); ++f) {
    if (std::abs(axes.face_B[static_cast<std::size_t>(f)]) <= kCornerSlop &&
        std::abs(pair.B.normal(f).dot(chosen.n)) <= kCornerCosine) {
      return true;
    }
  }
  return false;
}

/// From a point at `p` on the core of B against n to the surface of B: the radius, and more where a capsule is
/// left sideways through its round wall.
double surface_distance(const PolytopePair& pair, const Vector3& p, const Vector3& n) noexcept {
  if (pair.radius == 0.0 || pair.B.vertex_count() < 2) return pair.radius;
  const Vector3 along = pair.B.vertex(1) - pair.B.vertex(0);
  const double length = along.norm();
  const double cosine = n.dot(along) / length;
  const double at = (p - pair.B.vertex(0)).dot(along) / length;
  const double through_wall = pair.radius / std::sqrt(std::max(1.0 - cosine * cosine, 1e-30));
  const double leaves_at = at - through_wall * cosine;
  if (leaves_at >= 0.0 && leaves_at <= length) return through_wall;
  // Through the ball at one end.
  const double past = at - (leaves_at < 0.0 ? 0.0 : length);
  return past * cosine + std::sqrt(std::max(pair.radius * pair.radius - past * past * (1.0 - cosine * cosine), 0.0));
}

/// One point; p_A is on A, p_A + phi_core n on the core of B, in A.
void emit_point(const PolytopePair& pair, const PairCall& call, const Vector3& n, const Vector3& p_A, double phi_core,
                std::uint32_t code_A, std::uint32_t code_B, Manifold& out) noexcept {
  const double phi = phi_core - surface_distance(pair, p_A + phi_core * n, n);
  if (!(phi <= call.margin)) return;
  const Vector3 n_W = call.X_WA.R * n;
  const Vector3 p_WA = call.X_WA * p_A;
  set_normal(call.swapped, n_W, out);
  emit(call.swapped, p_WA, p_WA + phi * n_W, phi, code_A, code_B, out);
}

void emit_polygon(const PolytopePair& pair, const PairCall& call, const Vector3& n, bool ref_is_A, ClipPolygon& polygon,
                  Manifold& out) noexcept {
  // A capsule's segment has two points at most; a hull has no radius.
  if (!pair.B.is_segment()) reduce(call.margin, polygon);
  for (int i = 0; i < polygon.count; ++i) {
    const ClipPoint& point = polygon.points[static_cast<std::size_t>(i)];
    if (ref_is_A) {
      emit_point(pair, call, n, point.p_ref, point.phi, point.code_ref, point.code_inc, out);
    } else {
      emit_point(pair, call, n, point.p_ref - point.phi * n, point.phi, point.code_inc, point.code_ref, out);
    }
  }
}

bool face_contact(const PolytopePair& pair, const PolytopeAxis& chosen, double separation, const PairCall& call,
                  Manifold& out) noexcept {
  const bool ref_is_A = chosen.axis.kind == AxisKind::FaceA;
  ClipPolygon polygon;
  if (ref_is_A) {
    clip_faces({pair.A, chosen.axis.a, pair.B, chosen.n, !call.swapped}, polygon);
  } else {
    clip_faces({pair.B, chosen.axis.b, pair.A, -chosen.n, call.swapped}, polygon);
  }
  // A tilted capsule apart from a rim: its wall would come nearer along the face normal than it truly is.
  const double slack = pair.radius > 0.0 && separation > 0.0 ? kMiss : allowance(separation);
  if (polygon.count == 0 || polygon.least_phi > separation + slack) return false;
  // The allowance must not carry a contact over the margin.
  if (separation > 0.0 && polygon.least_phi > call.margin + pair.radius) return false;
  emit_polygon(pair, call, chosen.n, ref_is_A, polygon, out);
  return true;
}

/// The polygon over the face nearly square to n, when there is one and it holds the point at `distance` that n belongs
/// to.
bool near_face_contact(const PolytopePair& pair, const Vector3& n, double distance, const PairCall& call,
                       Manifold& out) noexcept {
  const int face_A = pair.A.face_along(n);
  const double cosine_A = pair.A.normal(face_A).dot(n);
  int face = face_A;
  bool ref_is_A = true;
  double cosine = cosine_A;
  if (!pair.B.is_segment()) {
    const int face_B = pair.B.face_along(-n);
    const double cosine_B = -pair.B.normal(face_B).dot(n);
    if (cosine_B > cosine_A) {
      face = face_B;
      ref_is_A = false;
      cosine = cosine_B;
    }
  }
  if (cosine <= kNearFaceCosine) return false;
  ClipPolygon polygon;
  if (ref_is_A) {
    clip_faces({pair.A, face, pair.B, n, !call.swapped}, polygon);
  } else {
    clip_faces({pair.B, face, pair.A, -n, call.swapped}, polygon);
  }
  if (polygon.count < 2 || std::abs(polygon.least_phi - distance) > kMiss) return false;
  emit_polygon(pair, call, n, ref_is_A, polygon, out);
  return true;
}

/// Two edges that cross. False when the edges do not meet across the axis, unless `forced`.
bool edge_contact(const PolytopePair& pair, const PolytopeAxis& chosen, const PairCall& call, bool forced,
                  Manifold& out) noexcept {
  const std::array<int, 4>& a = pair.A.edge(chosen.axis.a);
  const std::array<int, 4>& b = pair.B.edge(chosen.axis.b);
  const Vector3 offset = chosen.separation * chosen.n;
  const SegmentPair crossing =
      crossing_points(pair.A.vertex(a[0]), pair.A.vertex(a[1]), pair.B.vertex(b[0]), pair.B.vertex(b[1]), offset);
  if ((crossing.p_b - crossing.p_a - offset).norm() > kMiss && !forced) return false;
  if (near_face_contact(pair, chosen.n, chosen.separation, call, out)) return true;
  emit_point(pair, call, chosen.n, crossing.p_a, chosen.separation, edge_code(chosen.axis.a), edge_code(chosen.axis.b),
             out);
  return true;
}

void apart_contact(const PolytopePair& pair, const Vector3& n, const PairCall& call, Manifold& out) noexcept {
  Closest closest;
  if (!find_closest(pair.A, pair.B, n, call.margin + pair.radius, closest)) return;
  if (near_face_contact(pair, closest.n, closest.distance, call, out)) return;
  emit_point(pair, call, closest.n, closest.p_A, closest.distance, closest.code_A, closest.code_B, out);
}

/// What is left when rounding leaves no polygon: the deepest vertex over the face plane.
void vertex_contact(const PolytopePair& pair, const PolytopeAxis& chosen, const PairCall& call,
                    Manifold& out) noexcept {
  if (chosen.axis.kind == AxisKind::FaceA) {
    const int vertex = pair.B.support_vertex(-chosen.n);
    emit_point(pair, call, chosen.n, pair.B.vertex(vertex) - chosen.separation * chosen.n, chosen.separation,
               face_code(chosen.axis.a), vertex_code(vertex), out);
  } else {
    const int vertex = pair.A.support_vertex(chosen.n);
    emit_point(pair, call, chosen.n, pair.A.vertex(vertex), chosen.separation, vertex_code(vertex),
               face_code(chosen.axis.b), out);
  }
}

/// The contact that belongs to the axis, if the features of the axis meet.
bool contact_along(const PolytopePair& pair, const PolytopeAxis& axis, double separation, const PairCall& call,
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

void collide_polytopes(const PolytopePair& pair, const PairCall& call, Axis& axis, Manifold& out) noexcept {
  const double limit = call.margin + pair.radius;
  if (axis.kind != AxisKind::None && evaluate(pair, axis).separation > limit + kTie) return;
  PolytopeAxes axes;
  if (!find_face_axes(pair, limit, axes)) {
    axis = axes.best_face.axis;
    return;
  }
  if (!find_edge_axes(pair, limit, axes)) {
    axis = axes.best_edge.axis;
    return;
  }
  double separation = 0.0;
  const PolytopeAxis chosen = choose(pair, axes, axis, separation);
  axis = chosen.axis;
  out.is_corner_pair = is_corner_pair(pair, axes, chosen);
  if (out.is_corner_pair) return;
  if (contact_along(pair, chosen, separation, call, out)) return;
  if (separation > 0.0) return apart_contact(pair, chosen.n, call, out);
  // What was chosen for the sake of the past, or by preference, has nothing to show: the best of the other kind.
  for (const PolytopeAxis& other : {axes.best_face, axes.best_edge}) {
    if (other.axis == chosen.axis || other.separation < separation - allowance(separation)) continue;
    axis = other.axis;
    if (contact_along(pair, other, separation, call, out)) return;
  }
  const bool by_edge = axes.best_edge.axis.kind == AxisKind::Edge;
  axis = by_edge ? axes.best_edge.axis : axes.best_face.axis;
  if (by_edge) {
    edge_contact(pair, axes.best_edge, call, true, out);
  } else {
    vertex_contact(pair, axes.best_face, call, out);
  }
}

void collide_apart(const Box& A, const Box& B, const Matrix3& R_AB, const Vector3& p_AB, const Vector3& n_A,
                   const PairCall& call, Manifold& out) noexcept {
  PolytopeStorage room_A;
  PolytopeStorage room_B;
  const Polytope shape_A(A, Pose{}, room_A);
  const Polytope shape_B(B, Pose{R_AB, p_AB}, room_B);
  apart_contact({shape_A, shape_B}, n_A, call, out);
}

}  // namespace snug::geometry::internal
