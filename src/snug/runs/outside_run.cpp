// OutsideRun: the cell driven by a controller outside of it, tick by tick, recorded as any other run.
#include "snug/runs/outside_run.hpp"

#include <chrono>
#include <utility>

#include "snug/cell/aligner_feed.hpp"
#include "snug/core/check.hpp"
#include "snug/runs/internal/tick_recorder.hpp"

namespace snug::runs {
namespace {

using cell::ArmReading;
using cell::CellState;
using cell::CellTick;
using cell::CellWorkspace;
using cell::Failure;
using cell::FailureKind;
using cell::OutsideCommand;
using cell::pose_at_aligner;
using cell::Simulation;

RecorderSetup recording_of(const Simulation& simulation, const OutsideRunOptions& options) {
  RecorderSetup setup;
  setup.file = options.record_file;
  setup.observer = options.observer;
  setup.version = options.version;
  setup.settings_json = internal::settings_json(simulation.options(), "");
  return setup;
}

}  // namespace

struct OutsideRun::Impl {
  Impl(const Simulation& cell, const OutsideRunOptions& run_options)
      : simulation(cell),
        options(run_options),
        state(cell.make_state()),
        work(cell.make_workspace()),
        recorder(cell, recording_of(cell, run_options)) {
    SNUG_CHECK(cell.arm() != nullptr, "a cell with a robot, to be driven from outside");
  }

  const Simulation& simulation;
  OutsideRunOptions options;
  CellState state;
  CellWorkspace work;
  internal::TickRecorder recorder;
  CellTick last;
  bool is_stopped = false;
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
};

OutsideRun::OutsideRun(const Simulation& simulation, const OutsideRunOptions& options)
    : impl_(std::make_unique<Impl>(simulation, options)) {}
OutsideRun::~OutsideRun() = default;

const CellTick& OutsideRun::advance(const OutsideCommand& command) {
  Impl& run = *impl_;
  SNUG_CHECK(!run.last.failure, "a run that failed cannot continue");
  run.last = run.simulation.advance(command, run.state, run.work);
  for (record::Event& event : run.work.solver.take_events(run.simulation.world())) {
    run.state.event_log.note(std::move(event));
  }
  run.is_stopped = !run.recorder.add(run.last, run.state, run.work) || run.is_stopped;
  return run.last;
}

bool OutsideRun::feed(int item, int quarter) { return impl_->simulation.feed(item, quarter, impl_->state); }

void OutsideRun::bring(int item, int quarter) {
  Impl& run = *impl_;
  run.simulation.bring(item, run.state);
  const auto index = static_cast<std::size_t>(item);
  const Pose X_WP = pose_at_aligner(run.simulation.scenario(), run.simulation.sequence().items[index], quarter);
  physics::set_pose(run.simulation.world().model, run.state.world, run.simulation.world().parcels[index], X_WP);
}

void OutsideRun::stand() { impl_->simulation.stand(impl_->state); }

bool OutsideRun::is_stopped_for_protection() const { return impl_->last.failure.kind == FailureKind::ProtectiveStop; }

void OutsideRun::acknowledge() {
  if (!is_stopped_for_protection()) return;
  impl_->last.failure = {};
  impl_->simulation.acknowledge(impl_->work, impl_->state);
  stand();
}

double OutsideRun::time() const { return impl_->simulation.time(impl_->state); }
const CellState& OutsideRun::state() const { return impl_->state; }
const ArmReading& OutsideRun::reading() const { return impl_->work.arm; }
Wrench OutsideRun::tool_load() const { return impl_->simulation.tool_load(impl_->state, impl_->work); }
const Failure& OutsideRun::failure() const { return impl_->last.failure; }
bool OutsideRun::is_stopped() const { return impl_->is_stopped; }

RunResult OutsideRun::finish(const std::string& ended_by) {
  Impl& run = *impl_;
  run.simulation.end_touches(run.state);
  RunResult result;
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - run.start;
  result.duration = time();
  result.wall = wall.count();
  result.real_time_factor = result.duration / result.wall;
  result.failure = run.last.failure;
  result.is_interrupted = run.is_stopped;
  result.ended_by = ended_by;
  internal::fill_result(run.simulation, run.state, run.work, result);
  run.recorder.close(run.state, run.options.describe ? run.options.describe(result) : "", run.is_stopped);
  return result;
}

}  // namespace snug::runs
