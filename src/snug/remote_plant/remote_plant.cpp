// RemotePlant: a cell that another program serves over CLICK, behind the interface of a plant.
#include "snug/remote_plant/remote_plant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/click/names.hpp"
#include "snug/core/input_error.hpp"
#include "snug/cup/phases.hpp"
#include "snug/perception/camera_perception.hpp"
#include "snug/record/csv.hpp"
#include "snug/remote_plant/box_observer.hpp"
#include "snug/robot/load_arm.hpp"

namespace snug::remote_plant {
namespace {

constexpr std::string_view kTcp = "click://", kIpc = "click+ipc://";
constexpr double kSameTime = 1e-6;  ///< s, of a tick

[[noreturn]] void refuse(const std::string& address, const std::string& expected) {
  throw InputError("command line", "--plant", "'" + address + "'", expected);
}

/// How many quarter turns an item arrives turned by.
int quarter_of(const model::Item& item) {
  const auto turns = static_cast<int>(std::lround(item.yaw.value_or(0.0) / (0.5 * std::numbers::pi)));
  return (turns % 4 + 4) % 4;
}

double tool_stiffness(const model::Scenario& scenario, const model::Sequence& sequence) {
  return sequence.task_stiffness.value_or(scenario.controller.task_stiffness);
}

}  // namespace

std::string endpoint_of(const std::string& address) {
  const auto is_of = [&](std::string_view kind) { return address.starts_with(kind) && address.size() > kind.size(); };
  if (is_of(kTcp)) {
    const std::string place = address.substr(kTcp.size());
    const std::size_t colon = place.rfind(':');
    const bool has_port = colon != std::string::npos && colon > 0 && colon + 1 < place.size() &&
                          std::ranges::all_of(place.substr(colon + 1), [](char c) { return c >= '0' && c <= '9'; });
    if (has_port) return "tcp://" + place;
  }
  if (is_of(kIpc)) return "ipc://" + address.substr(kIpc.size());
  refuse(address, "click://HOST:PORT or click+ipc://PATH, where `snug serve` serves a cell, ur://HOST, or simulated");
}

RemotePlant::RemotePlant(const model::Scenario& scenario, const std::string& sequence,
                         const RemotePlantOptions& options)
    : options_(options),
      scenario_(cell::with_fixed_arrivals(scenario, sequence)),
      sequence_(cell::require_sequence(scenario_, sequence)),
      model_(robot::load_arm(scenario_)),
      client_(endpoint_of(options.address), options.patience, options.keys),
      link_(client_, model_, {}),
      perception_(perception::make_perception(options.perception, options.seed, scenario, options.frames)),
      was_brought_(sequence_.items.size(), false),
      runner_(plant::runner_settings(scenario_, !motion::is_fast(options.motions.tracking))) {
  for (const model::Item& item : sequence_.items) names_.push_back(record::log_name(item.parcel));
  std::string trouble = link_.connect(scenario_.controller.tick);
  if (trouble.empty()) trouble = find_what_packing_needs();
  if (!trouble.empty()) {
    refuse(options_.address, fmt::format("a cell with sequence {} that is served to be packed: {}", sequence, trouble));
  }
  take_over_tracking();
  if (motion::is_fast(options_.motions.tracking)) {
    pace_ = cell::make_joint_pace(scenario_, motion::tempo_of(options_.motions.tracking));
  }
  cell::limit_joint_speeds(scenario_, options_.motions.tracking);
  arm_ = std::make_unique<cell::CellArm>(scenario_, tool_stiffness(scenario_, sequence_));
  state_ = arm_->make_state(scenario_.seed, link_.measured().q);
  program_ = motion::make_controller_state(state_.machine.tool.X_WE);
  feedback_ = sensors();
}

/// Empty, or what the served cell lacks.
std::string RemotePlant::find_what_packing_needs() const {
  const auto& objects = link_.handshake().objects;
  const click::ObjectDescription& robot = objects.find(link_.robot())->second;
  for (const char* event : {click::kStandEvent, click::kAcknowledgeEvent}) {
    if (!robot.events.contains(event)) return fmt::format("object '{}' has no event '{}'", link_.robot(), event);
  }
  const click::ObjectSensors& sensed = link_.last_of_robot();
  const std::pair<const char*, click::ValueType> needed[] = {{click::kPressureSensor, click::ValueType::Force1D},
                                                             {click::kLoadSensor, click::ValueType::Force3D},
                                                             {click::kHoldingSensor, click::ValueType::Activated}};
  for (const auto& [name, type] : needed) {
    if (find_sensor(sensed, name, type) == nullptr) {
      return fmt::format("object '{}' has no sensor '{}'", link_.robot(), name);
    }
  }
  for (const std::string& name : names_) {
    const auto object = objects.find(name);
    if (object == objects.end()) return fmt::format("it has no object '{}'", name);
    if (!object->second.events.contains(click::kFeedEvent)) {
      return fmt::format("object '{}' has no event '{}'", name, click::kFeedEvent);
    }
  }
  return {};
}

/// The served robot's own lag counts, where it tells.
void RemotePlant::take_over_tracking() {
  const click::SensorValue* tracking =
      find_sensor(link_.last_of_robot(), click::kTrackingSensor, click::ValueType::Acceleration3D);
  if (tracking == nullptr) return;
  const double stiffness = tracking->vector.x();
  if (!(stiffness > 0.0) || !std::isfinite(stiffness)) {
    refuse(options_.address,
           fmt::format("a robot that follows its targets: its sensor '{}' says {}", click::kTrackingSensor, stiffness));
  }
  sequence_.task_stiffness = stiffness;
}

plant::Description RemotePlant::describe() const {
  plant::Description description{options_.address, {}};
  for (const robot::Joint& joint : model_.joints) description.joints.push_back(joint.name);
  return description;
}

Vector3 RemotePlant::size_of(std::size_t item) const {
  const std::string& id = sequence_.items[item].parcel;
  return sensed_size(link_.last(), names_[item], model::collision_size(scenario_, *model::find_parcel(scenario_, id)));
}

std::optional<perception::SceneBox> RemotePlant::box_of(std::size_t item) const {
  return sensed_box(link_.last(), names_[item], sequence_.items[item].parcel, size_of(item));
}

std::vector<std::optional<perception::SceneBox>> RemotePlant::boxes() const {
  std::vector<std::optional<perception::SceneBox>> boxes;
  for (std::size_t i = 0; i < names_.size(); ++i) boxes.push_back(box_of(i));
  return boxes;
}

void RemotePlant::perceive(std::span<const perception::Expectation> expected) {
  perception::Scene scene;
  if (failure_.empty()) {
    const std::string trouble = link_.sense();
    if (!trouble.empty()) fail(trouble);
  }
  scene.time = link_.last().time;
  scene.X_WE = state_.machine.tool.X_WE;
  if (failure_.empty()) {
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (const auto box = box_of(i)) scene.boxes.push_back(*box);
    }
  }
  perception::Observation observation = perception_->perceive(scene, expected);
  if (!failure_.empty()) observation.missing.clear();  // nothing was looked at
  runner_.add({scene.time, plant::Perceived{std::move(observation)}});
}

