// URScript: programs for the controller of a UR robot: rows as straight moves, or the joints of a simulation in time.
#pragma once

#include <string>

#include "snug/control/joint_run.hpp"
#include "snug/control/robot_program.hpp"
#include "snug/model/robot_io.hpp"

namespace snug::control {

struct UrScriptOptions {
  model::RobotIo io;               ///< at which outputs and inputs gripper and cell are wired
  double vacuum_timeout = 3.0;     ///< s, after which a vacuum that does not come or go halts the program
  double vent_time = 0.3;          ///< s, from when the input says that the vacuum fell until it is gone, at least
  double part_timeout = 60.0;      ///< s, after which a box that does not come halts the program
  double pressure_reached = -3e4;  ///< Pa, gauge: the vacuum holds, where no input says so
  double pressure_gone = -2e3;     ///< Pa, gauge: above it the cup is empty, where there is a gauge
  /// Payloads with their inertia, changed over a tenth of a second (set_target_payload): PolyScope 5.10 and later.
  bool has_inertia = false;
  std::size_t first_row = 0;  ///< of the program: it begins there, at rest
  /// Nothing is switched or waited for; 20 mm above every row, at a quarter of its speed.
  bool is_dry = false;
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
/// `vent_time` more and until the gauge says so, too, and set_payload of gripper and load; before a pick at the aligner
/// a wait until a box stands there; and movel to its pose in the controller's base frame with the
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
/// of its target. Where the cup is empty before a pick at the aligner, and at the start, it waits until a box stands
/// there. Nothing else is felt. Throws InputError for an arm that is no UR, and
/// for joints that are not finite.
[[nodiscard]] UrServoScript format_servo_urscript(const JointRun& run, const RobotProgram& program,
                                                  const UrScriptOptions& options);

/// The run from a sample on, begun at rest there: over twice the time of the first `ramp` samples after it the joints
/// come up to their speeds. What was done before is left out; times begin at 0. Checked: there are such samples.
[[nodiscard]] JointRun begin_at(const JointRun& run, std::size_t sample, std::size_t ramp, double tick);

}  // namespace snug::control
