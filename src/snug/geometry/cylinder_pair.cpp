// CylinderPair: the direction of largest separation among all that can be it, then the features that face each other.
//
// Along a unit direction n the shapes are apart by s(n) = -h_B(-n) - h_A(n), h the support functions. The largest s(n)
// is the distance, or minus the depth. It is reached along a face normal of A, the cylinder's axis, the line from a
// vertex of A to the cylinder's axis or to the nearest point of a rim, or square to an edge of A (or to the axis of the
// other cylinder). The last is where the cylinder lies on its side, or the shortest way from a point to the ellipse as
// which a rim is seen along the edge; overlapping shapes can have other such ways, which a search over the angle finds.
// Two rims that cross leave two angles: Newton's method on the sphere.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/geometry/internal/clip.hpp"
#include "snug/geometry/internal/cylinder_pair.hpp"
#include "snug/geometry/internal/segment.hpp"
#include "snug/geometry/internal/tolerances.hpp"

namespace snug::geometry::internal {

namespace {

/// Directions nearer than this [m, or sine of an angle] to none at all are none.
constexpr double kNoDirection = 1e-9;
/// Below this sine of the tilt the deepest point of an end is rounding: the prism then keeps still in the cylinder.
constexpr double kFlat = 1e-6;
/// Sine of the angle up to which two lines get two points where they run along each other.
constexpr double kAlong = 1e-2;

/// A cylinder in the frame of A.
struct Round {
  const Cylinder& shape;
  Pose X;
  Vector3 centre, axis;

  Round(const Cylinder& cylinder, const Pose& X_AG) noexcept
      : shape(cylinder), X(X_AG), centre(X_AG.p), axis(X_AG.R.col(2)) {}
  [[nodiscard]] double support(const Vector3& m) const noexcept {
    const double along = m.dot(axis);
    return m.dot(centre) + shape.half_length * std::abs(along) +
           shape.radius * std::sqrt(std::max(0.0, 1.0 - along * along));
  }
  /// Unit, square to the axis, where m points; where it points along the axis, the cylinder's own x.
  [[nodiscard]] Vector3 azimuth(const Vector3& m) const noexcept {
    const Vector3 across = m - m.dot(axis) * axis;
    const double length = across.norm();
    return length > kFlat ? Vector3(across / length) : Vector3(X.R.col(0));
  }
  /// The point of the rim farthest along m.
  [[nodiscard]] Vector3 rim_point(const Vector3& m) const noexcept {
    const double side = m.dot(axis) < 0.0 ? -1.0 : 1.0;
    return centre + side * shape.half_length * axis + shape.radius * azimuth(m);
  }
  /// Middle of the side line at the azimuth of m.
  [[nodiscard]] Vector3 side_point(const Vector3& m) const noexcept { return centre + shape.radius * azimuth(m); }
};

/// What meets along a direction.
enum class Meeting {
  None,
  Face,    ///< a face of A and the support of B
  End,     ///< an end of B and the support of A
  Vertex,  ///< a vertex of A
  Edge,    ///< an edge of A (or the side of A) and a rim of B
  Lines,   ///< an edge of A (or the side of A) and the side of B
  Rim      ///< a rim of A
};

struct Direction {
  Meeting meeting = Meeting::None;
  int feature = 0;  ///< face, vertex or edge of A; end of B
  double separation = -kInfinity;
  Vector3 n = Vector3::UnitZ();  ///< unit, from A to B
};

/// s(n) on the circle n(t) = cos t first + sin t second, for an A whose support is n . base + reach.
struct Circle {
  const Round& B;
  Vector3 base, first, second;
  double reach = 0.0;

