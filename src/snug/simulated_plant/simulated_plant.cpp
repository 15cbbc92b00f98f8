// SimulatedPlant: a cell drawn from a scenario's uncertainty by a seed of its own, behind the interface of a plant.
#include "snug/simulated_plant/simulated_plant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/core/input_error.hpp"
#include "snug/cup/phases.hpp"
#include "snug/perception/camera_perception.hpp"
#include "snug/simulated_plant/live_recording.hpp"

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
      was_brought_(simulation_.sequence().items.size(), false),
      runner_(plant::runner_settings(simulation_.scenario(), !motion::is_fast(options.simulation.tracking))) {
  if (options.taken_up) take_up(*options.taken_up);
  feedback_ = sensors();
}

void SimulatedPlant::take_up(const TakenUp& begin) {
  cell::CellAnchor anchor;
  anchor.X_WE = X_WE();
  for (const auto& [id, X_WP] : begin.boxes) {
    const int item = item_of(id.value);
    if (item < 0) throw InputError("--resume", "item", "'" + id.value + "'", "an item of the sequence");
    anchor.boxes.push_back({item, X_WP});
    was_brought_[static_cast<std::size_t>(item)] = true;
  }
  state_ = simulation_.take_up(anchor);
  for (const cell::CellAnchor::Box& box : anchor.boxes) state_.event_log.box_was_placed(box.item);
  state_.world.step_index = std::llround(begin.time / simulation_.world().model.settings.dt);
  brought_count_ = begin.brought;
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

double SimulatedPlant::tool_speed() const {
  return (state_.arm ? state_.arm->machine.tool.V_WE : state_.controller.command.V_WE).linear.norm();
}

bool SimulatedPlant::bring(const model::ParcelId& item) {
  const int index = item_of(item.value);
  if (index < 0 || was_brought_[static_cast<std::size_t>(index)]) return false;
  if (coming_) feed();  // one that comes in the same tick, before it
  was_brought_[static_cast<std::size_t>(index)] = true;
  coming_ = index;
  if (!is_moving()) feed();
  return true;
}

void SimulatedPlant::feed() {
  const int index = *std::exchange(coming_, std::nullopt);
  simulation_.bring(index, state_);
  if (is_moving()) {
    arrived_ = index;
  } else {
    begin_item(index);
  }
  const std::string& id = simulation_.sequence().items[static_cast<std::size_t>(index)].parcel;
  runner_.add({time(), plant::ItemArrived{model::ParcelId(id)}});
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
  if (is_stopped_) simulation_.acknowledge(work_, state_);
  is_stopped_ = false;
}

void SimulatedPlant::perceive(std::span<const perception::Expectation> expected) {
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
  runner_.add({scene.time, plant::Perceived{perception_->perceive(scene, expected)}});
}

plant::Feedback SimulatedPlant::sensors() const {
  plant::Feedback fed;
  fed.time = time();
  fed.X_WE = X_WE();
  fed.V_WE = state_.arm ? state_.arm->machine.tool.V_WE : state_.controller.command.V_WE;
  if (state_.arm) {
    const auto& joints = state_.arm->machine.joints;
    fed.q.assign(joints.q.begin(), joints.q.end());
    fed.qd.assign(joints.qd.begin(), joints.qd.end());
    for (const record::JointSample& joint : work_.arm.joints) fed.torques.push_back(joint.torque);
    fed.torques.resize(fed.q.size(), 0.0);
  }
  fed.pressure_gauge = state_.gripper.cup.pressure_gauge;
  fed.F_E = simulation_.tool_load(state_, work_);
  fed.io = state_.controller.io;
  return fed;
}

plant::Feedback SimulatedPlant::read() {
  if (!is_moving()) return feedback_;
  plant::Feedback now = sensors();
  now.end = feedback_.end;
  runner_.fill(now);
  return now;
}

plant::TickReading SimulatedPlant::reading() const {
  const Wrench F_E = simulation_.tool_load(state_, work_);
  const double pressure = state_.gripper.cup.pressure_gauge;
  return {simulation_.time(state_), F_E, pressure, state_.controller.io.vacuum,
          cup::sensed_hold_factor(simulation_.scenario().cup, pressure, F_E)};
}

void SimulatedPlant::start(const plant::Motion& motion) {
  if (recording_ != nullptr) recording_->begin_motion(motion.waypoints);
  const auto refuse = [&](std::string why) {
    feedback_ = sensors();
    runner_.refuse(std::move(why), feedback_);
  };
  if (is_stopped_) return refuse("a protective stop is not acknowledged");
  if (has_failed_) return refuse("the plant has failed");
  const std::string refusal = plant::MotionRunner::find_refusal(motion);
  if (!refusal.empty()) return refuse(refusal);
  try {
    plan_ = simulation_.prepare({"motion", motion.waypoints});
  } catch (const InputError& error) {
    return refuse(error.what());
  }
  if (arrived_ >= 0) begin_item(arrived_);
  simulation_.begin_motion(state_);
  witness_.stand();
  runner_.begin(motion, reading(), state_.gripper.cup.body >= 0);
}

std::vector<plant::Event> SimulatedPlant::advance() {
  if (is_moving() && !runner_.has_events()) step();
  return runner_.take_events();
}

void SimulatedPlant::cancel() {
  if (!is_moving()) return;
  runner_.stop(plant::EndReason::Cancelled);
  end_motion();
}

/// Also where the program ended while boxes that a fault had moved came to rest.
bool SimulatedPlant::is_at_end() const {
  return simulation_.is_at_end(plan_, state_) || state_.controller.phase == motion::ControllerPhase::Finished;
}

void SimulatedPlant::step() {
  if (rest_) return step_rest();
  if (runner_.phase() == plant::MotionPhase::Following && is_at_end()) runner_.arrive(time());
  if (runner_.phase() == plant::MotionPhase::Settling && runner_.is_settled(time(), tool_speed())) {
    return finish_settling();
  }
  tick();
}

cell::CellTick SimulatedPlant::advance_cell() {
  if (coming_) feed();
  last_tick_ = simulation_.advance(plan_, state_, work_);
  objects_.watch(state_, work_);
  return *last_tick_;
}

void SimulatedPlant::tick() {
  const cell::CellTick tick = advance_cell();
  if (runner_.phase() == plant::MotionPhase::Settling) {
    if (recording_ != nullptr) recording_->add_tick();
    if (!tick.failure) return;
    if (tick.failure.kind != cell::FailureKind::ProtectiveStop) fail(tick);
    return finish_settling();  // after a stop, too: the tool was where it was to come
  }
  const int waypoint = std::max(0, tick.row);
  witness_.follow(simulation_, state_, work_, plan_.program.waypoints[static_cast<std::size_t>(waypoint)],
                  plan_.settings.tick);
  runner_.follow(
      {motion::WaypointIndex(waypoint), time(), state_.controller.phase == motion::ControllerPhase::Waiting});
  if (recording_ != nullptr) recording_->add_tick();
  inject();
  if (!rest_) finish_tick(tick);
}

void SimulatedPlant::finish_tick(const cell::CellTick& tick) {
  runner_.check(reading());
  if (!state_.controller.io.vacuum) state_.gripper.cannot_seal = false;
  if (tick.failure.kind == cell::FailureKind::ProtectiveStop) {
    const cell::ProtectiveStop& stop = *work_.arm.stop;
    runner_.stop(plant::EndReason::ProtectiveStop, stop.value, stop.limit,
                 std::string(name_of(stop.cause)) + " of " + stop.where);
  } else if (tick.failure) {
    fail(tick);
  }
  if (runner_.has_ended()) end_motion();
}

/// The simulation cannot go on.
void SimulatedPlant::fail(const cell::CellTick& tick) {
  runner_.stop(plant::EndReason::Fault, 0.0, 0.0, tick.failure.text);
  has_failed_ = true;
}

void SimulatedPlant::finish_settling() {
  runner_.rest(time());
  inject();
  if (!rest_) end_motion();
}

void SimulatedPlant::end_motion() {
  if (coming_) feed();
  if (rest_ && rest_->has_objects) objects_.note_rest();
  rest_.reset();
  const plant::End& end = runner_.end();
  const bool has_stopped = end.reason == plant::EndReason::ProtectiveStop;
  if (has_stopped || end.reason == plant::EndReason::Fault) {
    runner_.add({time(), plant::FaultRaised{end.reason, end.where}});
  }
  is_stopped_ = is_stopped_ || has_stopped;
  simulation_.stand(state_);
  feedback_ = sensors();
  runner_.finish(feedback_);
}

void SimulatedPlant::begin_rest(bool has_objects) {
  rest_ = Rest{time(), cell::RestWatch(time()), has_objects, *last_tick_};
}

void SimulatedPlant::step_rest() {
  const settings::MotionGuards& guards = runner_.settings().guards;
  const double at_least = runner_.settings().is_lagged ? guards.lagged_settle : guards.exact_settle;
  const double now = time();
  const bool is_settling = now <= rest_->start + at_least || tool_speed() >= guards.still_speed;
  bool goes_on = now < rest_->start + guards.longest_settle && (is_settling || !rest_->boxes.is_at_rest(now));
  if (goes_on) {
    const cell::CellTick tick = advance_cell();
    rest_->boxes.follow(simulation_, state_);
    if (recording_ != nullptr) recording_->add_tick();
    if (!tick.failure) return;
    if (tick.failure.kind != cell::FailureKind::ProtectiveStop) fail(tick);
  }
  runner_.rest(time());
  if (rest_->has_objects) objects_.note_rest();
  const cell::CellTick before = rest_->before;
  rest_.reset();
  inject_let_go();
  if (rest_) {
    rest_->before = before;
  } else if (runner_.phase() == plant::MotionPhase::Settling) {
    end_motion();
  } else {
    finish_tick(before);
  }
}

}  // namespace snug::simulated_plant
