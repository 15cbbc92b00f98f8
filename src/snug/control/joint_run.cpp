// run_joints: a program through the joints, without anything to touch: what is handed to a real robot.
#include "snug/control/joint_run.hpp"

#include <cmath>
#include <utility>

namespace snug::control {
namespace {

constexpr double kLongestSettling = 10.0;  ///< s

}  // namespace

void bring_to_rest(const JointController& controller, double tick, JointRun& run) {
  while (!run.samples.empty() && run.samples.back().after.qd.norm() > 0.0) {
    JointSample sample = run.samples.back();
    sample.time = tick * (std::round(sample.time / tick) + 1.0);
    sample.before = run.samples.back().after;
    sample.tool = tool_at(controller.arm(), sample.before);
    sample.after = sample.before;
    controller.brake(sample.after);
    if (sample.after.qd.norm() < 1e-9) sample.after.qd.setZero();
    run.samples.push_back(std::move(sample));
  }
}

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
    if (done.outcome == Outcome::Stuck) run.stuck_row = done.program.row;
    return static_cast<double>(++i) * dt < longest;
  };
  while (!run.is_complete && run.stuck_row < 0 && tick(motion::kLongestProgram)) {
  }
  if (!run.is_complete) return run;
  const double settled = static_cast<double>(i) * dt + kLongestSettling;
  while (state.joints.qd.norm() > kAlmostAtRest && tick(settled)) {
  }
  bring_to_rest(controller, dt, run);
  return run;
}

}  // namespace snug::control
