// Polytope: one view of a box, a hull, the core of a capsule or a part of a cylinder, so that the general algorithms
// are written once.
#pragma once

#include <array>
#include <span>

#include "snug/geometry/convex_hull.hpp"

namespace snug::geometry::internal {

/// Room for the vertices and normals of one shape in another's frame.
struct PolytopeStorage {
  std::array<Vector3, kMaxHullVertices> vertices;
  std::array<Vector3, kMaxHullFaces> normals;
};

/// Vertices, faces and edges in one frame. Refers to the room (and the hull) it was made from.
class Polytope {
 public:
  Polytope(const Box& box, const Pose& X, PolytopeStorage& room) noexcept;
  Polytope(const ConvexHull& hull, const Pose& X, PolytopeStorage& room) noexcept;
  /// The capsule's segment: two vertices, one edge, no faces (its faces read -1). One vertex when the length is 0.
  Polytope(const Capsule& capsule, const Pose& X, PolytopeStorage& room) noexcept;

  /// Two points (or one, when they are the same) and what is between them.
  Polytope(const Vector3& from, const Vector3& to, PolytopeStorage& room) noexcept;
  /// Prism of kPrismSides inside a cylinder, with its first side edge in the plane of z and `azimuth_G` (unit, square
  /// to z). Faces: lower end, upper end, sides.
  Polytope(const Cylinder& cylinder, const Pose& X, const Vector3& azimuth_G, PolytopeStorage& room) noexcept;

  [[nodiscard]] int vertex_count() const noexcept { return vertex_count_; }
  [[nodiscard]] int face_count() const noexcept { return face_count_; }
  [[nodiscard]] int edge_count() const noexcept { return edge_count_; }
  [[nodiscard]] const Vector3& vertex(int i) const noexcept { return room_->vertices[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const Vector3& normal(int i) const noexcept { return room_->normals[static_cast<std::size_t>(i)]; }
  [[nodiscard]] std::span<const int> face(int i) const noexcept;
  /// Vertex, vertex, face, face.
  [[nodiscard]] const std::array<int, 4>& edge(int i) const noexcept;
  [[nodiscard]] bool is_segment() const noexcept { return face_count_ == 0; }

  /// Largest n . p over the vertices.
  [[nodiscard]] double support(const Vector3& n) const noexcept;
  /// The vertex where it is reached, the first of several.
  [[nodiscard]] int support_vertex(const Vector3& n) const noexcept;
  /// The face at the support vertex whose normal is most along n; -1 without faces.
  [[nodiscard]] int face_along(const Vector3& n) const noexcept;

 private:
  const ConvexHull* hull_ = nullptr;
  bool is_prism_ = false;
  const PolytopeStorage* room_ = nullptr;
  int vertex_count_ = 0;
  int face_count_ = 0;
  int edge_count_ = 0;
};

}  // namespace snug::geometry::internal
