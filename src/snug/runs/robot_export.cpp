// RobotExport: a program for the controller of a real robot, tried in its cell before.
#include "snug/runs/robot_export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "snug/cell/held_boxes.hpp"
#include "snug/control/program_export.hpp"
#include "snug/core/input_error.hpp"
#include "snug/cup/phases.hpp"
#include "snug/model/robot_io.hpp"
#include "snug/motion/fitted_limits.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/runs/corrected.hpp"

namespace snug::runs {
namespace {

/// Why nothing is exported, unless nothing is wrong.
std::string refuse(const char* what, const std::string& wrong) {
  if (wrong.empty()) return {};
  return fmt::format("not exported: {}: {} (--unchecked exports it anyway)", what, wrong);
}

RobotText refused(std::string refusal) { return {{}, {}, std::move(refusal)}; }

/// The part of a run from a waypoint on, which is gone to at rest: where the tool is highest on the path there from
/// what was let go before.
control::JointRun cut_run(const control::JointRun& run, std::size_t first_row, double tick) {
  if (first_row == 0) return run;
  const auto& samples = run.samples;
  std::size_t end = 0;
  while (end < samples.size() && samples[end].row < static_cast<int>(first_row)) ++end;
  while (end + 1 < samples.size() && !samples[end + 1].io.vacuum) ++end;
  std::size_t begin = end;
  while (begin > 0 && !samples[begin - 1].io.vacuum) --begin;
  std::size_t highest = begin;
  for (std::size_t i = begin; i <= end; ++i) {
    if (samples[i].tool.X_WE.p.z() > samples[highest].tool.X_WE.p.z()) highest = i;
  }
  std::size_t stop = highest + 1;  // the joints rest there: up to it the ramp may go
  while (stop < end && samples[stop].before.qd.norm() > control::kAlmostAtRest) ++stop;
  constexpr std::size_t kMostRamp = 60;
  const std::size_t ramp = std::min(kMostRamp, stop - highest);
  return ramp == 0 || highest + ramp >= samples.size() ? run : control::begin_at(run, highest, ramp, tick);
}

}  // namespace

model::RobotIo with_wiring(model::RobotIo io, const StandardWiring& wiring) {
  const auto standard = [](int number) { return model::DigitalIo{model::DigitalKind::Standard, number, false}; };
  if (wiring.vacuum_output) io.vacuum = standard(*wiring.vacuum_output);
  if (wiring.blow_off_output) io.blow_off = standard(*wiring.blow_off_output);
  if (wiring.vacuum_input) io.vacuum_reached = standard(*wiring.vacuum_input);
  if (wiring.part_input) io.part_present = standard(*wiring.part_input);
  if (io.blow_off && io.vacuum.bit() == io.blow_off->bit()) {
    throw InputError("command line", "--blow-off-output", fmt::format("output {}", io.vacuum.number),
                     "another output than --vacuum-output");
  }
  if (io.vacuum_reached && io.part_present && io.vacuum_reached->bit() == io.part_present->bit()) {
    throw InputError("command line", "--part-input", fmt::format("input {}", io.part_present->number),
                     "another input than --vacuum-input");
  }
  return io;
}

RobotExport::RobotExport(const model::Scenario& scenario, const std::string& sequence, const motion::Program& program,
                         cell::SimulationOptions how, RobotExportSettings settings)
    : settings_(std::move(settings)),
      simulation_(scenario, sequence,
                  [&] {
                    if (!scenario.robot) throw InputError(scenario.source_name, "robot", "", "a scenario with a robot");
                    how.cup = cup_for(scenario, settings_.corrections);
                    how.robot = scenario.robot->name;
                    return how;
                  }()),
      plan_(simulation_.prepare(corrected(scenario, program, settings_.corrections))) {
  if (!settings_.is_unchecked) trial_ = try_motion(simulation_, plan_);
}

/// `done`: the motion that is written, as simulated or fitted to that.
control::RobotProgram RobotExport::for_robot(const motion::PreparedProgram& done, bool is_ur) const {
  const robot::ArmModel& arm = simulation_.arm()->model();
  const std::string layer = settings_.corrections.empty() ? "" : ", corrections " + settings_.corrections;
  const std::string tempo = is_fast() ? fmt::format(", tempo {}", motion::tempo_of(plan_.settings.tracking)) : "";
  // The flange's frame as UR, ROS-Industrial and others name it.
  const bool has_tool0 = robot::find_link(arm, "tool0") >= 0;
  return {.plan = done,
          .arm = arm,
          .q_start = simulation_.arm()->start(),
          .loads = find_loads(),
          .notes = {fmt::format("snug {}", settings_.version),
                    fmt::format("program {}, {} waypoints{}{}", settings_.program_name, plan_.program.waypoints.size(),
                                layer, tempo),
                    fmt::format("scenario {}, sequence {}, robot {}", simulation_.scenario().name,
                                simulation_.sequence().name, arm.name)},
          .flange = is_ur || has_tool0 ? "tool0" : simulation_.scenario().robot->flange_frame};
}

/// The program for a robot that follows exactly: the same waypoints with speeds and accelerations of the simulated
/// motion.
motion::PreparedProgram RobotExport::fitted() const {
  motion::PreparedProgram exact = plan_;
  exact.row_limits = motion::fit_limits(exact, X_WE_start());
  exact.settings.tracking = motion::ExactTracking{};
  return exact;
}

/// What the cup holds on the path to each waypoint, as far as they tell; warns of what they do not tell.
std::vector<std::optional<control::CarriedLoad>> RobotExport::find_loads() const {
  std::vector<std::optional<control::CarriedLoad>> loads;
  cell::HeldBoxes boxes(simulation_.scenario(), simulation_.sequence());
  const std::vector<motion::Waypoint>& waypoints = plan_.program.waypoints;
  bool was_unknown = false;
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    boxes.depart(plan_.program, static_cast<int>(i), i > 0 ? plan_.X_WE[i - 1] : X_WE_start());
    loads.emplace_back();
    if (const std::optional<cell::HeldBox>& held = boxes.held()) {
      const std::string& id = simulation_.sequence().items[static_cast<std::size_t>(held->item)].parcel;
      const SpatialInertia& inertia = model::find_parcel(simulation_.scenario(), id)->inertia;
      const Matrix3& R_EP = held->X_EP.R;
      loads.back() = {inertia.mass, held->X_EP * inertia.com, R_EP * inertia.inertia * R_EP.transpose()};
    }
    if (boxes.is_unknown() && !was_unknown && settings_.warn) {
      settings_.warn(fmt::format("waypoint {} ({}): no known box of sequence {} is held: payload of the gripper alone",
                                 i + 1, motion::name_of(waypoints[i]), simulation_.sequence().name));
    }
    was_unknown = boxes.is_unknown();
  }
  return loads;
}

