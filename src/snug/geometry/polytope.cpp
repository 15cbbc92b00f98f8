// Polytope: places the vertices and normals of a shape in a frame and finds its support.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "snug/core/check.hpp"
#include "snug/geometry/internal/box_topology.hpp"
#include "snug/geometry/internal/polytope.hpp"
#include "snug/geometry/internal/prism_topology.hpp"
#include "snug/geometry/internal/tolerances.hpp"

namespace snug::geometry::internal {

namespace {

constexpr std::array<int, 4> kSegmentEdge = {0, 1, -1, -1};

}  // namespace

Polytope::Polytope(const Box& box, const Pose& X, PolytopeStorage& room) noexcept
    : room_(&room), vertex_count_(8), face_count_(6), edge_count_(12) {
  const Vector3 x = X.R.col(0) * box.half[0];
  const Vector3 y = X.R.col(1) * box.half[1];
  const Vector3 z = X.R.col(2) * box.half[2];
  for (std::size_t v = 0; v < 8; ++v) {
    room.vertices[v] =
        X.p + ((v & 1U) != 0 ? 1.0 : -1.0) * x + ((v & 2U) != 0 ? 1.0 : -1.0) * y + ((v & 4U) != 0 ? 1.0 : -1.0) * z;
  }
  for (std::size_t f = 0; f < 6; ++f) {
    room.normals[f] = ((f & 1U) != 0 ? 1.0 : -1.0) * X.R.col(static_cast<Eigen::Index>(f / 2));
  }
}

Polytope::Polytope(const ConvexHull& hull, const Pose& X, PolytopeStorage& room) noexcept
    : hull_(&hull),
      room_(&room),
      vertex_count_(static_cast<int>(hull.vertices.size())),
      face_count_(static_cast<int>(hull.faces.size())),
      edge_count_(static_cast<int>(hull.edges.size())) {
  SNUG_CHECK(vertex_count_ >= 4 && vertex_count_ <= kMaxHullVertices && face_count_ <= kMaxHullFaces &&
                 edge_count_ <= kMaxHullEdges && hull.normals.size() == hull.faces.size(),
             "a hull that make_convex_hull did not make");
  for (std::size_t v = 0; v < hull.vertices.size(); ++v) room.vertices[v] = X * hull.vertices[v];
  for (std::size_t f = 0; f < hull.normals.size(); ++f) room.normals[f] = X.R * hull.normals[f];
}

Polytope::Polytope(const Capsule& capsule, const Pose& X, PolytopeStorage& room) noexcept
    : room_(&room), vertex_count_(capsule.half_length > 0.0 ? 2 : 1), edge_count_(capsule.half_length > 0.0 ? 1 : 0) {
  room.vertices[0] = X.p - capsule.half_length * X.R.col(2);
  room.vertices[1] = X.p + capsule.half_length * X.R.col(2);
}

Polytope::Polytope(const Vector3& from, const Vector3& to, PolytopeStorage& room) noexcept
    : room_(&room), vertex_count_(from == to ? 1 : 2), edge_count_(from == to ? 0 : 1) {
  room.vertices[0] = from;
  room.vertices[1] = to;
}

Polytope::Polytope(const Cylinder& cylinder, const Pose& X, const Vector3& azimuth_G, PolytopeStorage& room) noexcept
    : is_prism_(true),
      room_(&room),
      vertex_count_(2 * kPrismSides),
      face_count_(kPrismSides + 2),
      edge_count_(3 * kPrismSides) {
  const Vector3 x = X.R * azimuth_G;
  const Vector3 z = X.R.col(2);
  const Vector3 y = z.cross(x);
  room.normals[0] = -z;
  room.normals[1] = z;
  for (int i = 0; i < kPrismSides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kPrismSides;
    const double middle = 2.0 * std::numbers::pi * (i + 0.5) / kPrismSides;
    const Vector3 rim =
        i == 0 ? Vector3(cylinder.radius * x) : Vector3(cylinder.radius * (std::cos(angle) * x + std::sin(angle) * y));
    room.vertices[static_cast<std::size_t>(i)] = X.p - cylinder.half_length * z + rim;
    room.vertices[static_cast<std::size_t>(kPrismSides + i)] = X.p + cylinder.half_length * z + rim;
    room.normals[static_cast<std::size_t>(2 + i)] = std::cos(middle) * x + std::sin(middle) * y;
  }
}

std::span<const int> Polytope::face(int i) const noexcept {
  const auto index = static_cast<std::size_t>(i);
  if (is_prism_) {
    return i < 2 ? std::span<const int>(kPrismEnds[index]) : std::span<const int>(kPrismFaces[index - 2]);
  }
  return hull_ != nullptr ? std::span<const int>(hull_->faces[index]) : std::span<const int>(kBoxFaces[index]);
}

const std::array<int, 4>& Polytope::edge(int i) const noexcept {
  const auto index = static_cast<std::size_t>(i);
  if (is_segment()) return kSegmentEdge;
  if (is_prism_) return kPrismEdges[index];
  return hull_ != nullptr ? hull_->edges[index] : kBoxEdges[index];
}

double Polytope::support(const Vector3& n) const noexcept {
  double best = n.dot(vertex(0));
  for (int v = 1; v < vertex_count_; ++v) best = std::max(best, n.dot(vertex(v)));
  return best;
}

int Polytope::support_vertex(const Vector3& n) const noexcept {
  int best = 0;
  double reach = n.dot(vertex(0));
  for (int v = 1; v < vertex_count_; ++v) {
    const double candidate = n.dot(vertex(v));
    if (candidate > reach + kTie) {
      reach = candidate;
      best = v;
    }
  }
  return best;
}

int Polytope::face_along(const Vector3& n) const noexcept {
  const int corner = support_vertex(n);
  int best = -1;
  double best_cosine = -std::numeric_limits<double>::infinity();
  for (int f = 0; f < face_count_; ++f) {
    const double cosine = n.dot(normal(f));
    if (cosine <= best_cosine + kTie) continue;
    const std::span<const int> loop = face(f);
    if (std::find(loop.begin(), loop.end(), corner) == loop.end()) continue;
    best = f;
    best_cosine = cosine;
  }
  return best;
}

}  // namespace snug::geometry::internal
