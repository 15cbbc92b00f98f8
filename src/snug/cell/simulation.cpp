// Simulation: the cell of a scenario under way, tick by tick; any state of it can be kept, copied and gone back to.
#include "snug/cell/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/cell/aligner_feed.hpp"
#include "snug/cell/held_swing.hpp"
#include "snug/cell/scene_input.hpp"
#include "snug/core/check.hpp"
#include "snug/core/hash.hpp"
#include "snug/core/input_error.hpp"
#include "snug/cup/phases.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::cell {
namespace {

int substeps_of(const model::Scenario& scenario) {
  const double ratio = scenario.controller.tick / scenario.time_step;
  const double whole = std::round(ratio);
  if (whole < 1.0 || std::abs(ratio - whole) > 1e-9 * ratio) {
    throw InputError(scenario.source_name, "time_step", fmt::format("{}", scenario.time_step),
                     fmt::format("a whole fraction of the controller's tick, {} s", scenario.controller.tick));
  }
  return static_cast<int>(whole);
}

// Shares of the vacuum's set point: from the first on the box is lifted, below the second the tool leaves it.
constexpr double kSealed = 0.5;        // 0.7 when the cup has stretched so far that it carries the box
constexpr double kFullySealed = 0.97;  // 3.5 time constants of drawing vacuum
constexpr double kReleased = 0.05;     // 3 time constants of losing it

/// The arm that the options ask for, or none. The tool then starts where the arm's joints put it, and the scenario's
/// robot is as fast as the controller lets it be.
std::unique_ptr<CellArm> make_arm(model::Scenario& scenario, const model::Sequence& sequence,
                                  const SimulationOptions& options) {
  const std::string& name = options.robot;
  if (name.empty()) return nullptr;
  if (!scenario.robot || scenario.robot->name != name) {
    throw InputError(
        scenario.source_name, "--robot", "'" + name + "'",
        scenario.robot ? "'" + scenario.robot->name + "', the robot of the scenario" : "a scenario with a robot");
  }
  limit_joint_speeds(scenario, options.tracking);
  auto arm = std::make_unique<CellArm>(scenario, sequence.task_stiffness.value_or(scenario.controller.task_stiffness));
  scenario.controller.X_WE_start = robot::forward_tool(arm->model(), arm->start());
  return arm;
}

/// Joints under torque through a tick, one physics step after the other.
class TorqueSteps {
 public:
  TorqueSteps(const CellArm& arm, const control::DriveCommand* command, const control::JointMotion& start, double dt)
      : arm_(arm), command_(command), dt_(dt), start_(start), now_(start) {
    if (command == nullptr) return;
    any_ = std::find(command->kinds.begin(), command->kinds.end(), control::DriveKind::Torque) != command->kinds.end();
  }
  [[nodiscard]] bool any() const { return any_; }
  /// Puts where they are at the end of the next step into `now`, where the other joints are.
  void step(const OutsideDrive& outside, control::JointMotion& now) {
    if (!any_) return;
    ++steps_;
    control::JointMotion at = now;
    for_each([&](Eigen::Index j) {
      at.q[j] = now_.q[j];
      at.qd[j] = now_.qd[j];
    });
    const robot::JointVector qdd = arm_.driven_accelerations(*command_, at, outside);
    for_each([&](Eigen::Index j) {
      now.qd[j] = now_.qd[j] += dt_ * qdd[j];
      now.q[j] = now_.q[j] += dt_ * now_.qd[j];
      now.qdd[j] = (now_.qd[j] - start_.qd[j]) / (dt_ * steps_);
    });
  }

 private:
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t j = 0; j < command_->kinds.size(); ++j) {
      if (command_->kinds[j] == control::DriveKind::Torque) visit(static_cast<Eigen::Index>(j));
    }
  }

  const CellArm& arm_;
  const control::DriveCommand* command_;
  double dt_;
  control::JointMotion start_, now_;
  int steps_ = 0;
  bool any_ = false;
};

