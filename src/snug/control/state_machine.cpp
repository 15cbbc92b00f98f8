// StateMachine: which state of the robot's controller runs, and what the states do with their tick.
#include "snug/control/state_machine.hpp"

#include <algorithm>
#include <utility>

#include "snug/control/states.hpp"
#include "snug/core/check.hpp"

namespace snug::control {
motion::ToolState tool_at(const robot::ArmModel& arm, const JointMotion& joints) {
  const robot::ArmPose at = robot::forward(arm, joints.q);
  const Vector6 V_WE = robot::tool_jacobian(arm, at) * joints.qd;
  return {at.X_WE, twist_from(V_WE)};
}

void StateContext::follow(const ToolTarget& target) {
  tick.joints = controller.tick(target, machine.joints, work);
  machine.tool = tool_at(controller.arm(), machine.joints);
  tick.has_commanded = true;
}

void StateContext::stand() {
  controller.brake(machine.joints);
  machine.tool = tool_at(controller.arm(), machine.joints);
  tick.program.tool = machine.tool;
  tick.program.X_WE_reference = machine.program.X_WE_reference;
  tick.program.io = machine.program.io;
  tick.program.row = machine.program.row;
  tick.program.phase = machine.program.phase;
  tick.has_commanded = true;
}

StateMachine::StateMachine(std::vector<std::unique_ptr<State>> states, std::vector<Transition> transitions,
                           const StateSettings& settings)
    : states_(std::move(states)), transitions_(std::move(transitions)) {
  SNUG_CHECK(!states_.empty(), "a machine without states");
  const auto is_known = [this](const std::string& name) {
    return std::any_of(states_.begin(), states_.end(), [&](const auto& state) { return state->name() == name; });
  };
  for (const Transition& transition : transitions_) {
    SNUG_CHECK(is_known(transition.from) && is_known(transition.to), "a transition between unknown states");
  }
  for (const auto& state : states_) state->configure(settings);
}

MachineState StateMachine::make_state(const JointController& controller, const robot::JointVector& q) const {
  MachineState machine;
  machine.joints = controller.make_state(q);
  machine.tool = tool_at(controller.arm(), machine.joints);
  machine.program = motion::make_controller_state(machine.tool.X_WE);
  return machine;
}

int StateMachine::next(int state, Outcome outcome) const {
  for (const Transition& transition : transitions_) {
    if (transition.from != name_of(state) || transition.outcome != outcome) continue;
    for (int i = 0; i < static_cast<int>(states_.size()); ++i) {
      if (name_of(i) == transition.to) return i;
    }
  }
  return -1;
}

MachineTick StateMachine::tick(const motion::PreparedProgram& plan, const JointController& controller,
                               MachineState& machine, JointControllerWork& work) const {
  MachineTick tick;
  StateContext context{plan, controller, machine, tick, work};
  const auto enter = [&](int state) {
    machine.state = state;
    machine.state_ticks = 0;
    states_[static_cast<std::size_t>(state)]->start(context);
  };
  if (machine.state < 0) enter(0);
  for (std::size_t hops = 0; !tick.has_commanded; ++hops) {
    SNUG_CHECK(hops <= states_.size(), "states that pass on to each other without end");
    const State& state = *states_[static_cast<std::size_t>(machine.state)];
    tick.state = machine.state;
    ++machine.state_ticks;
    tick.outcome = state.run(context);
    if (tick.outcome == Outcome::GoesOn) {
      SNUG_CHECK(tick.has_commanded, "a state that neither moves the joints nor ends");
      break;
    }
    const int to = next(machine.state, tick.outcome);
    if (to < 0) {
      SNUG_CHECK(tick.has_commanded, "a state that ended, leads nowhere and does not move the joints");
      break;
    }
    state.teardown(context);
    enter(to);
  }
  return tick;
}

std::string_view StateMachine::name_of(int state) const {
  return state < 0 ? std::string_view() : states_[static_cast<std::size_t>(state)]->name();
}

StateMachine make_demonstrator_machine(const StateSettings& settings) {
  std::vector<std::unique_ptr<State>> states;
  states.push_back(make_initial_state());
  states.push_back(make_operation_state());
  states.push_back(make_hold_state());
  return {std::move(states), {{"Initial", Outcome::Ok, "Operation"}, {"Operation", Outcome::Stuck, "Hold"}}, settings};
}

}  // namespace snug::control