void RemotePlant::fail(std::string why) {
  if (!failure_.empty()) return;
  failure_ = std::move(why);
  feedback_.end = {plant::EndReason::Fault, std::nullopt, 0.0, 0.0, failure_};
  runner_.add({link_.last().time, plant::FaultRaised{plant::EndReason::Fault, failure_}});
}

/// The first Control says that boxes are brought from here.
click::Control RemotePlant::make_control() {
  click::Control control;
  if (!has_commanded_) {
    for (const std::string& name : names_) control.objects[name].events[click::kFeedEvent] = false;
  }
  has_commanded_ = true;
  return control;
}

bool RemotePlant::send(const click::Control& control) {
  std::string trouble = link_.send(control);
  if (!trouble.empty()) fail(std::move(trouble));
  return failure_.empty();
}

bool RemotePlant::bring(const model::ParcelId& item) {
  const auto found = std::ranges::find(sequence_.items, item.value, &model::Item::parcel);
  const auto index = static_cast<std::size_t>(found - sequence_.items.begin());
  if (found == sequence_.items.end() || was_brought_[index] || !failure_.empty()) return false;
  if (coming_) feed();  // one that comes in the same tick, before it
  was_brought_[index] = true;
  coming_ = index;
  if (!is_moving()) feed();
  return failure_.empty();
}

