// try_motion: a prepared program done in a cell with contact.
#include "snug/cell/program_trial.hpp"

#include <fmt/format.h>

namespace snug::cell {
namespace {

constexpr double kLongestTrial = 7200.0;  ///< s
constexpr double kSettleTime = 1.0;       ///< s, as `run` gives boxes that still move

}  // namespace

MotionTrial try_motion(const Simulation& simulation, const motion::PreparedProgram& plan) {
  MotionTrial trial;
  CellState state = simulation.make_state();
  CellWorkspace work = simulation.make_workspace();
  bool has_ended = false;
  while (!has_ended && trial.failure.empty()) {
    const CellTick tick = simulation.advance(plan, state, work);
    has_ended = tick.has_ended;
    trial.failure = tick.failure;
    if (simulation.time(state) > kLongestTrial) trial.failure = "the program did not end within two hours";
  }
  trial.duration = simulation.time(state);
  while (trial.failure.empty() && simulation.time(state) < trial.duration + kSettleTime) {
    trial.failure = simulation.advance(plan, state, work).failure;
  }
  trial.boxes = simulation.boxes(state);
  return trial;
}

std::string compare_trials(const MotionTrial& wanted, const MotionTrial& trial) {
  if (!trial.failure.empty()) return trial.failure;
  std::string worse;
  for (std::size_t i = 0; i < trial.boxes.size() && i < wanted.boxes.size(); ++i) {
    if (wanted.boxes[i].state != BoxState::Packed || trial.boxes[i].state == BoxState::Packed) continue;
    worse += fmt::format("{}{} is {}, not packed", worse.empty() ? "" : "; ", trial.boxes[i].id,
                         name_of(trial.boxes[i].state));
  }
  return worse;
}

}  // namespace snug::cell
