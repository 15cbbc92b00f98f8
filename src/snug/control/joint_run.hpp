// run_joints: a program through the joints, without anything to touch: what is handed to a real robot.
#pragma once

#include <string>
#include <vector>

#include "snug/control/state_machine.hpp"

namespace snug::control {

/// One tick.
struct JointSample {
  double time = 0.0;       ///< s, at its start
  JointState before;       ///< measured by the encoders at its start
  JointState after;        ///< commanded for its end
  motion::ToolState tool;  ///< at its start
  motion::IO io;           ///< from its start on
  int row = -1;            ///< aimed at
  std::string_view state;  ///< of the state machine
};

/// Joints this slow are braked to a stand within a tick, rad/s (m/s): an acceleration of 0.1 at 8 ms.
inline constexpr double kAlmostAtRest = 1e-3;

struct JointRun {
  std::vector<JointSample> samples;  ///< of a complete run: until the joints rest on the last row
  bool is_complete = false;          ///< the last row was reached
  int stuck_row = -1;                ///< that was not reached in time, -1 when all were
};

/// Appends what brakes the joints to a stand, to the last bit, after the run's last sample. Nothing without samples.
void bring_to_rest(const JointController& controller, double tick, JointRun& run);

/// Until the program ends and the joints have come to rest, a row is not reached in time, or two hours are over.
[[nodiscard]] JointRun run_joints(const motion::PreparedProgram& plan, const JointController& controller,
                                  const StateMachine& machine, const robot::JointVector& q_start);

}  // namespace snug::control
