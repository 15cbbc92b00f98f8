// make_convex_hull: grows a triangulated hull by the farthest point, then joins triangles that are flat together.
#include "snug/geometry/convex_hull.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

namespace snug::geometry {

namespace {

/// Parts of the cloud's size; see the header.
constexpr double kMergeFraction = 1e-7;
constexpr double kFlatFraction = 1e-6;

using Edge = std::pair<int, int>;
using Loops = std::vector<std::vector<int>>;

struct Triangle {
  std::array<int, 3> v{};
  Vector3 n = Vector3::Zero();  ///< outward, unit
  double area = 0.0;            ///< twice the area
  double reach = 0.0;           ///< height of the farthest point above the plane
  int farthest = -1;            ///< the first point so high; -1 where none is above the tolerance
};

Triangle make_triangle(const std::vector<Vector3>& p, int a, int b, int c) {
  const auto at = [&](int i) { return p[static_cast<std::size_t>(i)]; };
  const Vector3 cross = (at(b) - at(a)).cross(at(c) - at(a));
  const double area = cross.norm();
  return {{a, b, c}, area > 0.0 ? Vector3(cross / area) : Vector3::Zero(), area, 0.0, -1};
}

double height(const std::vector<Vector3>& p, const Triangle& t, int q) {
  return t.n.dot(p[static_cast<std::size_t>(q)] - p[static_cast<std::size_t>(t.v[0])]);
}

double size_of(std::span<const Vector3> points) {
  Vector3 low = points.front();
  Vector3 high = points.front();
  for (const Vector3& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).norm();
}

/// Points of a cloud by the cubes that they lie in, hashed: finds those near a place without looking at all.
class NearPoints {
 public:
  /// For `count` points above `low`; near means within `tolerance`, which is above 0.
  NearPoints(std::size_t count, const Vector3& low, double tolerance)
      : low_(low), tolerance_(tolerance), first_(std::bit_ceil(count + 1), -1) {}

  /// Is one of `points`, which were all added, near p?
  [[nodiscard]] bool has_near(const std::vector<Vector3>& points, const Vector3& p) const {
    const Vector3 margin = Vector3::Constant(1.01 * tolerance_);  // more than rounding
    const Cube from = cube_of(p - low_ - margin), to = cube_of(p - low_ + margin);
    for (std::int64_t x = from[0]; x <= to[0]; ++x) {
      for (std::int64_t y = from[1]; y <= to[1]; ++y) {
        for (std::int64_t z = from[2]; z <= to[2]; ++z) {
          for (int i = first_[bucket({x, y, z})]; i >= 0; i = next_[static_cast<std::size_t>(i)]) {
            if ((p - points[static_cast<std::size_t>(i)]).norm() <= tolerance_) return true;
          }
        }
      }
    }
    return false;
  }
  /// The next point, numbered from 0.
  void add(const Vector3& p) {
    int& first = first_[bucket(cube_of(p - low_))];
    next_.push_back(std::exchange(first, static_cast<int>(next_.size())));
  }

 private:
  using Cube = std::array<std::int64_t, 3>;

  [[nodiscard]] Cube cube_of(const Vector3& above) const {
    Cube cube{};
    for (int k = 0; k < 3; ++k) {
      cube[static_cast<std::size_t>(k)] = static_cast<std::int64_t>(std::floor(above[k] / (4.0 * tolerance_)));
    }
    return cube;
  }
  [[nodiscard]] std::size_t bucket(const Cube& cube) const {
    std::uint64_t hash = 0;
    for (const std::int64_t k : cube) {
      hash = (hash ^ static_cast<std::uint64_t>(k)) * 0x9E3779B97F4A7C15U;
      hash ^= hash >> 32U;
    }
    return static_cast<std::size_t>(hash) & (first_.size() - 1);
  }