/// Moves the item that comes into the Control.
std::size_t RemotePlant::put_coming(click::Control& control) {
  const std::size_t item = *std::exchange(coming_, std::nullopt);
  const int quarter = quarter_of(sequence_.items[item]);
  control.objects[names_[item]].events = {
      {click::kFeedEvent, true}, {click::kQuarterTurnEvent, quarter % 2 == 1}, {click::kHalfTurnEvent, quarter >= 2}};
  return item;
}

void RemotePlant::feed() {
  click::Control control = make_control();
  const std::size_t item = put_coming(control);
  if (send(control)) note_arrival(item);
}

void RemotePlant::note_arrival(std::size_t item) {
  runner_.add({link_.last().time, plant::ItemArrived{model::ParcelId(sequence_.items[item].parcel)}});
}

void RemotePlant::acknowledge() {
  if (!is_stopped_ || !failure_.empty()) return;
  is_stopped_ = false;
  click::Control control = make_control();
  control.objects[link_.robot()].events = {{click::kAcknowledgeEvent, true}, {click::kStandEvent, true}};
  (void)send(control);
}

plant::TickReading RemotePlant::reading() const {
  const click::RobotFeel feel = click::feel_of(link_.last_of_robot()).value_or(click::RobotFeel{});
  plant::TickReading now;
  now.time = link_.last().time;
  now.F_E = feel.F_E;
  now.pressure_gauge = feel.pressure_gauge;
  now.is_vacuum_on = program_.io.vacuum;
  now.hold_factor = cup::sensed_hold_factor(scenario_.cup, now.pressure_gauge, now.F_E);
  return now;
}

plant::Feedback RemotePlant::sensors() const {
  const plant::TickReading now = reading();
  plant::Feedback fed;
  fed.time = now.time;
  fed.X_WE = state_.machine.tool.X_WE;
  fed.V_WE = state_.machine.tool.V_WE;
  const control::JointMotion& joints = state_.machine.joints;
  fed.q.assign(joints.q.begin(), joints.q.end());
  fed.qd.assign(joints.qd.begin(), joints.qd.end());
  const std::vector<double>& torques = link_.last_of_robot().torques;
  for (std::size_t j = 0; j < fed.q.size(); ++j) {
    const std::size_t place = link_.sensor_of(j);
    fed.torques.push_back(place < torques.size() ? torques[place] : 0.0);
  }
  fed.pressure_gauge = now.pressure_gauge;
  fed.F_E = now.F_E;
  fed.io = program_.io;
  return fed;
}

plant::Feedback RemotePlant::read() {
  if (!is_moving()) return feedback_;
  plant::Feedback now = sensors();
  now.end = feedback_.end;
  runner_.fill(now);
  return now;
}

/// The controller's next tick, sent, and its answer.
control::MachineTick RemotePlant::command_tick() {
  state_.machine.tool = control::tool_at(model_, link_.measured());
  const control::MachineTick tick = arm_->tick(plan_, program_, state_, work_);
  click::Control control = make_control();
  link_.command(state_.machine.joints, tick.program.io, control);
  const std::optional<std::size_t> arriving = coming_ ? std::optional(put_coming(control)) : std::nullopt;
  const double start = link_.last().time;
  trouble_ = link_.send(control);
  const double length = link_.last().time - start;
  if (!trouble_.empty()) {
    const std::string silence = link_.sense();
    is_stopped_ = silence.empty() && is_active(link_.last_of_robot(), click::kStoppedSensor);
    if (!is_stopped_) fail(trouble_);
  } else if (!(std::abs(length - plan_.settings.tick) <= kSameTime)) {  // nor NaN
    fail(fmt::format("a Control is a step of {} s there, not of {} s: is it served with --async?", length,
                     plan_.settings.tick));
  } else if (tick.outcome == control::Outcome::Stuck) {
    trouble_ = "stuck";
    is_stopped_ = true;
  }
  if (arriving && failure_.empty()) note_arrival(*arriving);
  state_.machine.tool = control::tool_at(model_, link_.measured());
  const plant::TickReading felt = reading();
  program_.sensed = {felt.pressure_gauge, state_.machine.tool.X_WE.R * felt.F_E.force, felt.hold_factor};
  return tick;
}

