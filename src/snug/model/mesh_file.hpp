// Mesh files as convex hulls: what a shape of a scenario or a link of a robot names.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "snug/geometry/convex_hull.hpp"

namespace snug::model {

/// Points of each part (mesh) of a file, with the transforms of the file's nodes, in the file's own axes. STL, OBJ or
/// DAE of at most kLargestMesh bytes. On failure: why, and no parts.
inline constexpr std::size_t kLargestMesh = std::size_t{32} << 20U;
struct MeshParts {
  std::vector<std::vector<Vector3>> parts;
  std::string error;
};
[[nodiscard]] MeshParts read_mesh_parts(const std::filesystem::path& path);

/// The convex hull of points; with too many corners that of those farthest in evenly spread directions, which cuts a
/// little off (docs/theory/robot.md).
[[nodiscard]] Expected<geometry::ConvexHull, geometry::NoHull> make_simple_hull(const std::vector<Vector3>& points);

}  // namespace snug::model