/// Empty where the program, tried in the scenario's cell, does not stop there and packs every box that it picks, and
/// where it was not tried.
std::string RobotExport::find_refusal() const {
  return trial_ ? refuse("it does not succeed in the simulated cell", find_loss(*trial_)) : std::string();
}

/// Empty where a robot that follows the waypoints of `fitted` exactly does not do worse in the cell than was simulated.
/// How far a box that is let go may be from where the simulation puts it is not checked: that it stays packed is.
std::string RobotExport::find_refusal_of(const motion::PreparedProgram& fitted) const {
  if (!trial_) return {};
  cell::SimulationOptions exact = simulation_.options();
  exact.tracking = motion::ExactTracking{};
  const cell::Simulation follower(simulation_.scenario(), simulation_.sequence().name, exact);
  return refuse("a robot that follows exactly does not repeat the simulation",
                compare_trials(*trial_, try_motion(follower, fitted)));
}

/// The program through the joints, or why the robot cannot do it.
RobotExport::Run RobotExport::find_run() const {
  const cell::CellArm& arm = *simulation_.arm();
  if (is_fast()) {
    if (std::string refusal = find_refusal(); !refusal.empty()) return {{}, std::move(refusal)};
  }
  control::JointRun run = is_fast() && trial_ ? trial_->joints
                                              : control::run_joints(plan_, arm.controller(),
                                                                    control::make_demonstrator_machine(), arm.start());
  if (!run.is_complete) {
    const auto stuck = static_cast<std::size_t>(std::max(0, run.stuck_row));
    return {{},
            fmt::format("the robot does not reach waypoint {} ({}): snug check says why", stuck + 1,
                        motion::name_of(plan_.program.waypoints[stuck]))};
  }
  std::string refusal = is_fast() ? std::string() : find_refusal();
  if (!refusal.empty()) return {{}, std::move(refusal)};
  return {std::move(run), {}};
}

