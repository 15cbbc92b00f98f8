// RobotLook: the links of a robot as they are drawn, small enough for a page. Internal to the module.
#pragma once

#include <vector>

#include "snug/record/recording.hpp"
#include "snug/replay/robot_description.hpp"

namespace snug::replay::internal {

/// One link that has a look of its own.
struct LinkLook {
  int body = -1;  ///< row of the recording's bodies
  std::vector<robot::Visual> visuals;
};

/// Triangles that all links together have at most: what more there are is merged until they fit.
inline constexpr std::size_t kMostTriangles = 40'000;

/// The looks of the links that are bodies of the recording.
[[nodiscard]] std::vector<LinkLook> find_looks(const record::RecordingHeader& header, const RobotDescription& robot,
                                               std::size_t most_triangles = kMostTriangles);

/// Vertices of one cell of a grid become one, their mean; triangles that lose a corner are left out.
[[nodiscard]] model::DrawnMesh merge_vertices(const model::DrawnMesh& mesh, double cell);

}  // namespace snug::replay::internal
