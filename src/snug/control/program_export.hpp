// Programs through the joints for other programs: ROS trajectories, logs as mc_rtc writes them.
#pragma once

#include <string>
#include <vector>

#include "snug/control/joint_run.hpp"
#include "snug/control/robot_program.hpp"

namespace snug::control {

/// A YAML document: trajectory_msgs/JointTrajectory of any arm, and a key `io` beside its own: what the outputs do from
/// which time on. A point at least every `period` s (a multiple of the tick), more where quintic polynomials between
/// them (what a joint trajectory controller makes of positions, speeds and accelerations) would leave the run by more
/// than 0.2 mrad, the speed limits of the joints, or the largest acceleration of the run; the last one at rest. All is
/// half a tick later than in the run.
[[nodiscard]] std::string format_ros_trajectory(const JointRun& run, const RobotProgram& program, double period);

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