/// The scenario itself, once it is known that programs can run in it.
model::Scenario runnable(model::Scenario scenario) {
  if (!scenario.tool) throw InputError(scenario.source_name, "tool", "", "a tool, to run a program");
  if (!scenario.aligner) throw InputError(scenario.source_name, "aligner", "", "an aligner, to run a program");
  return scenario;
}

}  // namespace

const model::Sequence& require_sequence(const model::Scenario& scenario, const std::string& name) {
  if (const model::Sequence* sequence = model::find_sequence(scenario, name)) return *sequence;
  std::vector<std::string> names;
  for (const model::Sequence& sequence : scenario.sequences) names.push_back(sequence.name);
  throw InputError(scenario.source_name, "--sequence", "'" + name + "'",
                   "one of " + fmt::format("{}", fmt::join(names, ", ")));
}

motion::PreparedProgram prepare(const model::Scenario& scenario, const model::Sequence& sequence,
                                const SimulationOptions& options, motion::Program program) {
  const model::ControllerParams& params = scenario.controller;
  motion::ControllerSettings settings;
  settings.tracking = options.tracking;
  if (motion::is_fast(options.tracking)) {
    if (turns_gently(scenario, sequence)) settings.fast.held = settings.fast.held_gently;
    settings.fast.held.window = held_swing_window(scenario, sequence).value_or(settings.fast.held.window);
    settings.fast.pan_axis = find_pan_axis(scenario);
  }
  settings.fast.sealed_pressure = kSealed * scenario.cup.vacuum.pressure_gauge_hold;
  settings.fast.fully_sealed_pressure = kFullySealed * scenario.cup.vacuum.pressure_gauge_hold;
  settings.fast.released_pressure = kReleased * scenario.cup.vacuum.pressure_gauge_hold;
  settings.tick = params.tick;
  settings.task_stiffness = sequence.task_stiffness.value_or(params.task_stiffness);
  settings.vacuum_wait = params.vacuum_wait;
  settings.convergence_deg_per_metre = params.convergence_deg_per_metre;
  // A scenario without limits has the defaults for every name.
  for (const model::MoveLimits& limits : params.limits.empty() ? std::vector(1, model::MoveLimits{}) : params.limits) {
    settings.limits.push_back({limits.prefix,
                               {limits.precision, limits.max_acceleration, limits.max_speed, limits.max_turn_speed,
                                limits.max_turn_acceleration}});
  }
  return motion::prepare(std::move(program), std::move(settings));
}

Simulation::Simulation(model::Scenario scenario, const std::string& sequence, const SimulationOptions& options)
    : scenario_(runnable(std::move(scenario))),
      options_(options),
      sequence_(require_sequence(scenario_, sequence)),
      substeps_(substeps_of(scenario_)),
      arm_(make_arm(scenario_, sequence_, options)),
      world_(build_world(scenario_, arm_ ? WorldOptions{&sequence_, true, &arm_->model(), arm_->start()}
                                         : WorldOptions{&sequence_, true, nullptr, {}})),
      gripper_(scenario_, options.cup.value_or(cup::CupMode::Phases), world_) {
  if (arm_) arm_->attach(world_);
  if (motion::is_fast(options.tracking)) pace_ = make_joint_pace(scenario_, motion::tempo_of(options.tracking));
}

CellState Simulation::make_state() const {
  CellState state;
  state.world = make_initial_state(scenario_, world_);
  state.controller = motion::make_controller_state(scenario_.controller.X_WE_start);
  state.event_log = ItemEventLog(scenario_, sequence_);
  if (arm_) state.arm = arm_->make_state(scenario_.seed);
  return state;
}

motion::PreparedProgram Simulation::prepare(motion::Program program) const {
  motion::PreparedProgram plan = cell::prepare(scenario_, sequence_, options_, std::move(program));
  plan.path_limits = pace_.get();
  return plan;
}

