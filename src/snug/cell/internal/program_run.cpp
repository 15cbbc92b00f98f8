// ProgramRun: a program executed tick by tick in the cell.
#include "snug/cell/internal/program_run.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <utility>

#include "snug/cell/aligner_feed.hpp"
#include "snug/core/hash.hpp"
#include "snug/core/input_error.hpp"
#include "snug/motion/corrections.hpp"

namespace snug::cell::internal {
namespace {

constexpr double kLongestProgram = 7200.0;  ///< s
constexpr double kSettleTime = 1.0;         ///< s, after the last waypoint, for boxes that still move

const model::Sequence& sequence_of(const model::Scenario& scenario, const std::string& name) {
  if (const model::Sequence* sequence = model::find_sequence(scenario, name)) return *sequence;
  std::vector<std::string> names;
  for (const model::Sequence& sequence : scenario.sequences) names.push_back(sequence.name);
  throw InputError(scenario.source_name, "--sequence", "'" + name + "'",
                   "one of " + fmt::format("{}", fmt::join(names, ", ")));
}

motion::Program corrected(const model::Scenario& scenario, const RunOptions& options) {
  if (options.corrections.empty()) return *options.program;
  const model::CorrectionLayer* layer = model::find_correction_layer(scenario, options.corrections);
  if (layer == nullptr) {
    std::vector<std::string> names{"none"};
    for (const model::CorrectionLayer& known : scenario.controller.correction_layers) names.push_back(known.name);
    throw InputError(scenario.source_name, "--corrections", "'" + options.corrections + "'",
                     "one of " + fmt::format("{}", fmt::join(names, ", ")));
  }
  std::vector<motion::Correction> corrections;
  for (const model::Correction& correction : layer->corrections) {
    corrections.push_back({correction.prefixes, correction.offset});
  }
  return motion::apply_corrections(*options.program, corrections);
}

motion::PreparedProgram plan_of(const model::Scenario& scenario, const model::Sequence& sequence,
                                const RunOptions& options) {
  motion::ControllerSettings settings;
  settings.kind = options.controller;
  settings.tick = scenario.controller.tick;
  settings.task_stiffness = sequence.task_stiffness.value_or(scenario.controller.task_stiffness);
  settings.vacuum_wait = scenario.controller.vacuum_wait;
  settings.convergence_deg_per_metre = scenario.controller.convergence_deg_per_metre;
  for (const model::MoveLimits& limits : scenario.controller.limits) {
    settings.limits.push_back({limits.prefix,
                               {limits.precision, limits.max_acceleration, limits.max_speed, limits.max_turn_speed,
                                limits.max_turn_acceleration}});
  }
  return motion::prepare(corrected(scenario, options), std::move(settings));
}

int substeps_of(const model::Scenario& scenario) {
  const double ratio = scenario.controller.tick / scenario.time_step;
  const double whole = std::round(ratio);
  if (whole < 1.0 || std::abs(ratio - whole) > 1e-9 * ratio) {
    throw InputError(scenario.source_name, "time_step", fmt::format("{}", scenario.time_step),
                     fmt::format("a whole fraction of the controller's tick, {} s", scenario.controller.tick));
  }
  return static_cast<int>(whole);
}

class ProgramRun {
 public:
  ProgramRun(const model::Scenario& scenario, const RunOptions& options)
      : scenario_(scenario),
        options_(options),
        sequence_(sequence_of(scenario, options.sequence)),
        plan_(plan_of(scenario, sequence_, options)),
        substeps_(substeps_of(scenario)),
        world_(build_world(scenario, {&sequence_, true})),
        state_(make_initial_state(scenario, world_)),
        work_(world_.model),
        controller_(motion::make_controller_state(scenario.controller.X_WE_start)),
        gripper_(scenario.cup, options.cup, world_),
        journey_(scenario, sequence_, world_) {
    if (!options.record_path.empty() || options.observer != nullptr) start_recording();
  }

  RunResult run() {
    const auto start = std::chrono::steady_clock::now();
    RunResult result;
    while (result.failure.empty() && !is_stopped_) {
      const bool finished_now = advance_tick(result.failure);
      if (finished_now) break;
      if (options_.until && state_.time(world_.model) >= *options_.until) break;
      if (state_.time(world_.model) > kLongestProgram) result.failure = "the program did not end within two hours";
    }
    result.duration = state_.time(world_.model);
    const double settled = result.duration + kSettleTime;
    while (result.failure.empty() && !is_stopped_ && !options_.until && state_.time(world_.model) < settled) {
      (void)advance_tick(result.failure);
    }
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    result.wall = wall.count();
    result.real_time_factor = state_.time(world_.model) / result.wall;
    fill(result);
    if (recorder_) recorder_->close(options_.describe ? options_.describe(result) : "");
    return result;
  }

