// run_joints: a program through the joints, without anything to touch: what is handed to a real robot.
#include "snug/control/joint_run.hpp"

namespace snug::control {
namespace {

constexpr double kLongestProgram = 7200.0;  ///< s

}  // namespace

JointRun run_joints(const motion::PreparedProgram& plan, const JointController& controller, const StateMachine& machine,
                    const robot::JointVector& q_start) {
  JointRun run;
  MachineState state = machine.make_state(controller, q_start);
  JointControllerWork work;
  const double dt = plan.settings.tick;
  for (std::int64_t i = 0; static_cast<double>(i) * dt < kLongestProgram; ++i) {
    JointSample sample;
    sample.time = static_cast<double>(i) * dt;
    sample.before = state.joints;
    sample.tool = state.tool;
    const MachineTick tick = machine.tick(plan, controller, state, work);
    sample.after = state.joints;
    sample.io = tick.program.io;
    sample.row = tick.program.row;
    sample.state = machine.name_of(tick.state);
    run.samples.push_back(std::move(sample));
    if (tick.program.finished_now) {
      run.is_complete = true;
      break;
    }
    if (tick.outcome == "Stuck") {
      run.stuck_row = tick.program.row;
      break;
    }
  }
  return run;
}

}  // namespace snug::control
