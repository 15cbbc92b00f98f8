// robot_files: where the URDF is that a recording only names.
#pragma once

#include <optional>
#include <string>

#include "snug/record/reader.hpp"
#include "snug/replay/robot_description.hpp"

namespace snug::app {

/// How the robot of a recording looks: `urdf` if it was given, else the file that its scenario names, looked for beside
/// the recording, in this folder and among the shipped scenarios. Nothing, said on stderr, where there is none: links
/// are then drawn from the shapes that touch. Throws InputError for a file that was given and cannot be read.
[[nodiscard]] replay::RobotDescription find_robot(const record::RecordingReader& reader, const std::string& recording,
                                                  const std::optional<std::string>& urdf);

}  // namespace snug::app
