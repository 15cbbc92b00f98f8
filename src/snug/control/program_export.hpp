// Programs in the languages of real robots: URScript, ROS trajectories, logs as mc_rtc writes them.
#pragma once

#include <string>
#include <vector>

#include "snug/control/joint_run.hpp"

namespace snug::control {

struct UrScriptOptions {
  int vacuum_output = 0;    ///< standard digital output
  int blow_off_output = 1;  ///< standard digital output
};

/// A URScript function: set_tcp from tool0 to E, then for each row its outputs, the wait when the vacuum changes, and
/// movel to its pose in the controller's base frame with the row's acceleration and speed; by duration where the turn
/// decides, since movel limits the translation only. Rows reached within a precision of 0.05 and more are blended.
/// Throws InputError for an arm whose URDF has no links "base" and "tool0".
[[nodiscard]] std::string format_urscript(const motion::PreparedProgram& plan, const robot::ArmModel& arm,
                                          const Pose& X_WE_start, const UrScriptOptions& options);

/// trajectory_msgs/JointTrajectory as YAML, a point every `period` s (a multiple of the tick) and the last one.
[[nodiscard]] std::string format_ros_trajectory(const JointRun& run, const robot::ArmModel& arm, double tick,
                                                double period);

/// One entry of an mc_rtc log; as many texts or numbers as there are samples.
struct LogColumn {
  std::string name;
  std::vector<double> numbers;
  std::vector<std::string> texts;  ///< of an entry that is not a number
};

/// t, qIn_i, alphaIn_i, tauIn_i, qOut_i, alphaOut_i, <robot>_FloatingBase_{orientation,position}, the tool's pose,
/// vacuum, row and Executor_Main. tauIn: inverse dynamics without contact. Orientations are world -> body.
[[nodiscard]] std::vector<LogColumn> make_log(const JointRun& run, const robot::ArmModel& arm,
                                              const Vector3& gravity_W);
/// Separator ';', names first.
[[nodiscard]] std::string format_log_csv(const std::vector<LogColumn>& log);
/// The columnar binary form that mc_log_ui reads: little-endian.
[[nodiscard]] std::string format_log_flat(const std::vector<LogColumn>& log);

}  // namespace snug::control
