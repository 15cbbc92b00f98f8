// ProgramRun: a program executed in the cell, recorded, and what became of every box.
#include "snug/runs/internal/program_run.hpp"

#include <chrono>
#include <optional>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/runs/corrected.hpp"
#include "snug/runs/internal/tick_recorder.hpp"

namespace snug::runs::internal {
namespace {

using cell::CellState;
using cell::CellTick;
using cell::CellWorkspace;
using cell::CellWorld;
using cell::describe_warnings;
using cell::Failure;
using cell::FailureKind;
using cell::find_depth_failure;
using cell::Simulation;
using cell::SimulationOptions;
using cell::SolverMonitor;

SimulationOptions simulation_of(const model::Scenario& scenario, const RunOptions& options) {
  SimulationOptions simulation = options.simulation;
  if (!simulation.cup) simulation.cup = cup_for(scenario, options.corrections);
  return simulation;
}

class ProgramRun {
 public:
  ProgramRun(const model::Scenario& scenario, const RunOptions& options)
      : options_(options),
        simulation_(scenario, options.sequence, simulation_of(scenario, options)),
        plan_(simulation_.prepare(corrected(scenario, *options.program, options.corrections))),
        state_(simulation_.make_state()),
        work_(simulation_.make_workspace(options.threads)) {
    if (scenario.initial_state) {
      throw InputError(
          scenario.source_name, "initial_state", "with a program",
          "none: recordings do not contain the state of controller and gripper; only scenes can be resumed");
    }
    recorder_.emplace(simulation_, recording_of(options));
  }

  RunResult run() {
    const auto start = std::chrono::steady_clock::now();
    RunResult result;
    while (!result.failure && !is_stopped_) {
      if (advance(result.failure)) break;
      if (options_.until && simulation_.time(state_) >= *options_.until) break;
      if (simulation_.time(state_) > motion::kLongestProgram)
        result.failure = {FailureKind::TooLong, "the program did not end within two hours"};
    }
    result.duration = simulation_.time(state_);
    const double settled = result.duration + motion::kSettleTime;
    while (!result.failure && !is_stopped_ && !options_.until && simulation_.time(state_) < settled) {
      (void)advance(result.failure);
    }
    simulation_.end_touches(state_);
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    result.wall = wall.count();
    result.real_time_factor = simulation_.time(state_) / result.wall;
    fill_result(simulation_, state_, work_, result);
    result.is_interrupted = is_stopped_;
    recorder_->close(state_, options_.describe ? options_.describe(result) : "", result.is_interrupted);
    return result;
  }

 private:
  [[nodiscard]] RecorderSetup recording_of(const RunOptions& options) const {
    RecorderSetup setup;
    setup.path = options.record_path;
    setup.file = options.record_file;
    setup.observer = options.observer;
    setup.program_text = options.program_text;
    setup.program_name = options.program->name;
    setup.version = options.version;
    setup.settings_json = settings_json(simulation_.options(), options.corrections);
    return setup;
  }

  /// One controller tick. Returns whether the program ended at its start.
  bool advance(Failure& failure) {
    const CellTick tick = simulation_.advance(plan_, state_, work_);
    failure = tick.failure;
    for (record::Event& event : work_.solver.take_events(simulation_.world())) state_.event_log.note(std::move(event));
    is_stopped_ = !recorder_->add(tick, state_, work_);
    return tick.has_ended;
  }

  const RunOptions& options_;
  Simulation simulation_;
  motion::PreparedProgram plan_;
  CellState state_;
  CellWorkspace work_;
  std::optional<TickRecorder> recorder_;
  bool is_stopped_ = false;  ///< by the observer
};

}  // namespace

void fill_contacts(const CellWorld& world, const physics::WorldState& state, const SolverMonitor& monitor,
                   RunResult& result) {
  result.solver = monitor.summary(world);
  result.warnings = describe_warnings(result.solver);
  if (!result.failure) result.failure = find_depth_failure(result.solver);
  const auto name_of = [&world](physics::BodyId id) {
    return world.model.bodies[static_cast<std::size_t>(id.index)].name;
  };
  for (const physics::ContactReport& contact : physics::bearing_contacts(world.model, state)) {
    result.contacts.push_back({name_of(contact.a), name_of(contact.b), contact.p_WQ, contact.n_AB_W, contact.force_W,
                               contact.phi, contact.slides});
  }
}

RunResult run_program(const model::Scenario& scenario, const RunOptions& options) {
  return ProgramRun(scenario, options).run();
}

}  // namespace snug::runs::internal
