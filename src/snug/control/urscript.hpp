// URScript: programs for the controller of a UR robot: rows as straight moves, or the joints of a simulation in time.
#pragma once

#include <string>

#include "snug/control/joint_run.hpp"
#include "snug/control/robot_program.hpp"

namespace snug::control {

struct UrScriptOptions {
  int vacuum_output = 0;        ///< standard digital output
  int blow_off_output = 1;      ///< standard digital output
  int vacuum_input = 0;         ///< standard digital input, on while there is vacuum
  double vacuum_timeout = 3.0;  ///< s, after which a vacuum that does not come or go halts the program
  /// s, from when the input says that the vacuum fell below its threshold until it is gone.
  double vent_time = 0.3;
};

struct UrScript {
  std::string text;
  int moves = 0;                  ///< movel
  double nominal_duration = 0.0;  ///< s, of the moves from stop to stop, and of `vacuum_wait` at each change of vacuum
  /// s, with the scenario's controller: it lags behind the same moves and leaves a row when it is within its precision.
  double simulated_duration = 0.0;
};

/// A URScript function, and nothing behind its end: as a program it runs when it is sent. Outputs off, movej to the
/// start; then for each row its outputs; where the vacuum changes, a wait until its input says so and, where it goes,
/// `vent_time` more, and set_payload of gripper and load; and movel to its pose in the controller's base frame with the
/// row's acceleration and speed, by duration where the turn decides, since movel limits the translation only. Rows
/// reached within a precision of 0.05 m and more are blended, by less than half of the moves on either side, so that
/// blends do not overlap. A row less than 0.05 mm and 0.1 mrad from the one before gets no move. Throws InputError for
/// an arm that is no UR: other axes, other joint names, or no links "base" and "tool0".
[[nodiscard]] UrScript format_urscript(const RobotProgram& program, const UrScriptOptions& options);

struct UrServoScript {
  std::string text;
  std::size_t knots = 0;
  double followed_duration = 0.0;   ///< s, of all but the waits for the vacuum
  double simulated_duration = 0.0;  ///< s, of the run
};

/// A URScript function that gives the robot's controller the joints of a run, a target each of its steps (servoj), on
/// cubic polynomials between knots that pass every sample within 15 microradians: the tool within 0.1 mm. There is a
/// knot where a row ends. Outputs change where they do in the run. Where the vacuum changes and the joints rest, the
/// script waits until its input says so, sets the payload, and goes on with the sample at which the joints leave; where
/// they move, it sets outputs and payload on the way. Wherever it stands, it halts unless each joint is within 0.02 rad
/// of its target. Nothing else is felt. Throws InputError for an arm that is no UR, and
/// for joints that are not finite.
[[nodiscard]] UrServoScript format_servo_urscript(const JointRun& run, const RobotProgram& program,
                                                  const UrScriptOptions& options);

}  // namespace snug::control
