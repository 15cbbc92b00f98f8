// Closest: compares vertices with faces and edges with edges, all that the separating planes leave in play.
//
// With A below a plane n.x = a and B above n.x = b, nearest points at distance d have
// (a - n.p_A) + (n.p_B - b) <= d - (b - a). The left side is the slack of the points; features whose least slack
// is larger than what the best distance so far allows cannot be nearest. This holds for any direction n, so two are
// used: the axis that separates most, and the line between the nearest two vertices.
#include <algorithm>
#include <limits>

#include "snug/geometry/internal/closest.hpp"
#include "snug/geometry/internal/segment.hpp"
#include "snug/geometry/internal/tolerances.hpp"

namespace snug::geometry::internal {

namespace {

/// Below this distance [m] the difference of the points is too short to give a direction.
constexpr double kTooShort = 1e-9;

/// Least slacks of the vertices of one shape along two directions.
struct Slack {
  std::array<std::array<double, 2>, kMaxHullVertices> at;
  std::array<double, 2> plane;  ///< largest n . p

  void fill(const Polytope& shape, const Vector3& n, std::size_t which) noexcept {
    plane[which] = -std::numeric_limits<double>::infinity();
    for (int v = 0; v < shape.vertex_count(); ++v) {
      const double reach = n.dot(shape.vertex(v));
      at[static_cast<std::size_t>(v)][which] = reach;
      plane[which] = std::max(plane[which], reach);
    }
    for (int v = 0; v < shape.vertex_count(); ++v) {
      double& value = at[static_cast<std::size_t>(v)][which];
      value = plane[which] - value;
    }
  }
  std::array<double, 2> of_edge(const std::array<int, 4>& e) const noexcept {
    const std::array<double, 2>& p = at[static_cast<std::size_t>(e[0])];
    const std::array<double, 2>& q = at[static_cast<std::size_t>(e[1])];
    return {std::min(p[0], q[0]), std::min(p[1], q[1])};
  }
  std::array<double, 2> of_face(std::span<const int> loop) const noexcept {
    std::array<double, 2> least = at[static_cast<std::size_t>(loop[0])];
    for (const int v : loop) {
      least[0] = std::min(least[0], at[static_cast<std::size_t>(v)][0]);
      least[1] = std::min(least[1], at[static_cast<std::size_t>(v)][1]);
    }
    return least;
  }
};

/// The two slacks and what separates the shapes along the two directions.
struct Pruning {
  Slack A;
  Slack B;
  std::array<double, 2> separation;

