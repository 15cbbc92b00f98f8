// Programs in the languages of real robots: URScript, ROS trajectories, logs as mc_rtc writes them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/control/joint_run.hpp"

namespace snug::control {

/// What the cup holds on the way to a row, fixed to E.
struct CarriedLoad {
  double mass = 0.0;                ///< kg
  Vector3 com_E = Vector3::Zero();  ///< m
  bool operator==(const CarriedLoad&) const = default;
};

/// A program, the robot that is to do it, and what it carries.
struct RobotProgram {
  const motion::PreparedProgram& plan;
  const robot::ArmModel& arm;
  robot::JointVector q_start;                     ///< from where the program begins
  std::vector<std::optional<CarriedLoad>> loads;  ///< one for each row
  /// What it was made of, a line each: program, sequence, version. Comments at the head of what is written.
  std::vector<std::string> notes = {};
  /// s, of the program as it was simulated, whose limits `plan` may have been fitted to; 0: that of `plan`.
  double simulated_duration = 0.0;
  std::string simulated_with = "with a controller that lags behind";  ///< what the simulation took this long with
};

struct UrScriptOptions {
  int vacuum_output = 0;        ///< standard digital output
  int blow_off_output = 1;      ///< standard digital output
  int vacuum_input = 0;         ///< standard digital input, on while there is vacuum
  double vacuum_timeout = 3.0;  ///< s, after which a vacuum that does not come or go halts the program
};

struct UrScript {
  std::string text;
  int moves = 0;                  ///< movel
  double nominal_duration = 0.0;  ///< s, of the moves from stop to stop, and of `vacuum_wait` at each change of vacuum
  /// s, with the scenario's controller: it lags behind the same moves and leaves a row when it is within its precision.
  double simulated_duration = 0.0;
};

/// A URScript function. movej to the start; then for each row its outputs; where the vacuum changes, a wait until its
/// input says so, and set_payload of gripper and load; and movel to its pose in the controller's base frame with the
/// row's acceleration and speed, by duration where the turn decides, since movel limits the translation only. Rows
/// reached within a precision of 0.05 m and more are blended, by less than half of the moves on either side, so that
/// blends do not overlap. A row less than 0.05 mm and 0.1 mrad from the one before gets no move. Throws InputError for
/// an arm that is no UR: other axes, other joint names, or no links "base" and "tool0".
[[nodiscard]] UrScript format_urscript(const RobotProgram& program, const UrScriptOptions& options);

/// Two YAML documents: trajectory_msgs/JointTrajectory, a point every `period` s (a multiple of the tick) and the last
/// one, at rest; then `io`, what the outputs do from which time on.
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