  Vector3 low_;
  double tolerance_;
  std::vector<int> first_;  ///< of each bucket, -1 for none
  std::vector<int> next_;   ///< in the bucket, for each point
};

/// Without the points that are within the tolerance of one before them.
std::vector<Vector3> distinct(std::span<const Vector3> points, double tolerance) {
  if (!(tolerance > 0.0 && std::isfinite(tolerance))) return {points.front()};  // no extent, or beyond all numbers
  Vector3 low = points.front();
  for (const Vector3& p : points) low = low.cwiseMin(p);
  std::vector<Vector3> result;
  NearPoints near(points.size(), low, tolerance);
  for (const Vector3& p : points) {
    if (near.has_near(result, p)) continue;
    near.add(p);
    result.push_back(p);
  }
  return result;
}

/// Index of the point for which `value` is largest.
template <class Value>
int argmax(const std::vector<Vector3>& p, Value value) {
  int best = 0;
  for (int i = 1; i < static_cast<int>(p.size()); ++i) {
    if (value(p[static_cast<std::size_t>(i)]) > value(p[static_cast<std::size_t>(best)])) best = i;
  }
  return best;
}

/// A tetrahedron of far points; empty when they are all in one plane.
std::vector<Triangle> first_tetrahedron(const std::vector<Vector3>& p, double size) {
  const auto at = [&](int i) { return p[static_cast<std::size_t>(i)]; };
  const int a = argmax(p, [&](const Vector3& q) { return (q - p.front()).norm(); });
  const int b = argmax(p, [&](const Vector3& q) { return (q - at(a)).norm(); });
  const Vector3 line = (at(b) - at(a)).normalized();
  const int c = argmax(p, [&](const Vector3& q) { return (q - at(a)).cross(line).norm(); });
  const Vector3 n = (at(b) - at(a)).cross(at(c) - at(a)).normalized();
  const int d = argmax(p, [&](const Vector3& q) { return std::abs(n.dot(q - at(a))); });
  const double tallest = n.dot(at(d) - at(a));
  if (!(std::abs(tallest) > kFlatFraction * size)) return {};
  const int b_out = tallest > 0.0 ? c : b;  // a, b_out, c_out counter-clockwise seen from away of d
  const int c_out = tallest > 0.0 ? b : c;
  return {make_triangle(p, a, b_out, c_out), make_triangle(p, a, d, b_out), make_triangle(p, b_out, d, c_out),
          make_triangle(p, c_out, d, a)};
}

/// Finds the farthest point above each of these triangles.
void find_farthest(const std::vector<Vector3>& p, double tolerance, std::span<Triangle> triangles) {
  for (Triangle& t : triangles) t.reach = tolerance;
  // In blocks that stay in the cache for all triangles.
  constexpr int kBlock = 512;
  const int count = static_cast<int>(p.size());
  for (int begin = 0; begin < count; begin += kBlock) {
    const int end = std::min(begin + kBlock, count);
    for (Triangle& t : triangles) {
      for (int q = begin; q < end; ++q) {
        const double h = height(p, t, q);
        if (h <= t.reach) continue;
        t.reach = h;
        t.farthest = q;
      }
    }
  }
}

/// Replaces what `q` sees by a cone of triangles from the horizon to `q`.
void add_point(const std::vector<Vector3>& p, int q, double tolerance, std::vector<Triangle>& triangles) {
  std::vector<Triangle> kept;
  std::vector<Edge> seen;
  for (const Triangle& t : triangles) {
    if (height(p, t, q) <= 0.0) {
      kept.push_back(t);
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) seen.emplace_back(t.v[k], t.v[(k + 1) % 3]);
  }
  const std::size_t old = kept.size();
  for (const Edge& e : seen) {
    const bool is_horizon = std::find(seen.begin(), seen.end(), Edge{e.second, e.first}) == seen.end();
    if (is_horizon) kept.push_back(make_triangle(p, e.first, e.second, q));
  }
  find_farthest(p, tolerance, std::span(kept).subspan(old));
  triangles = std::move(kept);
}

/// Adds the farthest point until none is farther out than `tolerance`; of two as far the first.
bool grow(const std::vector<Vector3>& p, double tolerance, std::vector<Triangle>& triangles) {
  find_farthest(p, tolerance, triangles);
  for (int round = 0; round < 4 * kMaxHullVertices; ++round) {
    int farthest = -1;
    double most = tolerance;
    for (const Triangle& t : triangles) {
      if (t.farthest < 0 || t.reach < most || (t.reach == most && t.farthest > farthest)) continue;
      most = t.reach;
      farthest = t.farthest;
    }
    if (farthest < 0) return true;
    add_point(p, farthest, tolerance, triangles);
    // A closed surface of triangles without holes on n points has 2 n - 4 of them. More come when rounding lets a point
    // see triangles that are not next to each other; each further point would then add many.
    if (triangles.size() > 2 * static_cast<std::size_t>(round) + 6) return false;
  }
  return false;
}

int find_root(std::vector<int>& parent, int i) {
  while (parent[static_cast<std::size_t>(i)] != i) i = parent[static_cast<std::size_t>(i)];
  return i;
}

/// Group number of each triangle: neighbours that are flat together share one.
std::vector<int> group_flat(const std::vector<Vector3>& p, const std::vector<Triangle>& triangles, double tolerance) {
  std::map<Edge, int> owner;
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
    const std::array<int, 3>& v = triangles[static_cast<std::size_t>(t)].v;
    for (std::size_t k = 0; k < 3; ++k) owner[{v[k], v[(k + 1) % 3]}] = t;
  }
  std::vector<int> parent(triangles.size());
  std::iota(parent.begin(), parent.end(), 0);
  for (const auto& [edge, t] : owner) {
    const auto twin = owner.find({edge.second, edge.first});
    if (twin == owner.end() || twin->second < t) continue;
    const Triangle& one = triangles[static_cast<std::size_t>(t)];
    const Triangle& other = triangles[static_cast<std::size_t>(twin->second)];
    // The larger triangle knows its plane better.
    const Triangle& plane = one.area >= other.area ? one : other;
    const Triangle& guest = one.area >= other.area ? other : one;
    const bool flat =
        std::all_of(guest.v.begin(), guest.v.end(), [&](int v) { return std::abs(height(p, plane, v)) <= tolerance; });
    if (flat && plane.n.dot(guest.n) > 0.0) {
      parent[static_cast<std::size_t>(find_root(parent, t))] = find_root(parent, twin->second);
    }
  }
  std::vector<int> group(triangles.size());
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
    group[static_cast<std::size_t>(t)] = find_root(parent, t);
  return group;
}

/// Boundary loop of each group; empty when a boundary is not one loop.
Loops loops_of(const std::vector<Triangle>& triangles, const std::vector<int>& group) {
  std::map<int, std::map<int, int>> following;  // per group: vertex -> next vertex on the boundary
  std::map<Edge, int> owner;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) owner[{triangles[t].v[k], triangles[t].v[(k + 1) % 3]}] = group[t];
  }
  for (const auto& [edge, g] : owner) {
    const auto twin = owner.find({edge.second, edge.first});
    if (twin == owner.end()) return {};
    if (twin->second == g) continue;
    if (!following[g].emplace(edge.first, edge.second).second) return {};
  }
  Loops loops;
  for (const auto& [g, step] : following) {
    std::vector<int> loop;
    int v = step.begin()->first;
    do {
      loop.push_back(v);
      const auto next = step.find(v);
      if (next == step.end() || loop.size() > step.size()) return {};
      v = next->second;
    } while (v != loop.front());
    if (loop.size() != step.size()) return {};
    loops.push_back(std::move(loop));
  }
  return loops;
}

