// MoveItExport: one instant of a recording as a planning scene of MoveIt.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "snug/core/output_file.hpp"
#include "snug/record/reader.hpp"
#include "snug/replay/robot_description.hpp"

namespace snug::replay {

struct MoveItTotals {
  double time = 0.0;                  ///< s, of the frame
  std::size_t objects = 0;            ///< of the world
  std::string frame;                  ///< that their poses are in
  std::vector<std::string> attached;  ///< to the flange: the gripper, and the body that the cup holds
};
/// "12 collision objects at 8.000 s, in frame W, attached: gripper"
[[nodiscard]] std::string to_text(const MoveItTotals& totals);

/// Writes moveit_msgs/PlanningScene as YAML, a difference to the scene that a planner has (docs/formats.md, "MoveIt
/// scene"), at the frame nearest to `time` (s; the last without). `name` is that of the recording. Throws InputError
/// for a recording without frames.
MoveItTotals export_moveit_scene(record::RecordingReader& reader, const std::string& name,
                                 const std::optional<double>& time, OutputFile file,
                                 const RobotDescription& robot = {});

}  // namespace snug::replay
