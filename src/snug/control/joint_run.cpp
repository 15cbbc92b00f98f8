// run_joints: a program through the joints, without anything to touch: what is handed to a real robot.
#include "snug/control/joint_run.hpp"

namespace snug::control {
namespace {

// rad/s (m/s), from which the joints are braked to a stand within a tick: an acceleration of 0.1 at 8 ms.
constexpr double kSlow = 1e-3;
constexpr double kLongestSettling = 10.0;  ///< s

}  // namespace

JointRun run_joints(const motion::PreparedProgram& plan, const JointController& controller, const StateMachine& machine,
                    const robot::JointVector& q_start) {
  JointRun run;
  MachineState state = machine.make_state(controller, q_start);
  JointControllerWork work;
  const double dt = plan.settings.tick;
  std::int64_t i = 0;
  const auto tick = [&](double longest) {
    JointSample sample;
    sample.time = static_cast<double>(i) * dt;
    sample.before = state.joints;
    sample.tool = state.tool;
    const MachineTick done = machine.tick(plan, controller, state, work);
    sample.after = state.joints;
    sample.io = done.program.io;
    sample.row = done.program.row;
    sample.state = machine.name_of(done.state);
    run.samples.push_back(std::move(sample));
    run.is_complete = run.is_complete || done.program.finished_now;
    if (done.outcome == "Stuck") run.stuck_row = done.program.row;
    return static_cast<double>(++i) * dt < longest;
  };
  while (!run.is_complete && run.stuck_row < 0 && tick(kLongestProgram)) {
  }
  if (!run.is_complete) return run;
  const double settled = static_cast<double>(i) * dt + kLongestSettling;
  while (state.joints.qd.norm() > kSlow && tick(settled)) {
  }
  while (state.joints.qd.norm() > 0.0) {  // to the last bit
    JointSample sample = run.samples.back();
    sample.time = static_cast<double>(i++) * dt;
    sample.before = state.joints;
    sample.tool = state.tool;
    controller.brake(state.joints);
    if (state.joints.qd.norm() < 1e-9) state.joints.qd.setZero();
    sample.after = state.joints;
    run.samples.push_back(std::move(sample));
  }
  return run;
}

}  // namespace snug::control