/// Vertices that only two faces share lie on a straight edge.
void drop_straight_vertices(Loops& loops) {
  std::map<int, int> degree;
  for (const std::vector<int>& loop : loops) {
    for (const int v : loop) ++degree[v];
  }
  for (std::vector<int>& loop : loops) {
    std::erase_if(loop, [&](int v) { return degree[v] < 3; });
  }
}

Vector3 newell_normal(const std::vector<Vector3>& p, const std::vector<int>& loop) {
  Vector3 sum = Vector3::Zero();
  const Vector3& o = p[static_cast<std::size_t>(loop[0])];
  for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
    sum += (p[static_cast<std::size_t>(loop[k])] - o).cross(p[static_cast<std::size_t>(loop[k + 1])] - o);
  }
  return sum.normalized();
}

/// The finished hull, or nothing when the loops do not close to a convex polyhedron.
std::optional<ConvexHull> assemble(const std::vector<Vector3>& p, const Loops& loops, double tolerance) {
  if (loops.size() < 4) return std::nullopt;
  ConvexHull hull;
  std::map<int, int> index;
  for (const std::vector<int>& loop : loops) {
    if (loop.size() < 3) return std::nullopt;
    for (const int v : loop) index.emplace(v, 0);
  }
  for (auto& [v, i] : index) {
    i = static_cast<int>(hull.vertices.size());
    hull.vertices.push_back(p[static_cast<std::size_t>(v)]);
  }
  std::map<Edge, int> owner;
  for (const std::vector<int>& loop : loops) {
    hull.normals.push_back(newell_normal(p, loop));
    std::vector<int>& face = hull.faces.emplace_back();
    for (const int v : loop) face.push_back(index[v]);
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Edge edge{face[k], face[(k + 1) % face.size()]};
      if (!owner.emplace(edge, static_cast<int>(hull.faces.size()) - 1).second) return std::nullopt;
    }
  }
  for (const auto& [edge, f] : owner) {
    const auto twin = owner.find({edge.second, edge.first});
    if (twin == owner.end()) return std::nullopt;
    if (edge.first < edge.second) hull.edges.push_back({edge.first, edge.second, f, twin->second});
  }
  if (hull.vertices.size() + hull.faces.size() != hull.edges.size() + 2) return std::nullopt;
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    const Vector3& o = hull.vertices[static_cast<std::size_t>(hull.faces[f][0])];
    for (const Vector3& v : hull.vertices) {
      if (!(hull.normals[f].dot(v - o) <= tolerance)) return std::nullopt;
    }
  }
  return hull;
}

