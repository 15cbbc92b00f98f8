// Reference: brute force over all axes and all pairs of features.
#include "reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace snug::geometry::test {

namespace {

using Real = long double;
constexpr Real kFar = std::numeric_limits<Real>::infinity();

Point operator+(const Point& a, const Point& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Point operator*(Real s, const Point& a) { return {s * a.x, s * a.y, s * a.z}; }
Real dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Point cross(const Point& a, const Point& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Real length(const Point& a) { return std::sqrt(dot(a, a)); }
Point point(const Vector3& v) { return {v.x(), v.y(), v.z()}; }
Point rotate(const Matrix3& R, const Point& p) {
  return p.x * point(R.col(0)) + p.y * point(R.col(1)) + p.z * point(R.col(2));
}

Real highest(const Solid& s, const Point& n) {
  Real best = -kFar;
  for (const Point& v : s.vertices) best = std::max(best, dot(n, v));
  return best;
}

Real lowest(const Solid& s, const Point& n) {
  Real best = kFar;
  for (const Point& v : s.vertices) best = std::min(best, dot(n, v));
  return best;
}

/// Between the cores, along unit n.
Real gap(const Solid& A, const Solid& B, const Point& n) { return lowest(B, n) - highest(A, n); }

struct Candidate {
  Point n;
  Real separation;
};

void try_axis(const Solid& A, const Solid& B, const Point& n, std::vector<Candidate>& all) {
  // Both senses at once: the interval of each shape on the axis.
  const Real low_A = lowest(A, n);
  const Real high_A = highest(A, n);
  const Real low_B = lowest(B, n);
  const Real high_B = highest(B, n);
  all.push_back({n, std::max(low_B - high_A, low_A - high_B)});
}

Real point_to_face(const Solid& s, std::size_t f, const Point& p) {
  const Point& n = s.face_normals[f];
  const std::vector<int>& loop = s.faces[f];
  const Real height = dot(n, p - s.vertices[static_cast<std::size_t>(loop[0])]);
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Point& a = s.vertices[static_cast<std::size_t>(loop[k])];
    const Point& b = s.vertices[static_cast<std::size_t>(loop[(k + 1) % loop.size()])];
    if (dot(cross(n, b - a), p - a) < 0) return kFar;
  }
  return std::abs(height);
}

Real point_to_segment(const Point& p, const Point& a, const Point& b) {
  const Point d = b - a;
  const Real t = std::clamp(dot(p - a, d) / dot(d, d), Real(0), Real(1));
  return length(p - a - t * d);
}

/// Distance of two lines where the nearest points are inside both segments; infinite otherwise.
Real crossing_distance(const Point& a0, const Point& a1, const Point& b0, const Point& b1) {
  const Point u = a1 - a0;
  const Point v = b1 - b0;
  const Point w = b0 - a0;
  const Point n = cross(u, v);
  const Real nn = dot(n, n);
  if (!(nn > 0)) return kFar;
  const Real s = dot(cross(w, v), n);
  const Real t = dot(cross(w, u), n);
  if (s < 0 || s > nn || t < 0 || t > nn) return kFar;
  return std::abs(dot(w, n)) / std::sqrt(nn);
}

Real distance(const Solid& A, const Solid& B) {
  Real best = kFar;
  const auto vertex = [](const Solid& s, int i) -> const Point& { return s.vertices[static_cast<std::size_t>(i)]; };
  for (const Point& p : B.vertices) {
    for (std::size_t f = 0; f < A.faces.size(); ++f) best = std::min(best, point_to_face(A, f, p));
    for (const auto& e : A.edges) best = std::min(best, point_to_segment(p, vertex(A, e[0]), vertex(A, e[1])));
  }
  for (const Point& p : A.vertices) {
    for (std::size_t f = 0; f < B.faces.size(); ++f) best = std::min(best, point_to_face(B, f, p));
    for (const auto& e : B.edges) best = std::min(best, point_to_segment(p, vertex(B, e[0]), vertex(B, e[1])));
    for (const Point& q : B.vertices) best = std::min(best, length(p - q));
  }
  for (const auto& e : A.edges) {
    for (const auto& g : B.edges) {
      best = std::min(best, crossing_distance(vertex(A, e[0]), vertex(A, e[1]), vertex(B, g[0]), vertex(B, g[1])));
    }
  }
  return best;
}

void add_hull(const ConvexHull& hull, const Pose& X, Solid& s) {
  for (const Vector3& v : hull.vertices) s.vertices.push_back(rotate(X.R, point(v)) + point(X.p));
  s.faces = hull.faces;
  for (const auto& loop : hull.faces) {
    Point sum;
    const Point& o = s.vertices[static_cast<std::size_t>(loop[0])];
    for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
      sum = sum + cross(s.vertices[static_cast<std::size_t>(loop[k])] - o,
                        s.vertices[static_cast<std::size_t>(loop[k + 1])] - o);
    }
    s.face_normals.push_back(1 / length(sum) * sum);
  }
  for (const auto& e : hull.edges) {
    s.edges.push_back({e[0], e[1]});
    const Point d = s.vertices[static_cast<std::size_t>(e[1])] - s.vertices[static_cast<std::size_t>(e[0])];
    s.edge_directions.push_back(1 / length(d) * d);
  }
}

void add_box(const Box& box, const Pose& X, Solid& s) {
  for (int v = 0; v < 8; ++v) {
    const Point p{(v & 1) != 0 ? box.half.x() : -box.half.x(), (v & 2) != 0 ? box.half.y() : -box.half.y(),
                  (v & 4) != 0 ? box.half.z() : -box.half.z()};
    s.vertices.push_back(rotate(X.R, p) + point(X.p));
  }
  s.faces = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (int k = 0; k < 3; ++k) {
    const Point axis = point(X.R.col(k));
    s.face_normals.push_back(Real(-1) * axis);
    s.face_normals.push_back(axis);
    s.edge_directions.push_back(axis);
  }
  for (int v = 0; v < 8; ++v) {
    for (int k = 0; k < 3; ++k) {
      if ((v >> k & 1) == 0) s.edges.push_back({v, v | 1 << k});
    }
  }
}

}  // namespace

