// Visuals: how the links of a URDF look, for those who draw them; nothing here touches anything.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "snug/model/body.hpp"
#include "snug/model/mesh_file.hpp"

namespace snug::robot {

using Rgba = std::array<double, 4>;  ///< 0 .. 1
inline constexpr Rgba kPlainLink = {0.62, 0.66, 0.70, 1.0};

/// One <visual>: a plain shape or a mesh, in the frame L of its link.
struct Visual {
  Pose X_LG;
  std::variant<geometry::Box, geometry::Capsule, geometry::Cylinder, model::DrawnMesh> shape;
  Rgba rgba = kPlainLink;
};

struct LinkVisuals {
  std::string link;
  std::vector<Visual> visuals;
};

/// A mesh file that visuals name.
struct MeshFile {
  std::string name;   ///< as the URDF writes it
  std::string bytes;  ///< whole
};

/// The mesh files that the visuals of a URDF name, each once; those not there or beyond `most_bytes` in all are left
/// out. Throws InputError for a URDF that cannot be read.
[[nodiscard]] std::vector<MeshFile> read_visual_meshes(const std::filesystem::path& urdf, std::size_t most_bytes);

/// Links that have a look, with their materials' colours. What cannot be drawn (a mesh that is not among `meshes`, a
/// shape that makes no sense) is left out; empty for a text that is no URDF.
[[nodiscard]] std::vector<LinkVisuals> parse_visuals(const std::string& urdf, const std::vector<MeshFile>& meshes);

}  // namespace snug::robot