RobotText RobotExport::of_run(const std::function<std::string(const control::JointRun&)>& format) const {
  const Run run = find_run();
  if (!run.joints) return refused(run.refusal);
  return {format(*run.joints),
          fmt::format("{} waypoints, {:.1f} s", plan_.program.waypoints.size(),
                      static_cast<double>(run.joints->samples.size()) * plan_.settings.tick),
          {}};
}

/// The first waypoint of the box with which the program is to begin.
std::size_t RobotExport::find_first_row(const std::string& from) const {
  if (from.empty()) return 0;
  const std::vector<motion::Waypoint>& waypoints = plan_.program.waypoints;
  std::vector<std::string> picked;
  for (const model::Item& item : simulation_.sequence().items) {
    const auto is_its = [&](const motion::Waypoint& waypoint) {
      const bool is_before =
          waypoint.motion_class == motion::MotionClass::PrePick || waypoint.motion_class == motion::MotionClass::Pick;
      return is_before && motion::fit_of(waypoint, item.parcel) > 0;
    };
    const auto first = std::ranges::find_if(waypoints, is_its);
    if (first == waypoints.end()) continue;
    if (item.parcel == from) return static_cast<std::size_t>(first - waypoints.begin());
    picked.push_back(item.parcel);
  }
  const std::string_view nearest = find_nearest(from, picked);
  throw InputError("command line", "--from-box", "'" + from + "'",
                   fmt::format("a box that the program picks: {}{}", fmt::join(picked, ", "),
                               nearest.empty() ? "" : fmt::format("; nearest is '{}'", nearest)));
}

RobotText RobotExport::moves(const control::UrScriptOptions& script_options) const {
  const motion::PreparedProgram moves = is_fast() ? plan_ : fitted();
  control::RobotProgram program = for_robot(moves, true);
  program.simulated_duration = motion::compute_duration(plan_, X_WE_start());
  control::UrScript script = control::format_urscript(program, script_options);
  std::string refusal = find_refusal();
  if (refusal.empty() && !is_fast()) refusal = find_refusal_of(moves);
  if (!refusal.empty()) return refused(std::move(refusal));
  return {std::move(script.text),
          fmt::format("{} moves, {:.1f} s nominal from stop to stop; {:.1f} s simulated, with a controller that lags "
                      "behind",
                      script.moves, script.nominal_duration, script.simulated_duration),
          {}};
}

RobotText RobotExport::targets(const control::UrScriptOptions& script_options) const {
  const Run run = find_run();
  if (!run.joints) return refused(run.refusal);
  const control::JointRun part = cut_run(*run.joints, script_options.first_row, plan_.settings.tick);
  control::UrServoScript script = control::format_servo_urscript(part, for_robot(plan_, true), script_options);
  std::string summary =
      fmt::format("{} knots, {:.0f} kB; {:.1f} s and waits for the vacuum; {:.1f} s simulated", script.knots,
                  static_cast<double>(script.text.size()) / 1e3, script.followed_duration, script.simulated_duration);
  return {std::move(script.text), std::move(summary), {}};
}

RobotText RobotExport::urscript(control::UrScriptOptions script, const std::string& from) const {
  script.pressure_reached = cup::kEstablishedVacuum * simulation_.scenario().cup.vacuum.pressure_gauge_hold;
  script.first_row = find_first_row(from);
  return is_fast() && !script.is_dry ? targets(script) : moves(script);
}

RobotText RobotExport::ros_trajectory(double period) const {
  return of_run([&](const control::JointRun& run) {
    return control::format_ros_trajectory(run, for_robot(plan_, false), period);
  });
}

RobotText RobotExport::log_csv() const {
  return of_run([&](const control::JointRun& run) {
    return control::format_log_csv(control::make_log(run, simulation_.arm()->model(), simulation_.scenario().gravity));
  });
}

RobotText RobotExport::log_flat() const {
  return of_run([&](const control::JointRun& run) {
    return control::format_log_flat(control::make_log(run, simulation_.arm()->model(), simulation_.scenario().gravity));
  });
}

}  // namespace snug::runs
