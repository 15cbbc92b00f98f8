// try_motion: a prepared program done in a cell with contact.
#include "snug/cell/program_trial.hpp"

#include <fmt/format.h>

#include <utility>

namespace snug::cell {
namespace {

/// Of the states of the machine that every arm of a cell has.
const control::StateMachine& machine_names() {
  static const control::StateMachine machine = control::make_demonstrator_machine();
  return machine;
}

/// One tick, kept in the trial until the program has ended and the joints rest.
CellTick advance(const Simulation& simulation, const motion::PreparedProgram& plan, CellState& state,
                 CellWorkspace& work, MotionTrial& trial) {
  control::JointSample sample;
  sample.time = simulation.time(state);
  if (state.arm) {
    sample.before = state.arm->machine.joints;
    sample.tool = state.arm->machine.tool;
  }
  CellTick tick = simulation.advance(plan, state, work);
  trial.failure = tick.failure;
  auto& samples = trial.joints.samples;
  const bool has_rested = trial.joints.is_complete && samples.back().after.qd.norm() <= control::kAlmostAtRest;
  if (!state.arm || has_rested) return tick;
  sample.after = state.arm->machine.joints;
  sample.io = state.controller.io;
  sample.row = tick.row;
  sample.state = machine_names().name_of(state.arm->machine.state);
  samples.push_back(std::move(sample));
  return tick;
}

}  // namespace

MotionTrial try_motion(const Simulation& simulation, const motion::PreparedProgram& plan) {
  MotionTrial trial;
  CellState state = simulation.make_state();
  CellWorkspace work = simulation.make_workspace();
  bool has_ended = false;
  while (!has_ended && !trial.failure) {
    has_ended = advance(simulation, plan, state, work, trial).has_ended;
    if (simulation.time(state) > motion::kLongestProgram)
      trial.failure = {FailureKind::TooLong, "the program did not end within two hours"};
  }
  trial.joints.is_complete = has_ended && !trial.failure;
  trial.duration = simulation.time(state);
  while (!trial.failure && simulation.time(state) < trial.duration + motion::kSettleTime) {
    (void)advance(simulation, plan, state, work, trial);
  }
  if (simulation.arm() != nullptr) {
    control::bring_to_rest(simulation.arm()->controller(), plan.settings.tick, trial.joints);
  }
  trial.boxes = simulation.boxes(state);
  return trial;
}

std::string compare_trials(const MotionTrial& wanted, const MotionTrial& trial) {
  if (trial.failure) return trial.failure.text;
  std::string worse;
  for (std::size_t i = 0; i < trial.boxes.size() && i < wanted.boxes.size(); ++i) {
    if (wanted.boxes[i].state != BoxState::Packed || trial.boxes[i].state == BoxState::Packed) continue;
    worse += fmt::format("{}{} is {}, not packed", worse.empty() ? "" : "; ", trial.boxes[i].id,
                         name_of(trial.boxes[i].state));
  }
  return worse;
}

std::string find_loss(const MotionTrial& trial) {
  if (trial.failure) return trial.failure.text;
  std::string lost;
  for (const BoxResult& box : trial.boxes) {
    if (box.state == BoxState::Packed || box.state == BoxState::Waiting) continue;
    lost += fmt::format("{}{} is {}, not packed", lost.empty() ? "" : "; ", box.id, name_of(box.state));
  }
  return lost;
}

}  // namespace snug::cell
