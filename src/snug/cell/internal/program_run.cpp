// ProgramRun: a program executed in the cell, recorded, and what became of every box.
#include "snug/cell/internal/program_run.hpp"

#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "snug/cell/corrected.hpp"

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
        work_(simulation_.make_workspace()) {
    if (!options.record_path.empty() || options.observer != nullptr) start_recording();
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
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    result.wall = wall.count();
    result.real_time_factor = simulation_.time(state_) / result.wall;
    fill(result);
    if (recorder_) recorder_->close(options_.describe ? options_.describe(result) : "");
    return result;
  }

 private:
  void start_recording() {
    RecorderSetup setup;
    setup.path = options_.record_path;
    setup.observer = options_.observer;
    setup.period = simulation_.scenario().controller.tick;
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
    is_stopped_ = !recorder_->add_frame(simulation_.world(), state_.world, work_.physics, tick.step, input);
  }

  void fill(RunResult& result) const {
    result.solver = work_.solver.summary();
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
  bool is_stopped_ = false;  ///< by the observer
};

}  // namespace

RunResult run_program(const model::Scenario& scenario, const RunOptions& options) {
  return ProgramRun(scenario, options).run();
}

}  // namespace snug::cell::internal