  void fill(const Polytope& shape_A, const Polytope& shape_B, const Vector3& n, std::size_t which) noexcept {
    A.fill(shape_A, n, which);
    B.fill(shape_B, -n, which);
    // Rounding of the slacks must not exclude the nearest features.
    separation[which] = -B.plane[which] - A.plane[which] - 1e-9;
  }
  /// Whether features with these slacks may be nearer than `distance`.
  [[nodiscard]] bool may_beat(const std::array<double, 2>& a, const std::array<double, 2>& b,
                              double distance) const noexcept {
    return a[0] + b[0] + separation[0] <= distance && a[1] + b[1] + separation[1] <= distance;
  }
};

constexpr std::array<double, 2> kNone = {0.0, 0.0};

/// The line between the nearest of the vertices that may be nearest at all; `n` when there is none.
Vector3 line_of_vertices(const Polytope& A, const Polytope& B, const Pruning& pruning, const Vector3& n,
                         double limit) noexcept {
  double best = std::numeric_limits<double>::infinity();
  Vector3 line = n;
  for (int v = 0; v < A.vertex_count(); ++v) {
    const double slack_v = pruning.A.at[static_cast<std::size_t>(v)][0] + pruning.separation[0];
    if (slack_v > limit) continue;
    for (int w = 0; w < B.vertex_count(); ++w) {
      if (slack_v + pruning.B.at[static_cast<std::size_t>(w)][0] > limit) continue;
      const Vector3 difference = B.vertex(w) - A.vertex(v);
      const double squared = difference.squaredNorm();
      if (squared >= best || !(squared > kTooShort * kTooShort)) continue;
      best = squared;
      line = difference;
    }
  }
  return line.normalized();
}

/// Height of p over the face when p lies over its inside; negative otherwise.
double height_over(const Polytope& shape, int face, const Vector3& p) noexcept {
  const Vector3& m = shape.normal(face);
  const std::span<const int> loop = shape.face(face);
  const double height = m.dot(p - shape.vertex(loop[0]));
  if (!(height > 0.0)) return -1.0;
  const Vector3* from = &shape.vertex(loop.back());
  for (const int v : loop) {
    const Vector3* to = &shape.vertex(v);
    if ((*to - *from).cross(m).dot(p - *from) > 0.0) return -1.0;
    from = to;
  }
  return height;
}

/// Vertices of one shape over faces of the other.
void compare_vertices(const Polytope& A, const Polytope& B, bool base_is_A, const Pruning& pruning,
                      Closest& out) noexcept {
  const Polytope& base = base_is_A ? A : B;
  const Polytope& tip = base_is_A ? B : A;
  const Slack& slack_base = base_is_A ? pruning.A : pruning.B;
  const Slack& slack_tip = base_is_A ? pruning.B : pruning.A;
  for (int f = 0; f < base.face_count(); ++f) {
    const std::array<double, 2> least = slack_base.of_face(base.face(f));
    if (!pruning.may_beat(least, kNone, out.distance)) continue;
    for (int v = 0; v < tip.vertex_count(); ++v) {
      if (!pruning.may_beat(least, slack_tip.at[static_cast<std::size_t>(v)], out.distance)) continue;
      const double height = height_over(base, f, tip.vertex(v));
      if (height < 0.0 || height >= out.distance - kDistanceTie) continue;
      const Vector3& m = base.normal(f);
      const Vector3 foot = tip.vertex(v) - height * m;
      out = base_is_A ? Closest{height, m, foot, tip.vertex(v), face_code(f), vertex_code(v)}
                      : Closest{height, -m, tip.vertex(v), foot, vertex_code(v), face_code(f)};
    }
  }
}

std::uint32_t name_on_edge(const Polytope& shape, int e, double parameter) noexcept {
  const std::array<int, 4>& edge = shape.edge(e);
  const double length = (shape.vertex(edge[1]) - shape.vertex(edge[0])).norm();
  if (parameter * length < kSnap) return vertex_code(edge[0]);
  if ((1.0 - parameter) * length < kSnap) return vertex_code(edge[1]);
  return edge_code(e);
}

void compare_edges(const Polytope& A, const Polytope& B, const Pruning& pruning, const Vector3& fallback,
                   Closest& out) noexcept {
  int most_inside = out.code_A != 0 ? 2 : 0;  // a vertex over a face is as good
  for (int i = 0; i < A.edge_count(); ++i) {
    const std::array<int, 4>& a = A.edge(i);
    const std::array<double, 2> slack_a = pruning.A.of_edge(a);
    if (!pruning.may_beat(slack_a, kNone, out.distance)) continue;
    for (int j = 0; j < B.edge_count(); ++j) {
      const std::array<int, 4>& b = B.edge(j);
      if (!pruning.may_beat(slack_a, pruning.B.of_edge(b), out.distance)) continue;
      const SegmentPair pair = nearest_points(A.vertex(a[0]), A.vertex(a[1]), B.vertex(b[0]), B.vertex(b[1]));
      const Vector3 difference = pair.p_b - pair.p_a;
      const double distance = difference.norm();
      const std::uint32_t code_A = name_on_edge(A, i, pair.s);
      const std::uint32_t code_B = name_on_edge(B, j, pair.t);
      // Of several as near, parallel edges first: their middle moves least.
      const int inside = (code_A == edge_code(i) ? 1 : 0) + (code_B == edge_code(j) ? 1 : 0);
      if (!(distance < out.distance - (inside > most_inside ? -kDistanceTie : kDistanceTie))) continue;
      const Vector3 n = distance > kTooShort ? Vector3(difference / distance) : fallback;
      out = {distance, n, pair.p_a, pair.p_b, code_A, code_B};
      most_inside = inside;
    }
  }
}

/// A single point (a ball's centre) against the edges.
void compare_point(const Polytope& A, const Polytope& point, const Vector3& fallback, Closest& out) noexcept {
  const Vector3& q = point.vertex(0);
  for (int i = 0; i < A.edge_count(); ++i) {
    const std::array<int, 4>& a = A.edge(i);
    const SegmentPair pair = nearest_points(A.vertex(a[0]), A.vertex(a[1]), q, q);
    const Vector3 difference = q - pair.p_a;
    const double distance = difference.norm();
    if (!(distance < out.distance - kDistanceTie)) continue;
    const Vector3 n = distance > kTooShort ? Vector3(difference / distance) : fallback;
    out = {distance, n, pair.p_a, q, name_on_edge(A, i, pair.s), vertex_code(0)};
  }
}

}  // namespace

bool find_closest(const Polytope& A, const Polytope& B, const Vector3& n, double limit, Closest& out) noexcept {
  Pruning pruning;
  pruning.fill(A, B, n, 0);
  pruning.fill(A, B, line_of_vertices(A, B, pruning, n, limit), 1);
  const double start = limit + 2.0 * kTie;
  out.distance = start;
  compare_vertices(A, B, true, pruning, out);
  compare_vertices(A, B, false, pruning, out);
  compare_edges(A, B, pruning, n, out);
  if (B.vertex_count() == 1) compare_point(A, B, n, out);
  return out.distance < start && out.distance <= limit;
}

}  // namespace snug::geometry::internal
