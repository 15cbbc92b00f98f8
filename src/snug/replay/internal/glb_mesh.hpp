// GlbMesh: bodies as triangles, by colour. Internal to the module.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "snug/record/recording.hpp"
#include "snug/robot/visuals.hpp"

namespace snug::replay::internal {

/// Triangles of one colour; vertices in the frame of the body, m.
struct GlbPart {
  robot::Rgba rgba = robot::kPlainLink;
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise as seen from outside
};

/// What one body looks like.
using GlbMesh = std::vector<GlbPart>;

/// Adds a shape that a recording has of a body. Round shapes become prisms of 32 sides.
void add_glb_shape(GlbMesh& mesh, const record::ShapeInfo& shape, const robot::Rgba& rgba);
/// Adds a visual of a URDF.
void add_glb_visual(GlbMesh& mesh, const robot::Visual& visual);
/// Adds the cup from E to its lip at X_ES, in E.
void add_glb_cup(GlbMesh& mesh, const Pose& X_ES, double lip_radius, const robot::Rgba& rgba);

}  // namespace snug::replay::internal
