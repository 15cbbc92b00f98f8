// ProgramRun: a program executed in the cell, recorded, and what became of every box.
#include "snug/cell/internal/program_run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "snug/cell/corrected.hpp"
#include "snug/core/input_error.hpp"

namespace snug::cell::internal {
namespace {

constexpr double kLongestProgram = 7200.0;  ///< s
constexpr double kSettleTime = 1.0;         ///< s, after the last waypoint, for boxes that still move

class ProgramRun {
 public:
  ProgramRun(const model::Scenario& scenario, const RunOptions& options)
      : options_(options),
        simulation_(scenario, options.sequence, options.simulation),
        plan_(simulation_.prepare(corrected(scenario, *options.program, options.corrections))),
        state_(simulation_.make_state()),
        work_(simulation_.make_workspace(options.threads)) {
    if (scenario.initial_state) {
      throw InputError(scenario.source_name, "initial_state", "with a program",
                       "none: recordings do not hold where controller and gripper are; only scenes go on from one");
    }
    const double period = scenario.record_period.value_or(scenario.controller.tick);
    ticks_a_frame_ = std::max<std::int64_t>(1, std::llround(period / scenario.controller.tick));
    if (is_recorded(options)) start_recording();
  }

  RunResult run() {
    const auto start = std::chrono::steady_clock::now();
    RunResult result;
    while (result.failure.empty() && !is_stopped_) {
      if (advance(result.failure)) break;
      if (options_.until && simulation_.time(state_) >= *options_.until) break;
      if (simulation_.time(state_) > kLongestProgram) result.failure = "the program did not end within two hours";
    }
    result.duration = simulation_.time(state_);
    const double settled = result.duration + kSettleTime;
    while (result.failure.empty() && !is_stopped_ && !options_.until && simulation_.time(state_) < settled) {
      (void)advance(result.failure);
    }
    simulation_.end_touches(state_);
    if (recorder_) recorder_->add_events(state_.journey.events());
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    result.wall = wall.count();
    result.real_time_factor = simulation_.time(state_) / result.wall;
    fill(result);
    result.is_interrupted = is_stopped_;
    if (recorder_) recorder_->close(options_.describe ? options_.describe(result) : "", result.is_interrupted);
    return result;
  }

 private:
  void start_recording() {
    RecorderSetup setup;
    setup.path = options_.record_path;
    setup.file = options_.record_file;
    setup.observer = options_.observer;
    setup.period = simulation_.scenario().controller.tick * static_cast<double>(ticks_a_frame_);
    setup.program_text = options_.program_text;
    setup.program_name = options_.program->name;
    setup.sequence = options_.sequence;
    setup.version = options_.version;
    const auto or_none = [](const std::string& name) { return name.empty() ? "none" : name; };
    const bool is_holding = options_.simulation.cup == cup::CupMode::Holding;
    const bool is_faithful = options_.simulation.controller == motion::ControllerKind::Faithful;
    const nlohmann::ordered_json settings = {{"cup", is_holding ? "holding" : "phases"},
                                             {"controller", is_faithful ? "faithful" : "ideal"},
                                             {"corrections", or_none(options_.corrections)},
                                             {"robot", or_none(options_.simulation.robot)}};
    setup.settings_json = settings.dump();
    if (const CellArm* arm = simulation_.arm()) {
      for (const robot::Joint& joint : arm->model().joints) setup.joints.push_back(joint.name);
    }
    recorder_ = std::make_unique<Recorder>(simulation_.scenario(), simulation_.world(), setup);
  }

  /// One controller tick. Returns whether the program ended at its start.
  bool advance(std::string& failure) {
    const CellTick tick = simulation_.advance(plan_, state_, work_);
    failure = tick.failure;
    for (record::Event& event : work_.solver.take_events(simulation_.world())) state_.journey.note(std::move(event));
    if (recorder_) record(tick);
    return tick.has_ended;
  }

  void record(const CellTick& tick) {
    recorder_->add_events(state_.journey.events());
    const FrameInput input{tick.tool.X_WE,
                           tick.tool.V_WE,
                           tick.X_WE_reference,
                           tick.row,
                           &state_.gripper,
                           tick.command,
                           simulation_.arm() != nullptr ? &work_.arm : nullptr};
    if (++ticks_ % ticks_a_frame_ != 0 && tick.failure.empty()) return;
    is_stopped_ = !recorder_->add_frame(simulation_.world(), state_.world, work_.physics, tick.step, input);
  }

  void fill(RunResult& result) const {
    fill_contacts(simulation_.world(), state_.world, work_.solver, result);
    result.lost = work_.lost;
    result.boxes = simulation_.boxes(state_);
    result.events = state_.journey.events();
    result.repicks = state_.journey.repicks();
    std::vector<std::string> packed;
    for (const BoxResult& box : result.boxes) {
      if (box.state == BoxState::Packed) packed.push_back(box.id);
    }
    const model::Scenario& scenario = simulation_.scenario();
    if (const model::Container* container = model::find_container(scenario, scenario.target)) {
      result.filling_degree_percent = model::compute_filling_degree_percent(scenario, *container, packed);
    }
    result.state_hash = simulation_.hash(state_);
    if (simulation_.arm() != nullptr) result.stop = work_.arm.stop;
  }

  const RunOptions& options_;
  Simulation simulation_;
  motion::PreparedProgram plan_;
  CellState state_;
  CellWorkspace work_;
  std::unique_ptr<Recorder> recorder_;
  std::int64_t ticks_a_frame_ = 1;
  std::int64_t ticks_ = 0;
  bool is_stopped_ = false;  ///< by the observer
};

}  // namespace

void fill_contacts(const CellWorld& world, const physics::WorldState& state, const SolverMonitor& monitor,
                   RunResult& result) {
  result.solver = monitor.summary(world);
  result.warnings = describe_warnings(result.solver);
  if (result.failure.empty()) result.failure = describe_depths(result.solver);
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

}  // namespace snug::cell::internal
