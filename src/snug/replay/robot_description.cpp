// RobotDescription: the URDF and the mesh files that a robot is drawn with.
#include "snug/replay/robot_description.hpp"

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/model/scenario.hpp"

namespace snug::replay {

constexpr std::size_t kMostMeshBytes = std::size_t{24} << 20U;  ///< a UR10's are 3 MB

std::string named_urdf(const record::RecordingHeader& header) {
  if (header.joints.empty()) return "";
  try {
    const model::Scenario scenario = model::parse_scenario(header.scenario_text, "scenario of the recording");
    return scenario.robot ? scenario.robot->urdf : "";
  } catch (const InputError&) {
    return "";  // made by another version
  }
}

RobotDescription read_robot(const std::filesystem::path& urdf) {
  return {read_file(urdf, "a URDF"), robot::read_visual_meshes(urdf, kMostMeshBytes)};
}

}  // namespace snug::replay
