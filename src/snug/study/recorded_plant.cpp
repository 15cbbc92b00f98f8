// RecordedPlant: any plant, and beside it a recording of what it says: of a robot that no simulation knows all about.
#include "snug/study/recorded_plant.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/input_error.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/program_tracking.hpp"
#include "snug/robot/dynamics.hpp"
#include "snug/robot/load_arm.hpp"

namespace snug::study {
namespace {

runs::RecorderSetup recorder_setup(const cell::Simulation& simulation,
                                   const simulated_plant::LiveRecordingOptions& options) {
  runs::RecorderSetup setup;
  setup.file = options.file;
  setup.observer = options.observer;
  setup.period = simulation.scenario().controller.tick;
  setup.program_name = "pack";
  setup.program_grows = true;
  setup.sequence = simulation.sequence().name;
  setup.settings_json = options.settings_json;
  setup.version = options.version;
  if (simulation.arm() != nullptr) {
    for (const robot::Joint& joint : simulation.arm()->model().joints) setup.joints.push_back(joint.name);
  }
  return setup;
}

}  // namespace

RecordedPlant::RecordedPlant(plant::Plant& plant, const model::Scenario& scenario, const std::string& sequence,
                             const cell::SimulationOptions& options,
                             const simulated_plant::LiveRecordingOptions& recording)
    : plant_(plant),
      scenario_(scenario),
      simulation_(cell::with_fixed_arrivals(scenario, sequence), sequence, options),
      state_(simulation_.make_state()),
      work_(simulation_.make_workspace()),
      recorder_(simulation_.scenario(), simulation_.world(), recorder_setup(simulation_, recording)) {
  recorder_.append_program(motion::format_tracking(simulation_.options().tracking));
}

int RecordedPlant::find_item(const std::string& id) const {
  const auto& items = simulation_.sequence().items;
  const auto found = std::ranges::find(items, id, &model::Item::parcel);
  return found == items.end() ? -1 : static_cast<int>(found - items.begin());
}

void RecordedPlant::start(const plant::Motion& motion) {
  item_ = motion.item;
  row_ = 0;
  waypoint_count_ = next_count_;
  is_written_ = false;
  try {
    recorder_.append_program(motion::format_program({"motion", motion.waypoints}));
    is_written_ = true;
    next_count_ += static_cast<int>(motion.waypoints.size());
  } catch (const InputError&) {  // a motion that no file can keep: its frames belong to no waypoint
  }
  plant_.start(motion);
}

std::vector<plant::Event> RecordedPlant::advance() {
  std::vector<plant::Event> events = plant_.advance();
  const plant::Feedback now = plant_.read();
  move_to(now);
  for (const plant::Event& event : events) take(event, now);
  const double tick = simulation_.scenario().controller.tick;
  constexpr double kSameTick = 0.01;  ///< of a tick: rounding of times that add up
  if (now.time >= last_frame_ + (1.0 - kSameTick) * tick) add_frame(now);
  return events;
}

void RecordedPlant::take(const plant::Event& event, const plant::Feedback& now) {
  if (const auto* passed = plant::get<plant::WaypointPassed>(event)) row_ = passed->waypoint.value + 1;
  if (const auto* seen = plant::get<plant::Perceived>(event)) see(seen->observation, now.X_WE);
  if (plant::get<plant::VacuumBuilt>(event) != nullptr) hold(now.X_WE);
  if (plant::get<plant::VacuumDropped>(event) != nullptr && held_) {
    const int item = held_->item;
    held_.reset();
    state_.gripper.cup.body = -1;
    state_.event_log.note({now.time,
                           "hold lost",
                           simulation_.sequence().items[static_cast<std::size_t>(item)].parcel,
                           "the vacuum broke down",
                           {}});
  }
  const auto* arrived = plant::get<plant::ItemArrived>(event);
  const int item = arrived != nullptr ? find_item(arrived->item.value) : -1;
  const bool is_there = item >= 0 && state_.world.bodies[static_cast<std::size_t>(body_of(item).index)].is_present;
  if (item >= 0 && !is_there) simulation_.bring(item, state_);
}

void RecordedPlant::see(const perception::Observation& seen, const Pose& X_WE) {
  for (const perception::PoseEstimate& one : seen.seen) {
    const int item = find_item(one.item);
    if (item < 0) continue;
    physics::set_present(state_.world, body_of(item), true);
    physics::set_pose(simulation_.world().model, state_.world, body_of(item), one.X_WP);
    if (held_ && held_->item == item) held_->X_EP = X_WE.inverse() * one.X_WP;
  }
  for (const std::string& id : seen.missing) {
    const int item = find_item(id);
    if (item >= 0 && !(held_ && held_->item == item)) physics::set_present(state_.world, body_of(item), false);
  }
}

/// The box of the motion hangs from the cup, as it was believed to stand.
void RecordedPlant::hold(const Pose& X_WE) {
  const int item = find_item(item_.value);
  if (item < 0 || !state_.world.bodies[static_cast<std::size_t>(body_of(item).index)].is_present) return;
  const Pose X_WP = physics::pose_of(simulation_.world().model, state_.world, body_of(item));
  held_ = Held{item, X_WE.inverse() * X_WP};
  const Pose X_ES{Matrix3::Identity(), scenario_.cup.hold_length * Vector3::UnitZ()};
  state_.gripper.cup.body = body_of(item).index;
  state_.gripper.cup.X_PS = X_WP.inverse() * X_WE * X_ES;
  cell::GripperEvent sealed;
  sealed.kind = cell::GripperEvent::Kind::Seal;
  sealed.body = body_of(item).index;
  sealed.offset_P = state_.gripper.cup.X_PS.p;
  Eigen::Index along = 0;  // of the face's normal
  (void)state_.gripper.cup.X_PS.R.col(2).cwiseAbs().maxCoeff(&along);
  sealed.offset_P[along] = 0.0;
  sealed.length = scenario_.cup.hold_length;
  state_.event_log.add(sealed, simulation_.time(state_), simulation_.world(), state_.world, X_WE, "vacuum");
}

void RecordedPlant::let_go(const Pose& X_WE) {
  cell::GripperEvent released;
  released.kind = cell::GripperEvent::Kind::Released;
  released.body = body_of(held_->item).index;
  state_.event_log.add(released, simulation_.time(state_), simulation_.world(), state_.world, X_WE, "vacuum");
  state_.gripper.cup.body = -1;
  held_.reset();
}

void RecordedPlant::move_to(const plant::Feedback& now) {
  const physics::WorldModel& world = simulation_.world().model;
  state_.world.step_index = std::llround(now.time / scenario_.time_step);
  if (simulation_.arm() != nullptr && !now.q.empty()) {
    std::vector<physics::KinematicTarget> targets;
    simulation_.arm()->aim(simulation_.world(), robot::forward(simulation_.arm()->model(), robot::joint_vector(now.q)),
                           targets);
    for (const physics::KinematicTarget& target : targets)
      physics::set_pose(world, state_.world, target.body, target.X_WB_end);
  }
  physics::set_pose(world, state_.world, simulation_.world().tool, now.X_WE);
  state_.gripper.cup.pressure_gauge = now.pressure_gauge;
  if (!held_) return;
  physics::set_pose(world, state_.world, body_of(held_->item), now.X_WE * held_->X_EP);
  if (!now.io.vacuum) let_go(now.X_WE);
}

void RecordedPlant::add_frame(const plant::Feedback& now) {
  add_events();
  cell::ArmReading arm;
  const bool has_arm = simulation_.arm() != nullptr && !now.q.empty();
  if (has_arm) {
    for (std::size_t j = 0; j < now.q.size(); ++j)
      arm.joints.push_back(
          {now.q[j], j < now.qd.size() ? now.qd[j] : 0.0, j < now.torques.size() ? now.torques[j] : 0.0});
    const robot::ArmModel& model = simulation_.arm()->model();
    const int sensor = robot::find_link(model, scenario_.robot->sensor_frame);
    const robot::JointVector zero = robot::JointVector::Zero(model.joint_count());
    const Wrench load{now.X_WE.R * now.F_E.force, now.X_WE.R * now.F_E.torque};
    arm.F_sensor = robot::sensor_wrench(model, {robot::joint_vector(now.q), zero, zero}, sensor,
                                        robot::distal_inertia(model, sensor), load, scenario_.gravity);
  }
  const runs::FrameInput input{now.X_WE,
                               now.V_WE,
                               now.X_WE,
                               is_written_ && plant_.is_moving() ? waypoint_count_ + row_ : -1,
                               &state_.gripper,
                               {now.io.vacuum, now.io.blow_off},
                               has_arm ? &arm : nullptr};
  (void)recorder_.add_frame(simulation_.world(), state_.world, work_.physics, {}, input);
  last_frame_ = now.time;
}

void RecordedPlant::add_events() {
  const auto& own = state_.event_log.events();
  for (; own_ < own.size(); ++own_) events_.push_back(own[own_]);
  recorder_.add_events(events_);
}

void RecordedPlant::note(record::Event event) {
  add_events();
  events_.push_back(std::move(event));
}

void RecordedPlant::close(const simulated_plant::RecordingEnd& end, std::vector<cell::BoxResult> boxes) {
  add_events();
  runs::RunResult result;
  result.duration = simulation_.time(state_);
  result.boxes = std::move(boxes);
  std::vector<std::string> packed;
  for (const cell::BoxResult& box : result.boxes) {
    if (box.state == cell::BoxState::Packed) packed.push_back(box.id);
  }
  if (const model::Container* container = model::find_container(scenario_, scenario_.target))
    result.filling_degree_percent = model::compute_filling_degree_percent(scenario_, *container, packed);
  result.events = events_;
  result.repicks = state_.event_log.repicks();
  result.warnings = end.warnings;
  result.is_interrupted = end.is_interrupted;
  result.ended_by = end.ended_by;
  recorder_.close(end.describe ? end.describe(result) : "", end.is_interrupted);
}

}  // namespace snug::study
