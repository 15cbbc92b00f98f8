// Mesh files as convex hulls: what a shape of a scenario or a link of a robot names.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "snug/geometry/convex_hull.hpp"
#include "snug/model/mesh_pieces.hpp"

namespace snug::model {

/// Each part (mesh) of a file, with the transforms of the file's nodes, in the file's own axes, polygons as fans of
/// triangles. STL, OBJ or DAE of at most kLargestMesh bytes, that takes at most some 20 times its size and 100 MB to
/// read. In files above 1 MB points may be there several times. On failure: why, and no parts.
inline constexpr std::size_t kLargestMesh = std::size_t{64} << 20U;
struct MeshParts {
  std::vector<MeshPart> parts;
  std::string error;
};
[[nodiscard]] MeshParts read_mesh_parts(const std::filesystem::path& path);

/// A part of a mesh file as it is drawn: triangles between vertices, m, in the file's own axes.
inline constexpr std::size_t kLargestDrawn = std::size_t{32} << 20U;
struct DrawnMesh {
  std::vector<Vector3> vertices;
  std::vector<std::array<int, 3>> triangles;
  std::optional<std::array<double, 4>> rgba;  ///< of its material, 0 .. 1
};
/// The parts of a mesh file of at most kLargestDrawn bytes that is held in memory; `ending`: .stl, .obj or .dae, in any
/// case. Empty for what cannot be
/// read: a look is worth no failed run.
[[nodiscard]] std::vector<DrawnMesh> parse_drawn_meshes(std::string_view bytes, const std::string& ending);

/// The convex hull of points; with too many corners that of those farthest in evenly spread directions, which cuts a
/// little off (docs/theory/robot.md).
[[nodiscard]] Expected<geometry::ConvexHull, geometry::NoHull> make_simple_hull(const std::vector<Vector3>& points);

}  // namespace snug::model