/// What the controller is told at the start of the next tick.
void Simulation::feel(const motion::PreparedProgram& plan, CellState& state, const CellWorkspace& work) const {
  if (!motion::is_fast(plan.settings.tracking)) return;
  const double pressure = state.gripper.cup.pressure_gauge;
  const Wrench F_E = tool_load(state, work);
  state.controller.sensed = {pressure, tool_of(state).X_WE.R * F_E.force,
                             cup::sensed_hold_factor(scenario_.cup, pressure, F_E)};
}

ArmReading Simulation::read_still(const CellState& state) const {
  SNUG_CHECK(arm_ != nullptr && state.arm, "a cell with a robot, to read its arm");
  ArmState arm = *state.arm;
  ArmLoads loads;
  ArmReading reading;
  arm_->read(world_, {}, time(state), loads, arm, reading);
  return reading;
}

/// A box appears when the program starts toward it; one that was left there is taken away.
void Simulation::depart(const motion::PreparedProgram& plan, int row, CellState& state) const {
  const motion::Waypoint& waypoint = plan.program.waypoints[static_cast<std::size_t>(row)];
  const int item = waypoint.motion_class == motion::MotionClass::PrePick ? find_item(sequence_, waypoint) : -1;
  if (item < 0) return;
  const std::optional<Pose> X_WE_pick = next_pick(plan.program, row);
  (void)feed(item, choose_quarter(scenario_, sequence_.items[static_cast<std::size_t>(item)], X_WE_pick), state);
}

bool Simulation::feed(int item, int quarter, CellState& state) const {
  return feed(item, pose_at_aligner(scenario_, sequence_.items[static_cast<std::size_t>(item)], quarter), state);
}

bool Simulation::feed(int item, const Pose& X_WP, CellState& state) const {
  const physics::BodyId body = world_.parcels[static_cast<std::size_t>(item)];
  if (state.world.bodies[static_cast<std::size_t>(body.index)].is_present) return false;
  const double now = time(state);
  if (state.waiting_item >= 0) {
    const physics::BodyId waiting = world_.parcels[static_cast<std::size_t>(state.waiting_item)];
    if (state.gripper.cup.body != waiting.index) {
      physics::set_present(state.world, waiting, false);
      state.event_log.box_removed(state.waiting_item, now);
    }
  }
  place(body, X_WP, state);
  state.waiting_item = item;
  state.event_log.box_appeared(item, now);
  return true;
}

CellTick Simulation::advance(const motion::PreparedProgram& plan, CellState& state, CellWorkspace& work) const {
  const motion::ToolState start = tool_of(state);
  control::JointState joints;
  control::MachineTick machine;
  motion::ControllerOutput out;
  if (arm_) {
    joints = state.arm->machine.joints;
    machine = arm_->tick(plan, state.controller, *state.arm, work.joints);
    out = machine.program;
  } else {
    out = motion::tick(plan, start, state.controller);
  }
  if (out.departed >= 0) depart(plan, out.departed, state);
  CellTick tick;
  tick.has_ended = out.finished_now;
  tick.row = out.row;
  tick.tool = start;
  tick.X_WE_reference = out.X_WE_reference;
  tick.command = {out.io.vacuum, out.io.blow_off};
  const motion::Waypoint& waypoint = plan.program.waypoints[static_cast<std::size_t>(std::max(0, out.row))];
  if (!arm_) {
    advance_tool(&waypoint, start, out.tool, state, work, tick);
    feel(plan, state, work);
    return tick;
  }
  const ArmTask task{out.row, &waypoint, machine.outcome == control::Outcome::Stuck, machine.joints};
  advance_arm(task, joints, {joints.qd, state.arm->machine.joints.qdd}, state, work, tick);
  feel(plan, state, work);
  return tick;
}