 private:
  void start_recording() {
    RecorderSetup setup;
    setup.path = options_.record_path;
    setup.observer = options_.observer;
    setup.period = scenario_.controller.tick;
    setup.program_text = options_.program_text;
    setup.program_name = options_.program->name;
    setup.sequence = options_.sequence;
    setup.version = options_.version;
    setup.settings_json = fmt::format(R"({{"cup": "{}", "controller": "{}", "corrections": "{}"}})",
                                      options_.cup == cup::CupMode::Holding ? "holding" : "phases",
                                      options_.controller == motion::ControllerKind::Faithful ? "faithful" : "ideal",
                                      options_.corrections.empty() ? "none" : options_.corrections);
    recorder_ = std::make_unique<Recorder>(scenario_, world_, setup);
  }

  /// Where the cup will be when the vacuum comes on next: the pick that a departure leads to.
  [[nodiscard]] std::optional<Vector3> next_pick(int row) const {
    const auto& rows = plan_.program.waypoints;
    for (auto i = static_cast<std::size_t>(row) + 1; i < rows.size(); ++i) {
      if (rows[i].io.vacuum) return rows[i - 1].X_WE.p;
    }
    return std::nullopt;
  }

  /// A box appears when the program starts toward it; one that was left there is taken away.
  void depart(int row) {
    const std::string& name = plan_.program.waypoints[static_cast<std::size_t>(row)].name;
    const int item = find_item(sequence_, name, "PrePick");
    if (item < 0) return;
    const physics::BodyId body = world_.parcels[static_cast<std::size_t>(item)];
    if (state_.bodies[static_cast<std::size_t>(body.index)].is_present) return;
    const double now = state_.time(world_.model);
    if (waiting_item_ >= 0 && grip_.cup.body != world_.parcels[static_cast<std::size_t>(waiting_item_)].index) {
      physics::set_present(state_, world_.parcels[static_cast<std::size_t>(waiting_item_)], false);
      journey_.box_removed(waiting_item_, now);
    }
    physics::set_present(state_, body, true);
    physics::set_pose(world_.model, state_, body,
                      pose_at_aligner(scenario_, sequence_.items[static_cast<std::size_t>(item)], next_pick(row)));
    physics::set_twist(world_.model, state_, body, Twist{});
    waiting_item_ = item;
    journey_.box_appeared(item, now);
  }

  /// One controller tick and its physics steps. Returns whether the program ended at its start.
  bool advance_tick(std::string& failure) {
    const motion::ToolState start = controller_.command;
    const motion::ControllerOutput out = motion::tick(plan_, start, controller_);
    if (out.departed >= 0) depart(out.departed);
    const cup::CupCommand command{out.io.vacuum, out.io.blow_off};
    motion::ToolState tool = start;
    for (int k = 0; k < substeps_ && failure.empty(); ++k) {
      const motion::ToolState next =
          k + 1 == substeps_ ? out.tool
                             : motion::interpolate(start, out.tool, plan_.settings.tick,
                                                   static_cast<double>(k + 1) / static_cast<double>(substeps_));
      advance_step(tool, next, command, out.row, failure);
      tool = next;
    }
    if (recorder_) {
      const FrameInput input{tool.X_WE, tool.V_WE, out.X_WE_reference, out.row, &grip_, command};
      for (; recorded_events_ < journey_.events().size(); ++recorded_events_) {
        recorder_->add_event(journey_.events()[recorded_events_]);
      }
      if (!recorder_->add_frame(world_, state_, work_, report_, input)) is_stopped_ = true;
    }
    return out.finished_now;
  }

  void advance_step(const motion::ToolState& tool, const motion::ToolState& next, const cup::CupCommand& command,
                    int row, std::string& failure) {
    events_.clear();
    gripper_.prepare(state_, tool.X_WE, tool.V_WE, command, world_.model.settings.dt, grip_, grip_step_, events_);
    const std::string& waypoint = plan_.program.waypoints[static_cast<std::size_t>(std::max(0, row))].name;
    for (const GripperEvent& event : events_) {
      journey_.add(event, state_.time(world_.model), state_, tool.X_WE, waypoint);
      if (waiting_item_ >= 0 && event.kind == GripperEvent::Kind::Seal &&
          event.body == world_.parcels[static_cast<std::size_t>(waiting_item_)].index) {
        waiting_item_ = -1;
      }
    }
    const physics::KinematicTarget target{world_.tool, next.X_WE};
    physics::ElementUse use{grip_step_.element, world_.tool, Pose{}, physics::BodyId{grip_step_.body}};
    physics::WorldInput input;
    input.kinematic = {&target, 1};
    if (grip_step_.element != nullptr) input.elements = {&use, 1};
    input.held = physics::BodyId{grip_step_.ignored};
    report_ = physics::step(world_.model, input, state_, work_);
    monitor_.add(report_);
    failure = describe_failure(world_, state_, work_, report_);
  }

