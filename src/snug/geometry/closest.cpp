// Closest: compares vertices with faces and edges with edges, all that the separating planes leave in play.
//
// With A below a plane n.x = a and B above n.x = b, nearest points at distance d have
// (a - n.p_A) + (n.p_B - b) <= d - (b - a). The left side is the slack of the points; features whose least slack
// is larger than what the best distance so far allows cannot be nearest.
#include <algorithm>
#include <limits>

#include "snug/geometry/internal/closest.hpp"
#include "snug/geometry/internal/segment.hpp"
#include "snug/geometry/internal/tolerances.hpp"

namespace snug::geometry::internal {

namespace {

/// Below this distance [m] the difference of the points is too short to give a direction.
constexpr double kTooShort = 1e-9;

struct Slack {
  std::array<double, kMaxHullVertices> at;
  double plane;  ///< largest n . p

  Slack(const Polytope& shape, const Vector3& n) noexcept : plane(-std::numeric_limits<double>::infinity()) {
    for (int v = 0; v < shape.vertex_count(); ++v) {
      at[static_cast<std::size_t>(v)] = n.dot(shape.vertex(v));
      plane = std::max(plane, at[static_cast<std::size_t>(v)]);
    }
    for (int v = 0; v < shape.vertex_count(); ++v) {
      at[static_cast<std::size_t>(v)] = plane - at[static_cast<std::size_t>(v)];
    }
  }
  double operator[](int v) const noexcept { return at[static_cast<std::size_t>(v)]; }
};

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

/// Vertices of `tip` over faces of `base`. `sign` is +1 when base is A.
void compare_vertices(const Polytope& base, const Slack& slack_base, const Polytope& tip, const Slack& slack_tip,
                      double separation, bool base_is_A, Closest& out) noexcept {
  for (int f = 0; f < base.face_count(); ++f) {
    double least = std::numeric_limits<double>::infinity();
    for (const int v : base.face(f)) least = std::min(least, slack_base[v]);
    if (least + separation > out.distance) continue;
    for (int v = 0; v < tip.vertex_count(); ++v) {
      if (least + slack_tip[v] + separation > out.distance) continue;
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

void compare_edges(const Polytope& A, const Slack& slack_A, const Polytope& B, const Slack& slack_B,
                   double separation, const Vector3& fallback, Closest& out) noexcept {
  int most_inside = out.code_A != 0 ? 2 : 0;  // a vertex over a face is as good
  for (int i = 0; i < A.edge_count(); ++i) {
    const std::array<int, 4>& a = A.edge(i);
    const double least_a = std::min(slack_A[a[0]], slack_A[a[1]]);
    if (least_a + separation > out.distance) continue;
    for (int j = 0; j < B.edge_count(); ++j) {
      const std::array<int, 4>& b = B.edge(j);
      if (least_a + std::min(slack_B[b[0]], slack_B[b[1]]) + separation > out.distance) continue;
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
  const Slack slack_A(A, n);
  const Slack slack_B(B, -n);
  // Rounding of the slacks must not exclude the nearest features.
  const double separation = -slack_B.plane - slack_A.plane - 1e-9;
  const double start = limit + 2.0 * kTie;
  out.distance = start;
  compare_vertices(A, slack_A, B, slack_B, separation, true, out);
  compare_vertices(B, slack_B, A, slack_A, separation, false, out);
  compare_edges(A, slack_A, B, slack_B, separation, n, out);
  if (B.vertex_count() == 1) compare_point(A, B, n, out);
  return out.distance < start && out.distance <= limit;
}

}  // namespace snug::geometry::internal