Loops triangles_as_loops(const std::vector<Triangle>& triangles) {
  Loops loops;
  for (const Triangle& t : triangles) loops.emplace_back(t.v.begin(), t.v.end());
  return loops;
}

}  // namespace

Expected<ConvexHull, NoHull> make_convex_hull(std::span<const Vector3> points) {
  for (const Vector3& p : points) {
    if (!p.allFinite()) return Unexpected<NoHull>(NoHull::NotFinite);
  }
  if (points.size() < 4) return Unexpected<NoHull>(NoHull::TooFewPoints);
  const double size = size_of(points);
  const double tolerance = kMergeFraction * size;
  const std::vector<Vector3> p = distinct(points, tolerance);
  if (p.size() < 4) return Unexpected<NoHull>(NoHull::TooFewPoints);
  std::vector<Triangle> triangles = first_tetrahedron(p, size);
  if (triangles.empty()) return Unexpected<NoHull>(NoHull::Flat);
  if (!grow(p, tolerance, triangles)) return Unexpected<NoHull>(NoHull::TooManyVertices);
  Loops loops = loops_of(triangles, group_flat(p, triangles, tolerance));
  drop_straight_vertices(loops);
  // A group of many triangles may bend by a few tolerances; more means that joining went wrong.
  std::optional<ConvexHull> hull = assemble(p, loops, 4.0 * tolerance);
  if (!hull) hull = assemble(p, triangles_as_loops(triangles), 4.0 * tolerance);
  if (!hull) return Unexpected<NoHull>(NoHull::Flat);
  if (hull->vertices.size() > kMaxHullVertices) return Unexpected<NoHull>(NoHull::TooManyVertices);
  return *std::move(hull);
}

}  // namespace snug::geometry