  void fill(RunResult& result) const {
    result.solver = monitor_.summary();
    result.boxes = journey_.results(state_, grip_.cup.body);
    result.events = journey_.events();
    result.repicks = journey_.repicks();
    std::vector<std::string> packed;
    for (const BoxResult& box : result.boxes) {
      if (box.state == BoxState::Packed) packed.push_back(box.id);
    }
    if (const model::Container* container = model::find_container(scenario_, scenario_.target)) {
      result.filling_degree_percent = model::compute_filling_degree_percent(scenario_, *container, packed);
    }
    Hash hash;
    hash.add(physics::hash_of(state_));
    hash.add(grip_.cup.pressure_gauge);
    hash.add(static_cast<std::uint64_t>(controller_.row + 1));
    result.state_hash = hash.value();
  }

  const model::Scenario& scenario_;
  const RunOptions& options_;
  const model::Sequence& sequence_;
  motion::PreparedProgram plan_;
  int substeps_;
  CellWorld world_;
  physics::WorldState state_;
  physics::Workspace work_;
  motion::ControllerState controller_;
  Gripper gripper_;
  GripperState grip_;
  GripperStep grip_step_;
  Journey journey_;
  std::unique_ptr<Recorder> recorder_;
  std::size_t recorded_events_ = 0;
  bool is_stopped_ = false;  ///< by the observer
  int waiting_item_ = -1;
  std::vector<GripperEvent> events_;
  physics::StepReport report_;
  StepMonitor monitor_;
};

}  // namespace

void StepMonitor::add(const physics::StepReport& report) {
  ++summary_.steps;
  summary_.worst_residual = std::max(summary_.worst_residual, report.residual);
  summary_.worst_penetration = std::max(summary_.worst_penetration, report.worst_penetration);
  if (report.status == physics::StepStatus::NotConverged) ++summary_.not_converged;
  if (report.contacts == 0) return;
  ++steps_with_contacts_;
  sweeps_ += report.sweeps;
}

SolverSummary StepMonitor::summary() const {
  SolverSummary summary = summary_;
  if (steps_with_contacts_ > 0) {
    summary.mean_sweeps = static_cast<double>(sweeps_) / static_cast<double>(steps_with_contacts_);
  }
  return summary;
}

std::string describe_failure(const CellWorld& world, const physics::WorldState& state, const physics::Workspace& work,
                             const physics::StepReport& report) {
  if (report.status == physics::StepStatus::Converged || report.status == physics::StepStatus::NotConverged) return "";
  if (report.status == physics::StepStatus::TooManyPairs) {
    return fmt::format("t = {:.3f} s: more pairs of bodies near each other than there is room for",
                       state.time(world.model));
  }
  std::string text =
      fmt::format("t = {:.3f} s: {} of body '{}'", state.time(world.model),
                  report.status == physics::StepStatus::NotFinite ? "the state is not a number any more" : "lost track",
                  world.model.bodies[static_cast<std::size_t>(report.culprit.index)].name);
  for (const physics::ContactReport& contact : work.contacts()) {
    if (contact.a != report.culprit && contact.b != report.culprit) continue;
    text += fmt::format("; contact {} - {} at ({:.4f}, {:.4f}, {:.4f}), gap {:.3g} m, force {:.3g} N",
                        world.model.bodies[static_cast<std::size_t>(contact.a.index)].name,
                        world.model.bodies[static_cast<std::size_t>(contact.b.index)].name, contact.p_WQ.x(),
                        contact.p_WQ.y(), contact.p_WQ.z(), contact.phi, contact.force_W.norm());
  }
  return text;
}

RunResult run_program(const model::Scenario& scenario, const RunOptions& options) {
  if (!scenario.tool) throw InputError(scenario.source_name, "tool", "", "a tool, to run a program");
  if (!scenario.aligner) throw InputError(scenario.source_name, "aligner", "", "an aligner, to run a program");
  return ProgramRun(scenario, options).run();
}

}  // namespace snug::cell::internal
