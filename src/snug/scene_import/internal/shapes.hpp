// Shapes with their exact volumes, and meshes of files.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "snug/model/body.hpp"
#include "snug/model/mesh_pieces.hpp"
#include "snug/scene_import/internal/xml.hpp"

namespace snug::scene_import::internal {

/// A shape in its own frame, and the mass [kg], centre and inertia of the solid itself at density 1.
struct Solid {
  geometry::Shape shape;
  SpatialInertia unit;
};

/// Bounds of a size in scenarios, m.
inline constexpr double kSmallestSize = 1e-4, kLargestSize = 100.0;
/// Half of the edges of the slab that stands for a plane without end, m.
inline constexpr double kPlaneHalf = 50.0;
inline constexpr double kPlaneThickness = 1.0;

[[nodiscard]] Solid make_solid(const geometry::Shape& shape);
/// A hull of 64 corners on the ellipsoid; the mass is that of the ellipsoid.
[[nodiscard]] Solid make_ellipsoid(const Vector3& semi_axes);
/// A slab whose upper face is the plane z = 0 of the frame; no mass.
[[nodiscard]] Solid make_plane(double half_x, double half_y);
/// What a mesh weighs.
enum class MeshMass {
  Enclosed,  ///< what its surface encloses
  Hull,      ///< what its convex hull encloses
  Pyramids,  ///< pyramids on all triangles, each counted as positive: MuJoCo's legacy, more where a mesh is not convex
};
/// The hull of a surface of triangles, with its mass. Fails at `node` where there is no volume.
[[nodiscard]] Solid make_mesh(const std::vector<model::MeshPart>& parts, const Node& node,
                              MeshMass mass = MeshMass::Enclosed);
/// The parts of a mesh file. Fails at `node`, naming the file.
[[nodiscard]] std::vector<model::MeshPart> read_mesh_file(const std::filesystem::path& path, const Node& node);

/// The same thing in another frame.
[[nodiscard]] SpatialInertia moved(const SpatialInertia& inertia, const Pose& X_AB);
[[nodiscard]] SpatialInertia scaled(const SpatialInertia& inertia, double factor);

}  // namespace snug::scene_import::internal