std::vector<plant::Event> RemotePlant::advance() {
  if (is_moving() && !runner_.has_events()) step();
  return runner_.take_events();
}

void RemotePlant::cancel() {
  if (!is_moving()) return;
  runner_.stop(plant::EndReason::Cancelled);
  end_motion();
}

void RemotePlant::step() {
  if (!failure_.empty()) return end_motion();
  const double now = link_.last().time;
  if (runner_.phase() == plant::MotionPhase::Following && motion::will_finish(plan_, program_.command, program_)) {
    runner_.arrive(now);
  }
  if (runner_.phase() == plant::MotionPhase::Settling &&
      runner_.is_settled(now, state_.machine.tool.V_WE.linear.norm())) {
    return finish_settling();
  }
  const control::MachineTick tick = command_tick();
  const bool goes_on = failure_.empty() && !is_stopped_;
  if (runner_.phase() == plant::MotionPhase::Settling) {
    if (!goes_on) finish_settling();
    return;
  }
  runner_.follow(
      {motion::WaypointIndex(tick.program.row), link_.last().time, program_.phase == motion::ControllerPhase::Waiting});
  runner_.check(reading());
  if (is_stopped_) runner_.stop(plant::EndReason::ProtectiveStop, 0.0, 0.0, trouble_);
  if (runner_.has_ended() || !goes_on) end_motion();
}

void RemotePlant::finish_settling() {
  runner_.rest(link_.last().time);
  acknowledge();  // a stop now: the tool was where it was to come
  end_motion();
}

void RemotePlant::end_motion() {
  if (coming_ && failure_.empty()) feed();
  if (runner_.end().reason == plant::EndReason::ProtectiveStop) {
    runner_.add({link_.last().time, plant::FaultRaised{plant::EndReason::ProtectiveStop, runner_.end().where}});
  }
  stand();
  if (!failure_.empty()) runner_.stop(plant::EndReason::Fault, 0.0, 0.0, failure_);
  feedback_ = sensors();
  runner_.finish(feedback_);
}

void RemotePlant::begin_motion() {
  motion::ControllerState program = motion::make_controller_state(state_.machine.tool.X_WE);
  program.command = state_.machine.tool;
  program.io = program_.io;
  program.tick_count = program_.tick_count;
  program.sensed = program_.sensed;
  program_ = program;
}

/// The brakes are closed. A robot that stopped for protection has closed them itself.
void RemotePlant::stand() {
  if (failure_.empty() && !is_stopped_) {
    click::Control control = make_control();
    control.objects[link_.robot()].events[click::kStandEvent] = true;
    (void)send(control);
  }
  state_.machine.joints.q = link_.measured().q;
  arm_->stand(state_);
  begin_motion();
  program_.command.V_WE = Twist{};
}

void RemotePlant::start(const plant::Motion& motion) {
  const auto refuse_motion = [&](std::string why) {
    feedback_ = sensors();
    runner_.refuse(std::move(why), feedback_);
  };
  if (is_stopped_) return refuse_motion("a protective stop is not acknowledged");
  if (!failure_.empty()) return refuse_motion("the plant has failed: " + failure_);
  const std::string refusal = plant::MotionRunner::find_refusal(motion);
  if (!refusal.empty()) return refuse_motion(refusal);
  try {
    plan_ = cell::prepare(scenario_, sequence_, options_.motions, {"motion", motion.waypoints});
    plan_.path_limits = pace_.get();
  } catch (const InputError& error) {
    return refuse_motion(error.what());
  }
  begin_motion();
  runner_.begin(motion, reading(), is_active(link_.last_of_robot(), click::kHoldingSensor));
}

std::string RemotePlant::finish() { return failure_.empty() ? client_.reset() : failure_; }

}  // namespace snug::remote_plant