  [[nodiscard]] Vector3 at(double t) const noexcept { return std::cos(t) * first + std::sin(t) * second; }
  [[nodiscard]] double value(double t) const noexcept {
    const Vector3 n = at(t);
    return -B.support(-n) - n.dot(base) - reach;
  }
  /// Derivative by t, away from the kink.
  [[nodiscard]] double slope(double t) const noexcept {
    const Vector3 n = at(t);
    const Vector3 turned = std::cos(t) * second - std::sin(t) * first;
    const double along = n.dot(B.axis);
    const double turned_along = turned.dot(B.axis);
    const double across = std::sqrt(std::max(1.0 - along * along, 1e-30));
    return turned.dot(B.centre - base) - std::copysign(B.shape.half_length, along) * turned_along +
           B.shape.radius * along * turned_along / across;
  }
};

/// Where the slope changes sign between low and high: regula falsi (Illinois), to rounding.
double find_flat(const Circle& circle, double low, double high, double slope_low, double slope_high) noexcept {
  for (int i = 0; i < 60 && high - low > 1e-14; ++i) {
    double middle = low + (high - low) * slope_low / (slope_low - slope_high);
    if (!(middle > low && middle < high)) middle = 0.5 * (low + high);
    const double slope = circle.slope(middle);
    if (slope == 0.0) return middle;
    if (slope > 0.0) {
      low = middle;
      slope_low = slope;
      slope_high *= 0.5;
    } else {
      high = middle;
      slope_high = slope;
      slope_low *= 0.5;
    }
  }
  return 0.5 * (low + high);
}

/// The largest value on the arc [0, end] if it is more than `least`: where, and whether it is the kink. The arc is cut
/// at the kinks and into pieces in which the slope is followed.
struct ArcBest {
  double value = -kInfinity;
  double t = 0.0;
  bool is_kink = false;
};

ArcBest search_arc(const Circle& circle, double end, double least) noexcept {
  ArcBest best;
  const double x = circle.first.dot(circle.B.axis), y = circle.second.dot(circle.B.axis);
  std::array<double, 16> stops{};
  int count = 0;
  stops[static_cast<std::size_t>(count++)] = 0.0;
  if (std::hypot(x, y) > kNoDirection) {
    const double kink = std::atan2(y, x) + 0.5 * std::numbers::pi;  // n . axis = 0
    // Where the rim is seen nearly edge-on the value has a narrow peak: fourth root of how far it is from edge-on.
    const double peak = std::sqrt(std::sqrt(std::max(0.0, 1.0 - x * x - y * y)));
    const double half_turn = 0.5 * std::numbers::pi;
    const double width = std::min(peak, 0.5 * half_turn);
    for (double t = kink - 2.0 * std::numbers::pi; t < end + std::numbers::pi; t += std::numbers::pi) {
      for (const double stop : {t - half_turn - width, t - half_turn, t - half_turn + width, t}) {
        if (!(stop > stops[static_cast<std::size_t>(count - 1)] && stop < end) || count > 14) continue;
        stops[static_cast<std::size_t>(count++)] = stop;
      }
      if (!(t > 0.0 && t < end)) continue;
      const double value = circle.value(t);
      if (value > best.value) best = {value, t, true};
    }
  }
  stops[static_cast<std::size_t>(count++)] = end;
  const double steepest = (circle.B.centre - circle.base).norm() + circle.B.shape.half_length + circle.B.shape.radius;
  for (int k = 0; k + 1 < count; ++k) {
    const double from = stops[static_cast<std::size_t>(k)], to = stops[static_cast<std::size_t>(k) + 1];
    const int pieces = std::max(2, static_cast<int>(std::ceil((to - from) / (std::numbers::pi / 12.0))));
    const double width = (to - from) / pieces;
    // The ends of a piece between kinks belong to it: a hair inside, the slope is that of its own side.
    const double hair = std::min(1e-9, 1e-3 * width);
    double t0 = from + hair;
    double slope0 = circle.slope(t0);
    for (int i = 0; i < pieces; ++i) {
      const double t1 = i + 1 == pieces ? to - hair : from + width * (i + 1);
      const double slope1 = circle.slope(t1);
      if (slope0 > 0.0 && slope1 < 0.0) {
        const double bound = 0.5 * (circle.value(t0) + circle.value(t1) + steepest * (t1 - t0));
        if (bound > std::max(least, best.value)) {
          const double t = find_flat(circle, t0, t1, slope0, slope1);
          const double value = circle.value(t);
          if (value > best.value) best = {value, t, false};
        }
      }
      t0 = t1;
      slope0 = slope1;
    }
  }
  return best;
}

/// Nearest point of an ellipse with half axes long_axis >= short_axis > 0 to a point with y0, y1 >= 0: Eberly, Distance
/// from a Point to an Ellipse (2013). The root of a convex falling function, from its left by Newton's method.
std::array<double, 2> nearest_on_ellipse(double long_axis, double short_axis, double y0, double y1) noexcept {
  if (!(y1 > 0.0)) {
    const double share = long_axis * y0 / std::max(long_axis * long_axis - short_axis * short_axis, 1e-300);
    if (!(share < 1.0)) return {long_axis, 0.0};
    return {long_axis * share, short_axis * std::sqrt(1.0 - share * share)};
  }
  const double z0 = y0 / long_axis, z1 = y1 / short_axis;
  const double ratio = (long_axis / short_axis) * (long_axis / short_axis);
  double s = z1 - 1.0;
  for (int i = 0; i < 100; ++i) {
    const double a = ratio * z0 / (s + ratio), b = z1 / (s + 1.0);
    const double step = 0.5 * (a * a + b * b - 1.0) / (a * a / (s + ratio) + b * b / (s + 1.0));
    if (!(step > 1e-16 * (1.0 + std::abs(s)))) break;
    s += step;
  }
  return {ratio * y0 / (s + ratio), y1 / (s + 1.0)};
}

/// Direction from the line through `base` along d (unit) to the nearest place of a rim of the cylinder; false when d is
/// along its axis. `side`: 1 or -1, of the rim.
bool direction_to_rim(const Vector3& base, const Vector3& d, const Round& round, double side, Vector3& n) noexcept {
  const Vector3 across = round.axis.cross(d);
  const double sine = across.norm();
  if (!(sine > kNoDirection)) return false;
  const Vector3 x = across / sine, y = d.cross(x);
  const Vector3 from = base - round.centre - side * round.shape.half_length * round.axis;
  const double y0 = from.dot(x), y1 = from.dot(y);
  const double long_axis = round.shape.radius;
  // Seen edge-on a rim is a segment; this wide it still has normals.
  const double short_axis = std::max(long_axis * std::abs(d.dot(round.axis)), 1e-9 * long_axis);
  const auto [x0, x1] = nearest_on_ellipse(long_axis, short_axis, std::abs(y0), std::abs(y1));
  const Vector3 outward =
      std::copysign(x0 * short_axis * short_axis, y0) * x + std::copysign(x1 * long_axis * long_axis, y1) * y;
  const double length = outward.norm();
  if (!(length > 0.0)) return false;
  n = -outward / length;
  return true;
}

void take(Direction& best, const Direction& candidate) noexcept {
  if (candidate.separation > best.separation + kTie) best = candidate;
}

double separation_along(const Polytope& A, const Round& B, const Vector3& n) noexcept {
  return -B.support(-n) - A.support(n);
}

Direction along(const Polytope& A, const Round& B, Meeting meeting, int feature, const Vector3& n) noexcept {
  return {meeting, feature, separation_along(A, B, n), n};
}

/// Face normals of A and the axis of B.
void find_flat_directions(const Polytope& A, const Round& B, std::array<double, kMaxHullFaces>& faces,
                          std::array<double, 2>& ends, Direction& best) noexcept {
  for (int f = 0; f < A.face_count(); ++f) {
    const Direction candidate = along(A, B, Meeting::Face, f, A.normal(f));
    faces[static_cast<std::size_t>(f)] = candidate.separation;
    take(best, candidate);
  }
  for (int end = 0; end < 2; ++end) {
    const Direction candidate = along(A, B, Meeting::End, end, end == 0 ? B.axis : Vector3(-B.axis));
    ends[static_cast<std::size_t>(end)] = candidate.separation;
    take(best, candidate);
  }
}

void find_vertex_directions(const Polytope& A, const Round& B, double limit, Direction& best) noexcept {
  for (int v = 0; v < A.vertex_count() && best.separation <= limit; ++v) {
    const Vector3 from_centre = A.vertex(v) - B.centre;
    const double height = from_centre.dot(B.axis);
    const Vector3 across = from_centre - height * B.axis;
    const double distance = across.norm();
    if (!(distance > kNoDirection)) continue;
    take(best, along(A, B, Meeting::Vertex, v, -across / distance));
    const Vector3 rim =
        B.centre + std::copysign(B.shape.half_length, height) * B.axis + B.shape.radius / distance * across;
    const Vector3 to_rim = rim - A.vertex(v);
    const double gap = to_rim.norm();
    if (gap > kNoDirection) take(best, along(A, B, Meeting::Vertex, v, to_rim / gap));
  }
}

/// The other way square to each edge in which overlapping shapes can be nearest to being apart.
void search_edge_directions(const Polytope& A, const Round& B, Direction& best) noexcept {
  for (int e = 0; e < A.edge_count(); ++e) {
    const std::array<int, 4>& edge = A.edge(e);
    Vector3 first, second;
    double end = 2.0 * std::numbers::pi;
    if (edge[2] >= 0) {  // between the normals of its faces
      first = A.normal(edge[2]);
      second = A.normal(edge[3]) - A.normal(edge[3]).dot(first) * first;
      const double sine = second.norm();
      if (!(sine > kNoDirection)) continue;
      second /= sine;
      end = std::atan2(sine, A.normal(edge[3]).dot(first));
    } else {
      const Vector3 d = (A.vertex(edge[1]) - A.vertex(edge[0])).normalized();
      first = d.unitOrthogonal();
      second = d.cross(first);
    }
    const Circle circle{B, A.vertex(edge[0]), first, second, 0.0};
    const ArcBest found = search_arc(circle, end, best.separation);
    if (!(found.value > best.separation)) continue;
    take(best, along(A, B, found.is_kink ? Meeting::Lines : Meeting::Edge, e, circle.at(found.t)));
  }
}

void find_edge_directions(const Polytope& A, const Round& B, double limit, Direction& best) noexcept {
  for (int e = 0; e < A.edge_count() && best.separation <= limit; ++e) {
    const std::array<int, 4>& edge = A.edge(e);
    const Vector3& base = A.vertex(edge[0]);
    const Vector3 d = (A.vertex(edge[1]) - base).normalized();
    Vector3 n = d.cross(B.axis);
    const double sine = n.norm();
    if (!(sine > kNoDirection)) continue;  // its vertices say it
    n *= std::copysign(1.0 / sine, n.dot(B.centre - base));
    // Parallel edges share their directions: the one that supports A along it is meant.
    const auto try_along = [&](Meeting meeting) {
      if (n.dot(base) >= A.support(n) - kMiss) take(best, along(A, B, meeting, e, n));
    };
    try_along(Meeting::Lines);
    for (const double side : {-1.0, 1.0}) {
      if (direction_to_rim(base, d, B, side, n)) try_along(Meeting::Edge);
    }
  }
  if (best.separation < 0.0) search_edge_directions(A, B, best);
}

/// Part of a cylinder that faces m: an end as a prism, a side line, or a point of the rim.
Polytope part_of(const Round& round, const Vector3& m, PolytopeStorage& room) noexcept {
  const double cosine = std::abs(m.dot(round.axis));
  if (cosine > kNearFaceCosine) {
    return Polytope(round.shape, round.X, round.X.R.transpose() * round.azimuth(m), room);
  }
  if (cosine * cosine < 1.0 - kNearFaceCosine * kNearFaceCosine) {
    const Vector3 middle = round.side_point(m);
    const Vector3 half = round.shape.half_length * round.axis;
    return Polytope(middle - half, middle + half, room);
  }
  const Vector3 point = round.rim_point(m);
  return Polytope(point, point, room);
}

/// Two facing parts and the direction in which they meet, in A.
struct Facing {
  const Polytope& A;
  const Polytope& B;
  double radius;  ///< around A, m
  Vector3 n;
  double separation;  ///< m, of the cores
  const PairCall& call;
};

void emit_at(const Facing& facing, const Vector3& p_A, double phi_core, std::uint32_t code_A, std::uint32_t code_B,
             Manifold& out) noexcept {
  const double phi = phi_core - facing.radius;
  if (!(phi <= facing.call.margin)) return;
  const Vector3 n_W = facing.call.X_WA.R * facing.n;
  const Vector3 p_WA = facing.call.X_WA * (p_A + facing.radius * facing.n);
  set_normal(facing.call.swapped, n_W, out);
  emit(facing.call.swapped, p_WA, p_WA + phi * n_W, phi, code_A, code_B, out);
}

/// Cosine between n and the face of the shape that is most along it; -1 without faces.
double cosine_of_face(const Polytope& shape, const Vector3& n, int& face) noexcept {
  face = shape.face_along(n);
  return face < 0 ? -1.0 : shape.normal(face).dot(n);
}

/// The polygon over a face that is nearly square to n, when there is one. Its deepest point is the one given (p_A on
/// A), should the corners of the polygon miss it.
bool emit_face(const Facing& facing, const Vector3& p_A, Manifold& out) noexcept {
  int face_A = -1, face_B = -1;
  const double cosine_A = cosine_of_face(facing.A, facing.n, face_A);
  const double cosine_B = cosine_of_face(facing.B, -facing.n, face_B);
  if (std::max(cosine_A, cosine_B) <= kNearFaceCosine) return false;
  const bool ref_is_A = cosine_A >= cosine_B - kTie;
  ClipPolygon polygon;
  if (ref_is_A) {
    clip_faces({facing.A, face_A, facing.B, facing.n, !facing.call.swapped}, polygon);
  } else {
    clip_faces({facing.B, face_B, facing.A, -facing.n, facing.call.swapped}, polygon);
  }
  if (polygon.count == 0) return false;
  const bool has_deepest = polygon.least_phi <= facing.separation + kBias;
  reduce(facing.call.margin + facing.radius, polygon);
  if (!has_deepest) {
    polygon.count = std::min(polygon.count, kMaxManifoldPoints - 1);
    emit_at(facing, p_A, facing.separation, vertex_code(0) | kSecond, vertex_code(0) | kSecond, out);
  }
  for (int i = 0; i < polygon.count; ++i) {
    const ClipPoint& point = polygon.points[static_cast<std::size_t>(i)];
    if (ref_is_A) {
      emit_at(facing, point.p_ref, point.phi, point.code_ref, point.code_inc, out);
    } else {
      emit_at(facing, point.p_ref - point.phi * facing.n, point.phi, point.code_inc, point.code_ref, out);
    }
  }
  return out.count > 0;
}

struct Line {
  Vector3 from, to;
};

/// Two points where lines run along each other, square to n; false when they cross.
bool emit_lines(const Facing& facing, const Line& a, const Line& b, std::uint32_t code_A, Manifold& out) noexcept {
  const Vector3 along = a.to - a.from;
  const double length = along.norm();
  const Vector3 d = along / length;
  const double sine = d.cross((b.to - b.from).normalized()).norm();
  if (sine > kAlong) return false;
  double low = d.dot(b.from - a.from), high = d.dot(b.to - a.from);
  const bool is_reversed = low > high;
  if (is_reversed) std::swap(low, high);
  const double span = high - low;
  const double start = std::max(low, 0.0), end = std::min(high, length);
  if (!(end - start > kMerge)) return false;
  const std::array<double, 2> stops = {start, end};
  for (std::uint32_t i = 0; i < 2; ++i) {
    const double at = stops[i];
    const double share = (at - low) / span;
    const Vector3 p_A = a.from + at * d;
    const Vector3 p_B =
        is_reversed ? Vector3(b.to + share * (b.from - b.to)) : Vector3(b.from + share * (b.to - b.from));
    const double phi = facing.n.dot(p_B - p_A);
    // No point can be nearer than the direction says; rounding apart.
    emit_at(facing, p_A, std::max(phi, facing.separation), code_A, vertex_code(static_cast<int>(i)), out);
  }
  return out.count > 0;
}

/// README.md, "Seams", for ends that lie flush: sides are round and roll.
bool is_corner_pair(const Polytope& A, const Round& B, const Direction& chosen,
                    const std::array<double, kMaxHullFaces>& faces, const std::array<double, 2>& ends) noexcept {
  if (chosen.separation <= -kCornerSlop) return false;
  for (int f = 0; f < A.face_count(); ++f) {
    if (std::abs(faces[static_cast<std::size_t>(f)]) <= kCornerSlop &&
        std::abs(A.normal(f).dot(chosen.n)) <= kCornerCosine && std::abs(A.normal(f).dot(B.axis)) > kNearFaceCosine) {
      return true;
    }
  }
  for (const double end : ends) {
    if (std::abs(end) <= kCornerSlop && std::abs(B.axis.dot(chosen.n)) <= kCornerCosine) return A.face_count() > 0;
  }
  return false;
}

/// The point of A's core that meets B.
Vector3 point_on_A(const Polytope& A, const Round& B, const Direction& chosen) noexcept {
  switch (chosen.meeting) {
    case Meeting::Vertex:
      return A.vertex(chosen.feature);
    case Meeting::End:
      return A.vertex(A.support_vertex(chosen.n));
    case Meeting::Lines: {
      const std::array<int, 4>& edge = A.edge(chosen.feature);
      const Vector3 middle = B.side_point(-chosen.n);
      const Vector3 half = B.shape.half_length * B.axis;
      return crossing_points(A.vertex(edge[0]), A.vertex(edge[1]), middle - half, middle + half,
                             chosen.separation * chosen.n)
          .p_a;
    }
    default:
      return B.rim_point(-chosen.n) - chosen.separation * chosen.n;
  }
}

std::uint32_t code_on_A(const Direction& chosen) noexcept {
  if (chosen.meeting == Meeting::Face) return face_code(chosen.feature);
  if (chosen.meeting == Meeting::Vertex) return vertex_code(chosen.feature);
  if (chosen.meeting == Meeting::Edge || chosen.meeting == Meeting::Lines) return edge_code(chosen.feature);
  return vertex_code(0);
}

/// The edge of A that runs along the axis of B and is its support along n; -1 when there is none.
int edge_along(const Polytope& A, const Vector3& n, const Vector3& axis) noexcept {
  const double reach = A.support(n);
  for (int e = 0; e < A.edge_count(); ++e) {
    const std::array<int, 4>& edge = A.edge(e);
    const Vector3& from = A.vertex(edge[0]);
    const Vector3& to = A.vertex(edge[1]);
    if (std::max(n.dot(from), n.dot(to)) < reach - kBias) continue;
    if ((to - from).normalized().cross(axis).norm() <= kAlong) return e;
  }
  return -1;
}

Direction remembered_direction(const Polytope& A, const Round& B, const Axis& axis) noexcept {
  if (axis.kind == AxisKind::FaceA && axis.a < A.face_count()) {
    return along(A, B, Meeting::Face, axis.a, A.normal(axis.a));
  }
  if (axis.kind == AxisKind::FaceB && axis.b < 2) {
    return along(A, B, Meeting::End, axis.b, axis.b == 0 ? B.axis : Vector3(-B.axis));
  }
  return {};
}

Axis axis_of(const Direction& direction) noexcept {
  if (direction.meeting == Meeting::Face) return {AxisKind::FaceA, direction.feature, 0};
  if (direction.meeting == Meeting::End) return {AxisKind::FaceB, 0, direction.feature};
  return {};
}

}  // namespace

void collide_polytope_cylinder(const Polytope& A, double radius, const Cylinder& B, const Pose& X_AB,
                               const PairCall& call, Axis& axis, Manifold& out) noexcept {
  if (!X_AB.R.allFinite() || !X_AB.p.allFinite()) return;
  const Round round(B, X_AB);
  const double limit = call.margin + radius;
  const Direction remembered = remembered_direction(A, round, axis);
  if (remembered.separation > limit + kTie) return;
  std::array<double, kMaxHullFaces> faces;
  std::array<double, 2> ends;
  Direction best_flat;
  find_flat_directions(A, round, faces, ends, best_flat);
  Direction best = best_flat;
  if (best.separation <= limit) find_vertex_directions(A, round, limit, best);
  if (best.separation <= limit) find_edge_directions(A, round, limit, best);
  const bool is_near = best.separation <= limit;
  const double slack = allowance(best.separation);
  Direction chosen = best;
  if (remembered.separation >= best.separation - slack) {
    chosen = remembered;
  } else if (best_flat.separation >= best.separation - 0.5 * slack) {
    chosen = best_flat;
  }
  axis = axis_of(is_near ? chosen : best);
  out.is_corner_pair = is_near && is_corner_pair(A, round, chosen, faces, ends);
  if (!is_near || out.is_corner_pair) return;
  PolytopeStorage room;
  const Polytope part = part_of(round, -chosen.n, room);
  const Facing facing{A, part, radius, chosen.n, chosen.separation, call};
  const Vector3 p_A = point_on_A(A, round, chosen);
  if (emit_face(facing, p_A, out)) return;
  if (const int edge = part.edge_count() == 1 ? edge_along(A, chosen.n, round.axis) : -1; edge >= 0) {
    const Line line_A{A.vertex(A.edge(edge)[0]), A.vertex(A.edge(edge)[1])};
    if (emit_lines(facing, line_A, {part.vertex(0), part.vertex(1)}, edge_code(edge), out)) return;
  }
  emit_at(facing, p_A, chosen.separation, code_on_A(chosen), vertex_code(0), out);
}

namespace {

double separation_along(const Round& A, const Round& B, const Vector3& n) noexcept {
  return -B.support(-n) - A.support(n);
}

Direction along(const Round& A, const Round& B, Meeting meeting, const Vector3& n) noexcept {
  return {meeting, 0, separation_along(A, B, n), n};
}

/// Directions square to the axis of A: its side against the rims of B and, where they overlap, whatever else.
Direction find_round(const Round& A, const Round& B, double least) noexcept {
  Direction best;
  best.separation = least;
  for (const double side : {-1.0, 1.0}) {
    Vector3 n;
    if (direction_to_rim(A.centre, A.axis, B, side, n)) take(best, along(A, B, Meeting::Edge, n));
  }
  if (best.separation >= 0.0) return best;
  const Vector3 first = A.axis.unitOrthogonal();
  const Circle circle{B, A.centre, first, A.axis.cross(first), A.shape.radius};
  const ArcBest found = search_arc(circle, 2.0 * std::numbers::pi, best.separation);
  if (found.value > best.separation) take(best, along(A, B, Meeting::Edge, circle.at(found.t)));
  return best;
}

/// Newton's method for two rims, from n: uphill steps on the sphere, halved while they lead down. The sides say which
/// rims; with them fixed the separation is concave but for the sphere.
Vector3 climb(const Round& A, double side_A, const Round& B, double side_B, Vector3 n) noexcept {
  const Vector3 between =
      B.centre + side_B * B.shape.half_length * B.axis - A.centre - side_A * A.shape.half_length * A.axis;
  const auto value_at = [&](const Vector3& m) {
    return m.dot(between) - A.shape.radius * m.cross(A.axis).norm() - B.shape.radius * m.cross(B.axis).norm();
  };
  double value = value_at(n);
  for (int i = 0; i < 40; ++i) {
    // Second derivative: the rims bend back, and the sphere does.
    Vector3 apart = between;
    Matrix3 bend = Matrix3::Zero();
    for (const Round* round : {&A, &B}) {
      const Vector3 across = n - n.dot(round->axis) * round->axis;
      const double length = across.norm();
      if (!(length > kFlat)) return n;
      apart -= round->shape.radius / length * across;
      const Vector3 tangent = round->axis.cross(across / length);
      bend -= round->shape.radius / length * tangent * tangent.transpose();
    }
    const Vector3 slope = apart - apart.dot(n) * n;
    if (slope.norm() <= 1e-15 + 1e-14 * between.norm()) break;
    bend -= apart.dot(n) * Matrix3::Identity();
    const Vector3 u = n.unitOrthogonal(), w = n.cross(u);
    Eigen::Matrix2d second;
    second << u.dot(bend * u), u.dot(bend * w), w.dot(bend * u), w.dot(bend * w);
    const Eigen::Vector2d first(slope.dot(u), slope.dot(w));
    Eigen::Vector2d step = -second.inverse() * first;
    if (!(first.dot(step) > 0.0) || !step.allFinite()) {
      step = first / (between.norm() + A.shape.radius + B.shape.radius);
    }
    if (const double length = step.norm(); length > 1.0) step /= length;
    bool has_moved = false;
    for (int half = 0; half < 30 && !has_moved; ++half, step *= 0.5) {
      const Vector3 next = (n + step.x() * u + step.y() * w).normalized();
      const double next_value = value_at(next);
      if (!(next_value > value)) continue;
      n = next;
      value = next_value;
      has_moved = true;
    }
    if (!has_moved) break;
  }
  return n;
}

/// Nearest point of the solid cylinder.
Vector3 project(const Round& round, const Vector3& p) noexcept {
  const Vector3 from = p - round.centre;
  const double along = from.dot(round.axis);
  const Vector3 across = from - along * round.axis;
  const double distance = across.norm();
  const double share = distance > round.shape.radius ? round.shape.radius / distance : 1.0;
  return round.centre + std::clamp(along, -round.shape.half_length, round.shape.half_length) * round.axis +
         share * across;
}

/// Between nearly nearest points of two cylinders that are apart: projections in turn. Short where they overlap.
Vector3 line_between(const Round& A, const Round& B) noexcept {
  Vector3 p_B = B.centre, p_A = A.centre;
  for (int i = 0; i < 20; ++i) {
    p_A = project(A, p_B);
    p_B = project(B, p_A);
  }
  return p_B - p_A;
}

/// Directions between two rims. Cylinders that are apart have one best direction, and a start near it, unless it is
/// near an axis, from where no slope leads away; where they overlap there can be several: hence several starts.
void find_rim_directions(const Round& A, const Round& B, Direction& best) noexcept {
  const Vector3 line = line_between(A, B);
  const Vector3 along_line = line.norm() > kNoDirection ? Vector3(line.normalized()) : best.n;
  const Vector3 out_of_A = A.azimuth(B.centre), out_of_B = B.azimuth(-B.centre);
  for (const double side_A : {-1.0, 1.0}) {
    for (const double side_B : {-1.0, 1.0}) {
      const auto climb_from = [&](const Vector3& start) {
        take(best, along(A, B, Meeting::Rim, climb(A, side_A, B, side_B, start)));
      };
      climb_from(along_line);
      climb_from(best.n);
      const Vector3 between = B.centre + side_B * B.shape.half_length * B.axis - side_A * A.shape.half_length * A.axis;
      if (between.norm() > kNoDirection) climb_from(between.normalized());
      climb_from((out_of_A + side_A * A.axis).normalized());
      climb_from(-(out_of_B + side_B * B.axis).normalized());
    }
  }
}

/// The part of each that faces the other.
void emit_cylinders(const Round& A, const Round& B, const Direction& chosen, const PairCall& call,
                    Manifold& out) noexcept {
  const Vector3& n = chosen.n;
  PolytopeStorage room_A, room_B;
  const Polytope part_A = part_of(A, n, room_A), part_B = part_of(B, -n, room_B);
  const Facing facing{part_A, part_B, 0.0, n, chosen.separation, call};
  const bool both_lines = part_A.edge_count() == 1 && part_B.edge_count() == 1;
  // From whichever has its support in one point; where both have lines, from where these cross.
  Vector3 p_A = A.rim_point(n);
  if (both_lines) {
    p_A = crossing_points(part_A.vertex(0), part_A.vertex(1), part_B.vertex(0), part_B.vertex(1), chosen.separation * n)
              .p_a;
  } else if (std::abs(n.dot(A.axis)) < kFlat || std::abs(n.dot(A.axis)) > 1.0 - 0.5 * kFlat * kFlat) {
    p_A = B.rim_point(-n) - chosen.separation * n;
  }
  if (emit_face(facing, p_A, out)) return;
  if (both_lines && emit_lines(facing, {part_A.vertex(0), part_A.vertex(1)}, {part_B.vertex(0), part_B.vertex(1)},
                               edge_code(0), out)) {
    return;
  }
  emit_at(facing, p_A, chosen.separation, vertex_code(0), vertex_code(0), out);
}

}  // namespace

void collide_cylinders(const Cylinder& shape_A, const Cylinder& shape_B, const Pose& X_AB, const PairCall& call,
                       Manifold& out) noexcept {
  if (!X_AB.R.allFinite() || !X_AB.p.allFinite()) return;
  const Round A(shape_A, Pose{}), B(shape_B, X_AB);
  Direction best;
  for (const Vector3& n : {A.axis, Vector3(-A.axis), B.axis, Vector3(-B.axis)})
    take(best, along(A, B, Meeting::End, n));
  const double best_end = best.separation;
  const Direction end = best;
  Vector3 sides = A.axis.cross(B.axis);
  if (const double sine = sides.norm(); sine > kNoDirection) {
    sides *= std::copysign(1.0 / sine, sides.dot(B.centre));
    take(best, along(A, B, Meeting::Lines, sides));
  } else if (const Vector3 across = B.centre - B.centre.dot(A.axis) * A.axis; across.norm() > kNoDirection) {
    take(best, along(A, B, Meeting::Lines, across.normalized()));
  }
  if (best.separation <= call.margin) take(best, find_round(A, B, best.separation));
  if (best.separation <= call.margin) {
    Direction other = find_round(B, A, best.separation);
    other.n = -other.n;
    if (other.meeting != Meeting::None) take(best, along(A, B, Meeting::Rim, other.n));
  }
  if (best.separation <= call.margin) find_rim_directions(A, B, best);
  if (!(best.separation <= call.margin)) return;
  if (best_end >= best.separation - 0.5 * allowance(best.separation)) best = end;
  emit_cylinders(A, B, best, call, out);
}

}  // namespace snug::geometry::internal