Solid place(const Shape& shape, const Pose& X_WG) {
  Solid s;
  if (const Box* box = std::get_if<Box>(&shape)) add_box(*box, X_WG, s);
  if (const ConvexHull* hull = std::get_if<ConvexHull>(&shape)) add_hull(*hull, X_WG, s);
  if (const Capsule* capsule = std::get_if<Capsule>(&shape)) {
    const Point axis = point(X_WG.R.col(2));
    s.radius = capsule->radius;
    s.vertices.push_back(point(X_WG.p) - capsule->half_length * axis);
    if (capsule->half_length > 0) {
      s.vertices.push_back(point(X_WG.p) + capsule->half_length * axis);
      s.edges.push_back({0, 1});
      s.edge_directions.push_back(axis);
    }
  }
  return s;
}

Truth find_truth(const Solid& A, const Solid& B, long double limit) {
  std::vector<Candidate> all;
  all.reserve(A.face_normals.size() + B.face_normals.size() + A.edge_directions.size() * B.edge_directions.size());
  for (const Point& n : A.face_normals) try_axis(A, B, n, all);
  for (const Point& n : B.face_normals) try_axis(A, B, n, all);
  const std::size_t faces = all.size();
  for (const Point& a : A.edge_directions) {
    for (const Point& b : B.edge_directions) {
      const Point n = cross(a, b);
      const Real size = length(n);
      if (size > 1e-14L) try_axis(A, B, 1 / size * n, all);
    }
  }
  Real best = -kFar;
  for (const Candidate& c : all) best = std::max(best, c.separation);
  const Real radii = A.radius + B.radius;
  Truth truth;
  truth.overlap = best <= 0 && !all.empty();
  truth.separation = best - radii;
  // Shapes with no volume (two capsules) have no axes that tell.
  if (A.faces.empty() && B.faces.empty()) {
    truth.overlap = false;
    truth.separation = -radii;
  }
  if (!truth.overlap) {
    if (truth.separation > limit) {
      truth.beyond = true;
      return truth;
    }
    truth.separation = distance(A, B) - radii;
    truth.beyond = truth.separation > limit;
  }
  // The corner rule of README.md for any axis that could have been chosen: no worse than the best face.
  Real best_face = -kFar;
  for (const Point& n : A.face_normals) best_face = std::max(best_face, gap(A, B, n));
  for (const Point& n : B.face_normals) best_face = std::max(best_face, gap(A, B, Real(-1) * n));
  const Real slack = 1.1e-6L + 1.1e-3L * std::max(Real(0), -best);
  for (std::size_t f = 0; f < faces && radii == 0; ++f) {
    if (std::abs(all[f].separation) > 21.1e-6L) continue;
    for (const Candidate& c : all) {
      if (c.separation < best_face - slack || c.separation <= -21.1e-6L) continue;
      if (std::abs(dot(all[f].n, c.n)) <= 0.3001L) truth.may_be_corner = true;
    }
  }
  return truth;
}

long double separation_along(const Solid& A, const Solid& B, const Vector3& n) {
  return gap(A, B, point(n)) - A.radius - B.radius;
}

long double height_above(const Solid& solid, const Vector3& p_W) {
  const Point p = point(p_W);
  if (solid.faces.empty()) {
    const Real core = solid.vertices.size() == 1 ? length(p - solid.vertices[0])
                                                 : point_to_segment(p, solid.vertices[0], solid.vertices[1]);
    return core - solid.radius;
  }
  Real highest_plane = -kFar;
  for (std::size_t f = 0; f < solid.faces.size(); ++f) {
    const Point& o = solid.vertices[static_cast<std::size_t>(solid.faces[f][0])];
    highest_plane = std::max(highest_plane, dot(solid.face_normals[f], p - o));
  }
  return highest_plane;
}

}  // namespace snug::geometry::test