CellTick Simulation::advance(const OutsideCommand& command, CellState& state, CellWorkspace& work) const {
  SNUG_CHECK(arm_ != nullptr && command.joints.target.allFinite() &&
                 command.joints.target.size() == arm_->model().joint_count() &&
                 static_cast<int>(command.joints.kinds.size()) == arm_->model().joint_count(),
             "joints that are driven need finite targets");
  control::MachineState& machine = state.arm->machine;
  const control::JointMotion start = machine.joints;
  const control::JointWay way =
      arm_->controller().drive().follow(command.joints, state.arm->outside.position_before, machine.joints);
  CellTick tick;
  tick.tool = machine.tool;
  tick.command = command.cup;
  ArmTask task;
  task.outside = &command.joints;
  advance_arm(task, start, way, state, work, tick);
  tick.X_WE_reference = tick.tool.X_WE;
  return tick;
}

CellTick Simulation::advance(const ToolCommand& command, CellState& state, CellWorkspace& work) const {
  SNUG_CHECK(arm_ == nullptr && command.tool.X_WE.p.allFinite() && command.tool.X_WE.R.allFinite(),
             "a tool that is led moves by itself, to a finite pose");
  CellTick tick;
  tick.tool = state.controller.command;
  tick.command = command.cup;
  advance_tool(nullptr, tick.tool, command.tool, state, work, tick);
  state.controller.command = tick.tool;
  tick.X_WE_reference = tick.tool.X_WE;
  return tick;
}

void Simulation::advance_tool(const motion::Waypoint* waypoint, const motion::ToolState& start,
                              const motion::ToolState& end, CellState& state, CellWorkspace& work,
                              CellTick& tick) const {
  for (int k = 0; k < substeps_ && !tick.failure; ++k) {
    const motion::ToolState next =
        k + 1 == substeps_ ? end
                           : motion::interpolate(start, end, scenario_.controller.tick,
                                                 static_cast<double>(k + 1) / static_cast<double>(substeps_));
    work.targets.assign(1, {world_.tool, next.X_WE});
    advance_step(waypoint, tick.tool, state, work, tick);
    tick.tool = next;
  }
}

/// The joints' accelerations are constant over the tick, those of joints under torque over a step: so are the ways of
/// tool and links.
void Simulation::advance_arm(const ArmTask& task, const control::JointMotion& start, const control::JointWay& way,
                             CellState& state, CellWorkspace& work, CellTick& tick) const {
  control::JointMotion& end = state.arm->machine.joints;
  TorqueSteps torque(*arm_, task.outside, start, scenario_.controller.tick / substeps_);
  ArmLoads loads;
  for (int k = 0; k < substeps_ && !tick.failure; ++k) {
    const bool is_last = k + 1 == substeps_;
    const double elapsed = scenario_.controller.tick * static_cast<double>(k + 1) / static_cast<double>(substeps_);
    control::JointMotion now = end;
    if (!is_last) {
      now.q = start.q + elapsed * (way.v + 0.5 * elapsed * way.a);
      now.qd = way.v + elapsed * way.a;
    }
    torque.step(state.arm->outside, now);
    if (is_last) end = now;
    const robot::ArmPose at = robot::forward(arm_->model(), now.q);
    arm_->aim(world_, at, work.targets);
    advance_step(task.waypoint, tick.tool, state, work, tick);
    const robot::JointVector before = torque.any() ? arm_->torques_of(at, loads) : robot::JointVector();
    arm_->add_loads(world_, state.world, work.physics, state.gripper, at, loads);
    if (torque.any()) state.arm->outside.torques_felt = arm_->torques_of(at, loads) - before;
    const Vector6 V_WE = robot::tool_jacobian(arm_->model(), at) * now.qd;
    tick.tool = {at.X_WE, twist_from(V_WE)};
  }
  if (task.outside != nullptr) state.arm->machine.tool = tick.tool;
  read_arm(task, loads, state, work, tick);
}

