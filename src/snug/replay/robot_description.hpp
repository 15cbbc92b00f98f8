// RobotDescription: the URDF and the mesh files that a robot is drawn with, beside a recording that only names it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "snug/record/recording.hpp"
#include "snug/robot/visuals.hpp"

namespace snug::replay {

/// Empty: links are drawn from the shapes that the recording has of them.
struct RobotDescription {
  std::string urdf;                     ///< the whole file
  std::vector<robot::MeshFile> meshes;  ///< that its visuals name
};

/// The URDF that the scenario of a recording names, as it is written there; empty without a robot in the run.
[[nodiscard]] std::string named_urdf(const record::RecordingHeader& header);

/// Reads a URDF and its meshes, at most 24 MiB of them. Throws InputError for a URDF that cannot be read.
[[nodiscard]] RobotDescription read_robot(const std::filesystem::path& urdf);

}  // namespace snug::replay
