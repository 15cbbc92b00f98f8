// TickRecorder: the ticks of a cell under way as frames and events of a recording; what the cell came to, at the end.
#include "snug/runs/internal/tick_recorder.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "snug/runs/internal/program_run.hpp"

namespace snug::runs::internal {

using cell::BoxResult;
using cell::BoxState;
using cell::CellArm;
using cell::CellState;
using cell::CellTick;
using cell::CellWorkspace;
using cell::Simulation;
using cell::SimulationOptions;

TickRecorder::TickRecorder(const Simulation& simulation, RecorderSetup setup) : simulation_(simulation) {
  if (setup.path.empty() && setup.file == nullptr && setup.observer == nullptr) return;
  const double tick = simulation.scenario().controller.tick;
  const double period = simulation.scenario().record_period.value_or(tick);
  ticks_a_frame_ = std::max<std::int64_t>(1, std::llround(period / tick));
  setup.period = tick * static_cast<double>(ticks_a_frame_);
  setup.sequence = simulation.sequence().name;
  if (const CellArm* arm = simulation.arm()) {
    for (const robot::Joint& joint : arm->model().joints) setup.joints.push_back(joint.name);
  }
  recorder_.emplace(simulation.scenario(), simulation.world(), setup);
}

bool TickRecorder::add(const CellTick& tick, const CellState& state, const CellWorkspace& work) {
  if (!recorder_) return true;
  recorder_->add_events(state.event_log.events());
  const FrameInput input{tick.tool.X_WE,
                         tick.tool.V_WE,
                         tick.X_WE_reference,
                         tick.row,
                         &state.gripper,
                         tick.command,
                         simulation_.arm() != nullptr ? &work.arm : nullptr};
  if (++ticks_ % ticks_a_frame_ != 0 && !tick.failure) return true;
  return recorder_->add_frame(simulation_.world(), state.world, work.physics, tick.step, input);
}

void TickRecorder::close(const CellState& state, const std::string& result_json, bool is_interrupted) {
  if (!recorder_) return;
  recorder_->add_events(state.event_log.events());
  recorder_->close(result_json, is_interrupted);
}

std::string settings_json(const SimulationOptions& options, const std::string& corrections) {
  const auto or_none = [](const std::string& name) { return name.empty() ? "none" : name; };
  const nlohmann::ordered_json settings = {{"cup", cup::name_of(options.cup.value_or(cup::CupMode::Phases))},
                                           {"controller", motion::name_of(options.tracking)},
                                           {"corrections", or_none(corrections)},
                                           {"robot", or_none(options.robot)}};
  return settings.dump();
}

void fill_result(const Simulation& simulation, const CellState& state, const CellWorkspace& work, RunResult& result) {
  fill_contacts(simulation.world(), state.world, work.solver, result);
  result.lost = work.lost;
  result.boxes = simulation.boxes(state);
  result.events = state.event_log.events();
  result.repicks = state.event_log.repicks();
  std::vector<std::string> packed;
  for (const BoxResult& box : result.boxes) {
    if (box.state == BoxState::Packed) packed.push_back(box.id);
  }
  const model::Scenario& scenario = simulation.scenario();
  if (const model::Container* container = model::find_container(scenario, scenario.target)) {
    result.filling_degree_percent = model::compute_filling_degree_percent(scenario, *container, packed);
  }
  result.state_hash = simulation.hash(state);
  if (simulation.arm() != nullptr) result.stop = work.arm.stop;
}

}  // namespace snug::runs::internal