void Simulation::read_arm(const ArmTask& task, ArmLoads& loads, CellState& state, CellWorkspace& work,
                          CellTick& tick) const {
  arm_->read(world_, task, time(state), loads, *state.arm, work.arm);
  for (const ArmTouch& touch : work.arm.touches_begun) note_touch(touch, false, state);
  for (const ArmTouch& touch : work.arm.touches_ended) note_touch(touch, true, state);
  if (!work.arm.stop || tick.failure) return;
  end_touches(state);
  const ProtectiveStop& stop = *work.arm.stop;
  tick.failure = {FailureKind::ProtectiveStop, describe(stop)};
  state.event_log.note({time(state),
                        "protective_stop",
                        stop.where,
                        tick.failure.text,
                        {{"value", stop.value}, {"limit", stop.limit}, {"row", static_cast<double>(stop.row)}}});
}

void Simulation::note_touch(const ArmTouch& touch, bool has_ended, CellState& state) const {
  if (has_ended) {
    state.event_log.note({time(state),
                          "arm_contact_end",
                          name_of(world_, touch.other),
                          fmt::format("{} touched it with up to {:.0f} N", name_of(world_, touch.link), touch.force),
                          {{"force_N", touch.force}, {"began_s", touch.since}, {"ended_s", touch.last}}});
    return;
  }
  state.event_log.note(
      {time(state), "arm_contact", name_of(world_, touch.other), describe_touch(touch), {{"force_N", touch.force}}});
}

std::string Simulation::describe_touch(const ArmTouch& touch) const {
  return fmt::format("{} touches {} with {:.0f} N", name_of(world_, touch.link), name_of(world_, touch.other),
                     touch.force);
}

void Simulation::end_touches(CellState& state) const {
  if (!state.arm) return;
  for (const ArmTouch& touch : state.arm->touches) note_touch(touch, true, state);
  state.arm->touches.clear();
}

void Simulation::advance_step(const motion::Waypoint* waypoint, const motion::ToolState& tool, CellState& state,
                              CellWorkspace& work, CellTick& tick) const {
  work.events.clear();
  gripper_.prepare(state.world, tool.X_WE, tool.V_WE, tick.command, world_.model.settings.dt, state.gripper,
                   work.gripper, work.events);
  for (const GripperEvent& event : work.events) {
    state.event_log.add(event, time(state), world_, state.world, tool.X_WE,
                        waypoint != nullptr ? motion::name_of(*waypoint) : "");
    if (state.waiting_item >= 0 && event.kind == GripperEvent::Kind::Seal &&
        event.body == world_.parcels[static_cast<std::size_t>(state.waiting_item)].index) {
      state.waiting_item = -1;
    }
  }
  physics::WorldInput input;
  add_body_targets(scenario_, world_, time(state) + world_.model.settings.dt, work.targets);
  input.kinematic = work.targets;
  work.wrenches.clear();
  add_wrenches(scenario_, world_, state.world, work.wrenches);
  input.wrenches = work.wrenches;
  input.elements = work.gripper.uses;
  input.held = physics::BodyId{work.gripper.ignored};
  tick.step = physics::step(world_.model, input, state.world, work.physics);
  work.solver.add(tick.step, time(state));
  if (tick.step.status == physics::StepStatus::LostBody && tick.step.culprit.index != state.gripper.cup.body) {
    work.lost.push_back(take_lost(world_, state.world, tick.step.culprit));
    state.event_log.body_lost(event_of(work.lost.back()));
    return;
  }
  tick.failure = find_failure(world_, state.world, work.physics, tick.step);
}

bool Simulation::is_at_end(const motion::PreparedProgram& plan, const CellState& state) const {
  return motion::will_finish(plan, state.controller.command, state.controller);
}

std::vector<BoxResult> Simulation::boxes(const CellState& state) const {
  return state.event_log.results(world_, state.world, state.gripper.cup.body);
}

std::uint64_t Simulation::hash(const CellState& state) const {
  Hash hash;
  hash.add(physics::hash_of(state.world));
  hash.add(state.gripper.cup.pressure_gauge);
  if (state.arm) {
    for (const double q : state.arm->machine.joints.q) hash.add(q);
  }
  return hash.value();
}

}  // namespace snug::cell
