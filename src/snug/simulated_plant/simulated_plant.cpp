// SimulatedPlant: a cell drawn from a scenario's uncertainty by a seed of its own, behind the interface of a plant.
#include "snug/simulated_plant/simulated_plant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/cell/rest_watch.hpp"
#include "snug/core/input_error.hpp"
#include "snug/cup/phases.hpp"
#include "snug/perception/camera_perception.hpp"

namespace snug::simulated_plant {

model::Scenario draw_plant(const model::Scenario& scenario, const std::string& sequence, std::uint64_t seed) {
  const model::Scenario nominal = cell::with_fixed_arrivals(scenario, sequence);
  return seed == 0 ? nominal : cell::draw_scenario(nominal, sequence, Rng(seed).split("plant"));
}

SimulatedPlant::SimulatedPlant(const model::Scenario& scenario, const std::string& sequence,
                               const SimulatedPlantOptions& options)
    : options_(options),
      simulation_(
          with_objects(draw_plant(model::with_values(scenario, options.set, "--plant-set"), sequence, options.seed),
                       options.faults),
          sequence, options.simulation),
      state_(simulation_.make_state()),
      work_(simulation_.make_workspace()),
      objects_(simulation_, options.faults, options.seed),
      perception_(perception::make_perception(options.perception, options.seed, scenario)),
      was_brought_(simulation_.sequence().items.size(), false) {
  read_sensors({}, {});
}

plant::Description SimulatedPlant::describe() const {
  plant::Description description;
  description.name =
      options_.seed == 0 ? "simulated, as the scenario says" : fmt::format("simulated, plant seed {}", options_.seed);
  if (simulation_.arm() != nullptr) {
    for (const robot::Joint& joint : simulation_.arm()->model().joints) description.joints.push_back(joint.name);
  }
  return description;
}

Pose SimulatedPlant::X_WE() const {
  return state_.arm ? state_.arm->machine.tool.X_WE : state_.controller.command.X_WE;
}

int SimulatedPlant::item_of(const std::string& id) const {
  const auto& items = simulation_.sequence().items;
  const auto found = std::ranges::find(items, id, &model::Item::parcel);
  return found == items.end() ? -1 : static_cast<int>(found - items.begin());
}

bool SimulatedPlant::bring(const std::string& item) {
  const int index = item_of(item);
  if (index < 0 || was_brought_[static_cast<std::size_t>(index)]) return false;
  calls_.push_back({Call::Kind::Bring, item, {}, tick_ ? *passed_ : -1});
  was_brought_[static_cast<std::size_t>(index)] = true;
  simulation_.bring(index, state_);
  if (!tick_) {
    begin_item(index);
    return true;
  }
  arrived_ = index;
  tick_();
  return true;
}

void SimulatedPlant::begin_item(int index) {
  state_.gripper.least_hold_factor = std::numeric_limits<double>::infinity();
  witness_.begin();
  current_ = index;
  arrived_ = -1;
  pending_ = {};
  ++brought_count_;
  for (const Fault& fault : options_.faults) {
    if (fault.item != brought_count_) continue;
    pending_.no_seal |= fault.kind == FaultKind::NoSeal;
    pending_.drop |= fault.kind == FaultKind::Drop;
    pending_.stop |= fault.kind == FaultKind::Stop;
    pending_.displace |= fault.kind == FaultKind::Displace;
    pending_.push |= fault.kind == FaultKind::Push;
    objects_due_ += fault.kind == FaultKind::Object ? 1 : 0;
    clear_is_due_ |= fault.kind == FaultKind::Clear;
  }
}

void SimulatedPlant::acknowledge() {
  calls_.push_back({Call::Kind::Acknowledge, {}, {}, -1});
  if (is_stopped_) simulation_.acknowledge(work_, state_);
  is_stopped_ = false;
}

perception::Observation SimulatedPlant::perceive(std::span<const perception::Expectation> expected) {
  perception::Scene scene;
  scene.time = simulation_.time(state_);
  scene.X_WE = X_WE();
  const cell::CellWorld& world = simulation_.world();
  for (std::size_t i = 0; i < world.parcels.size(); ++i) {
    const physics::BodyId body = world.parcels[i];
    if (!state_.world.bodies[static_cast<std::size_t>(body.index)].is_present) continue;
    const std::string& id = simulation_.sequence().items[i].parcel;
    const model::Scenario& scenario = simulation_.scenario();
    scene.boxes.push_back({id, physics::pose_of(world.model, state_.world, body),
                           model::collision_size(scenario, *model::find_parcel(scenario, id))});
  }
  for (const ForeignObject& one : objects_.objects()) {
    if (one.is_in)
      scene.objects.push_back({one.name, physics::pose_of(world.model, state_.world, one.body), kForeignSize});
  }
  return perception_->perceive(scene, expected);
}

void SimulatedPlant::read_sensors(const plant::MotionWatch& course, const plant::End& end) {
  feedback_ = {};
  feedback_.time = simulation_.time(state_);
  feedback_.end = end;
  feedback_.X_WE = X_WE();
  feedback_.V_WE = state_.arm ? state_.arm->machine.tool.V_WE : state_.controller.command.V_WE;
  if (state_.arm) {
    const auto& joints = state_.arm->machine.joints;
    feedback_.q.assign(joints.q.begin(), joints.q.end());
    feedback_.qd.assign(joints.qd.begin(), joints.qd.end());
    for (const record::JointSample& joint : work_.arm.joints) feedback_.torques.push_back(joint.torque);
    feedback_.torques.resize(feedback_.q.size(), 0.0);
  }
  feedback_.pressure_gauge = state_.gripper.cup.pressure_gauge;
  feedback_.F_E = simulation_.tool_load(state_, work_);
  feedback_.peak_force = std::max(course.peak_force, feedback_.F_E.force.norm());
  feedback_.peak_torque = std::max(course.peak_torque, feedback_.F_E.torque.norm());
  feedback_.io = state_.controller.io;
  feedback_.times = course.times;
}

plant::TickReading SimulatedPlant::reading() const {
  const Wrench F_E = simulation_.tool_load(state_, work_);
  const double pressure = state_.gripper.cup.pressure_gauge;
  return {simulation_.time(state_), F_E, pressure, state_.controller.io.vacuum,
          cup::sensed_hold_factor(simulation_.scenario().cup, pressure, F_E)};
}

bool SimulatedPlant::advance(const plant::Motion& motion, const motion::PreparedProgram& plan,
                             plant::MotionWatch& course) {
  if (simulation_.is_at_end(plan, state_)) return false;
  const cell::CellTick tick = simulation_.advance(plan, state_, work_);
  objects_.watch(state_, work_);
  const auto row = static_cast<std::size_t>(std::max(0, tick.row));
  witness_.follow(simulation_, state_, work_, plan.program.waypoints[row], plan.settings.tick);
  course.follow(tick.row, simulation_.time(state_), state_.controller.phase == motion::ControllerPhase::Waiting);
  if (watcher_) watcher_(tick);
  inject(plan, course);
  course.check(
      motion.guards,
      simulation_.scenario().motion_guards.needed_vacuum * simulation_.scenario().cup.vacuum.pressure_gauge_hold,
      reading());
  if (!state_.controller.io.vacuum) state_.gripper.cannot_seal = false;
  if (tick.failure.kind == cell::FailureKind::ProtectiveStop) {
    const cell::ProtectiveStop& stop = *work_.arm.stop;
    course.end = {plant::EndReason::ProtectiveStop, tick.row, stop.value, stop.limit,
                  std::string(name_of(stop.cause)) + " of " + stop.where};
  } else if (tick.failure) {
    fail(tick, course);
  }
  is_stopped_ |= course.end.reason == plant::EndReason::ProtectiveStop;
  return course.end.reason == plant::EndReason::Completed;
}

/// The simulation cannot go on.
void SimulatedPlant::fail(const cell::CellTick& tick, plant::MotionWatch& course) {
  course.end = {plant::EndReason::Fault, tick.row, 0.0, 0.0, tick.failure.text};
  has_failed_ = true;
}

void SimulatedPlant::settle(const motion::PreparedProgram& plan, plant::MotionWatch& course, Until until) {
  const settings::MotionGuards& guards = simulation_.scenario().motion_guards;
  const double start = simulation_.time(state_);
  cell::RestWatch rest(start);
  const auto speed = [this] {
    return (state_.arm ? state_.arm->machine.tool.V_WE : state_.controller.command.V_WE).linear.norm();
  };
  const bool is_fast = motion::is_fast(options_.simulation.tracking);
  const auto has_to_wait = [&](double now) {
    return until == Until::BoxesRest && now < start + guards.longest_settle && !rest.is_at_rest(now);
  };
  const double at_least = plant::least_settle(guards, !is_fast, was_passed_ && until == Until::ToolStands);
  while (plant::is_settling(guards, at_least, start, simulation_.time(state_), speed()) ||
         has_to_wait(simulation_.time(state_))) {
    const cell::CellTick tick = simulation_.advance(plan, state_, work_);
    rest.follow(simulation_, state_);
    objects_.watch(state_, work_);
    if (watcher_) watcher_(tick);
    if (!tick.failure) continue;
    if (tick.failure.kind != cell::FailureKind::ProtectiveStop)
      fail(tick, course);  // a stop now: the tool was where it was to come
    break;
  }
  course.rest(simulation_.time(state_));
}

plant::Feedback SimulatedPlant::submit(const plant::Motion& motion, const plant::OnPassing& passing) {
  calls_.push_back({Call::Kind::Submit, {}, motion, passing.act ? passing.waypoint : -1});
  const auto refuse = [&](const std::string& why) {
    read_sensors({}, {plant::EndReason::Refused, -1, 0.0, 0.0, why});
    return feedback_;
  };
  if (is_stopped_) return refuse("a protective stop is not acknowledged");
  if (has_failed_) return refuse("the plant has failed");
  const std::string refusal = plant::find_refusal(motion);
  if (!refusal.empty()) return refuse(refusal);
  motion::PreparedProgram plan;
  try {
    plan = simulation_.prepare({"motion", motion.waypoints});
  } catch (const InputError& error) {
    return refuse(error.what());
  }
  if (arrived_ >= 0) begin_item(arrived_);
  simulation_.begin_motion(state_);
  witness_.stand();
  plant::MotionWatch course;
  course.settings = simulation_.scenario().motion_guards;
  course.begin(reading(), state_.gripper.cup.body >= 0);
  passed_ = passing.act ? std::optional(passing.waypoint) : std::nullopt;
  was_passed_ = false;
  bool goes_on = true;
  while (goes_on && advance(motion, plan, course)) {
    if (!passed_ || was_passed_ || course.row <= *passed_) continue;
    was_passed_ = true;
    tick_ = [&] { goes_on = goes_on && advance(motion, plan, course); };
    passing.act();
    tick_ = nullptr;
  }
  passed_.reset();
  if (course.end.reason == plant::EndReason::Completed) {
    course.end.waypoint = static_cast<int>(motion.waypoints.size()) - 1;
    settle(plan, course);
    inject(plan, course);
  }
  simulation_.stand(state_);
  read_sensors(course, course.end);
  return feedback_;
}

}  // namespace snug::simulated_plant
