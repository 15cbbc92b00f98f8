// ServedCell: the simulated cell in the words of CLICK: its objects, what they sense, what a command to them means.
#include "snug/served_cell/served_cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "snug/click/names.hpp"
#include "snug/click/sensor_writer.hpp"
#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/record/csv.hpp"
#include "snug/robot/dynamics.hpp"

namespace snug::served_cell {
namespace {

namespace wire = click::wire;
using click::CommandList;
using click::Control;
using click::kAcknowledgeEvent;
using click::kAxesSensor;
using click::kFeedEvent;
using click::kHalfTurnEvent;
using click::kHoldingSensor;
using click::kLoadSensor;
using click::kPresentSensor;
using click::kPressureForceSensor;
using click::kPressureSensor;
using click::kQuarterTurnEvent;
using click::kSizeSensor;
using click::kStandEvent;
using click::kStoppedSensor;
using click::kToolSensor;
using click::kTrackingSensor;
using click::Named;
using click::ObjectControl;
using click::ObjectDescription;
using click::ObjectSensors;
using click::rpy_of;
using click::Sensor;
using click::SensorValue;
using click::ValueType;

using control::DriveKind;
using Reason = Unexpected<std::string>;

// m, W: where a box that is not in the cell is said to be: the demonstrator's controller parks boxes there, too.
const Vector3 kParked(0.5, 0.5, -0.2);
constexpr std::size_t kLongestName = 60;  ///< of a stranger's text in a message

ValueType type_of(DriveKind kind) {
  return kind == DriveKind::Position ? ValueType::Angle
         : kind == DriveKind::Speed  ? ValueType::AngularVelocity1D
                                     : ValueType::Torque1D;
}

/// A name that somebody sent, fit to be shown.
std::string shown(std::string_view name) {
  std::string text(name.substr(0, kLongestName));
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  return "'" + text + (name.size() > kLongestName ? "...'" : "'");
}

template <class T>
std::string nearest_of(std::string_view name, const Named<T>& known) {
  std::vector<std::string> names;
  for (const auto& entry : known) names.push_back(entry.first);
  const std::string_view nearest = find_nearest(name, names);
  return nearest.empty() ? "" : fmt::format("; is it '{}'?", nearest);
}

SensorValue vector_value(ValueType type, const Vector3& vector) { return {type, vector, 0.0, false}; }

const char* name_of_list(CommandList list) {
  switch (list) {
    case CommandList::Angles:
      return "angles";
    case CommandList::AngularVelocities:
      return "angularVelocities";
    case CommandList::Torques:
      return "torques";
    default:
      return "values";
  }
}

}  // namespace

ServedCell::ServedCell(const cell::Simulation& simulation, const ServedCellSettings& settings)
    : simulation_(simulation), settings_(settings) {
  SNUG_CHECK(simulation.arm() != nullptr, "a served cell has a robot");
  const model::Scenario& scenario = simulation.scenario();
  if (settings_.robot_object.empty()) settings_.robot_object = scenario.robot->name;
  handshake_.time_step = scenario.controller.tick;
  describe_robot(settings);
  describe_bodies(settings);
}

void ServedCell::describe_robot(const ServedCellSettings& settings) {
  const std::vector<robot::Joint>& joints = simulation_.arm()->model().joints;
  kinds_ = settings.controls;
  if (kinds_.size() == 1) kinds_.assign(joints.size(), kinds_.front());
  if (kinds_.size() != joints.size()) {
    throw InputError("command line", "--control", fmt::format("{} kinds", kinds_.size()),
                     fmt::format("one, or one for each of the {} joints", joints.size()));
  }
  ObjectDescription& robot = handshake_.objects[settings_.robot_object];
  for (std::size_t j = 0; j < joints.size(); ++j) {
    robot.controls.push_back(joints[j].name);
    robot.control_types.push_back(type_of(kinds_[j]));
  }
  robot.joints = robot.controls;
  robot.object_sensors = {ValueType::Position, ValueType::Rpy};
  robot.joint_sensors = {ValueType::Angle, ValueType::AngularVelocity1D, ValueType::Torque1D};
  if (settings.joint_forces) robot.joint_sensors.push_back(ValueType::Force3D);
  robot.events[settings.vacuum_event] = ValueType::Activated;
  robot.events[settings.blow_off_event] = ValueType::Activated;
  robot.events[kStandEvent] = ValueType::Activated;
  robot.events[kAcknowledgeEvent] = ValueType::Activated;
  robot.sensors[settings.force_sensor] = {ValueType::Force3D, ValueType::Torque3D};
  robot.sensors[kToolSensor] = {ValueType::Position, ValueType::Rpy, ValueType::Velocity3D,
                                ValueType::AngularVelocity3D};
  robot.sensors[kHoldingSensor] = {ValueType::Activated};
  robot.sensors[kStoppedSensor] = {ValueType::Activated};
  robot.sensors[kPressureSensor] = {ValueType::Force1D};
  robot.sensors[kPressureForceSensor] = {ValueType::Force3D};
  robot.sensors[kLoadSensor] = {ValueType::Force3D, ValueType::Torque3D};
  if (settings.is_plant) robot.sensors[kTrackingSensor] = {ValueType::Acceleration3D};
  if (robot.events.size() != 4 || robot.sensors.size() != (settings.is_plant ? 8U : 7U)) {
    throw InputError("command line", "--vacuum-event, --blow-off-event, --force-sensor", "names that are taken",
                     "a name of its own for each");
  }
}

void ServedCell::describe_bodies(const ServedCellSettings& settings) {
  const cell::CellWorld& world = simulation_.world();
  const model::Scenario& scenario = simulation_.scenario();
  for (std::size_t i = 0; i < world.parcels.size(); ++i) {
    const std::string& id = simulation_.sequence().items[i].parcel;
    bodies_.push_back({record::log_name(id), world.parcels[i], static_cast<int>(i),
                       model::collision_size(scenario, *model::find_parcel(scenario, id))});
  }
  for (const physics::BodyId id : world.bodies) {
    const physics::BodyModel& body = world.model.bodies[static_cast<std::size_t>(id.index)];
    if (body.kind == physics::BodyKind::Dynamic)
      bodies_.push_back({record::log_name(body.name), id, -1, Vector3::Zero()});
  }
  std::ranges::sort(bodies_, {}, &Body::name);
  for (const Body& body : bodies_) {
    if (handshake_.objects.contains(body.name)) {
      throw InputError(simulation_.scenario().source_name, "objects", "two of the name '" + body.name + "'",
                       "a name of its own for each (--robot-object renames the robot)");
    }
    ObjectDescription& object = handshake_.objects[body.name];
    object.object_sensors = {ValueType::Position, ValueType::Rpy};
    if (settings.velocities) {
      object.object_sensors.push_back(ValueType::Velocity3D);
      object.object_sensors.push_back(ValueType::AngularVelocity3D);
    }
    object.sensors[kPresentSensor] = {ValueType::Activated};
    if (body.item < 0) continue;
    if (settings.is_plant) {
      object.sensors[kAxesSensor] = std::vector<ValueType>(3, ValueType::Position);
      object.sensors[kSizeSensor] = {ValueType::Position};
    }
    for (const char* event : {kFeedEvent, kQuarterTurnEvent, kHalfTurnEvent}) {
      object.events[event] = ValueType::Activated;
    }
  }
}

Switches ServedCell::make_switches() const {
  Switches switches;
  switches.boxes.resize(simulation_.sequence().items.size());
  return switches;
}

const ServedCell::Body* ServedCell::find_body(std::string_view name) const {
  const auto found = std::find_if(bodies_.begin(), bodies_.end(), [&](const Body& body) { return body.name == name; });
  return found == bodies_.end() ? nullptr : &*found;
}

Expected<Order, std::string> ServedCell::understand(const Control& control, const Switches& switches,
                                                    const cell::CellState& state) const {
  Order order;
  order.switches = switches;
  for (const auto& [name, object] : control.objects) {
    if (!handshake_.objects.contains(name)) {
      return Reason(fmt::format("object {} is unknown{}", shown(name), nearest_of(name, handshake_.objects)));
    }
    std::string trouble = take_events(name, object, order);
    if (trouble.empty() && name == settings_.robot_object) {
      order.moves_joints = object.list != CommandList::Nothing || !(order.stands || order.acknowledges);
      if (order.moves_joints) trouble = take_joints(object, order.command);
    } else if (trouble.empty() && object.list != CommandList::Nothing) {
      trouble = fmt::format("object '{}' has no joints to control", name);
    }
    if (!trouble.empty()) return Reason(std::move(trouble));
  }
  std::string trouble = take_feeding(switches, state, order);
  if (!trouble.empty()) return Reason(std::move(trouble));
  if (!order.moves_joints && order.item < 0 && !order.stands && !order.acknowledges) {
    return Reason(fmt::format("no values for the joints of '{}'", settings_.robot_object));
  }
  order.command.cup = {order.switches.vacuum, order.switches.blow_off};
  return order;
}

std::string ServedCell::take_joints(const ObjectControl& object, cell::OutsideCommand& command) const {
  const std::size_t n = kinds_.size();
  if (object.values.size() != n) {
    return fmt::format("{} {} for the {} joints of '{}'", object.values.size(), name_of_list(object.list), n,
                       settings_.robot_object);
  }
  const ObjectDescription& robot = handshake_.objects.find(settings_.robot_object)->second;
  const ValueType listed = object.list == CommandList::Angles              ? ValueType::Angle
                           : object.list == CommandList::AngularVelocities ? ValueType::AngularVelocity1D
                                                                           : ValueType::Torque1D;
  command.joints.kinds = kinds_;
  command.joints.target.resize(static_cast<Eigen::Index>(n));
  for (std::size_t j = 0; j < n; ++j) {
    if (object.list != CommandList::Values && listed != robot.control_types[j]) {
      return fmt::format("'{}' for joint '{}', which takes {}", name_of_list(object.list), robot.controls[j],
                         name_of(robot.control_types[j]));
    }
    if (!std::isfinite(object.values[j])) {
      return fmt::format("the value for joint '{}' is {}, not a finite number", robot.controls[j], object.values[j]);
    }
    command.joints.target[static_cast<Eigen::Index>(j)] = object.values[j];
  }
  return {};
}

std::string ServedCell::take_events(const std::string& name, const ObjectControl& object, Order& order) const {
  const Named<ValueType>& known = handshake_.objects.find(name)->second.events;
  const Body* body = find_body(name);
  for (const auto& [event, is_on] : object.events) {
    if (!known.contains(event)) {
      return fmt::format("object '{}' has no event {}{}", name, shown(event), nearest_of(event, known));
    }
    if (body == nullptr) {
      (event == settings_.vacuum_event     ? order.switches.vacuum
       : event == settings_.blow_off_event ? order.switches.blow_off
       : event == kStandEvent              ? order.stands
                                           : order.acknowledges) = is_on;
      continue;
    }
    Switches::Box& box = order.switches.boxes[static_cast<std::size_t>(body->item)];
    (event == kFeedEvent ? box.feed : event == kHalfTurnEvent ? box.half_turn : box.quarter_turn) = is_on;
    order.names_feeding = true;
  }
  return {};
}

std::string ServedCell::take_feeding(const Switches& before, const cell::CellState& state, Order& order) const {
  for (const Body& body : bodies_) {
    if (body.item < 0) continue;
    const Switches::Box& box = order.switches.boxes[static_cast<std::size_t>(body.item)];
    if (!box.feed || before.boxes[static_cast<std::size_t>(body.item)].feed) continue;
    if (order.item >= 0) return "two boxes are to come at once";
    if (state.world.bodies[static_cast<std::size_t>(body.id.index)].is_present) {
      return fmt::format("box '{}' is to come, but it is in the cell", body.name);
    }
    order.item = body.item;
    order.quarter = (box.quarter_turn ? 1 : 0) + (box.half_turn ? 2 : 0);
  }
  return {};
}

cell::OutsideCommand ServedCell::stand(const cup::CupCommand& cup) const {
  const std::size_t n = kinds_.size();
  return {{std::vector<DriveKind>(n, DriveKind::Speed), robot::JointVector::Zero(static_cast<Eigen::Index>(n))}, cup};
}

Sensor ServedCell::sense(const cell::CellState& state, const cell::ArmReading& reading, const Wrench& load) const {
  Sensor sensor;
  sensor.time = simulation_.time(state);
  sensor.objects.emplace(settings_.robot_object, sense_robot(state, reading, load));
  for (const Body& body : bodies_) sensor.objects.emplace(body.name, sense_body(body, state));
  return sensor;
}

std::string ServedCell::write_sensor(const cell::CellState& state, const cell::ArmReading& reading, const Wrench& load,
                                     WrittenBodies& written) const {
  written.bodies.resize(bodies_.size());
  std::string frame = wire::begin_sensor();
  bool has_robot = false;
  const auto write_robot = [&] {
    frame += wire::write_object(settings_.robot_object, sense_robot(state, reading, load));
    has_robot = true;
  };
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (!has_robot && settings_.robot_object < bodies_[i].name) write_robot();
    frame += write_body(bodies_[i], state, written.bodies[i]);
  }
  if (!has_robot) write_robot();
  return frame += wire::end_sensor(simulation_.time(state));
}

const std::string& ServedCell::write_body(const Body& body, const cell::CellState& state,
                                          WrittenBodies::Body& written) const {
  const physics::BodyState& now = state.world.bodies[static_cast<std::size_t>(body.id.index)];
  const auto& p = now.p_WBcm;
  const auto& q = now.quat_WB.coeffs();
  const auto& v = now.velocity;
  const auto& w = now.angular_velocity;
  const WrittenBodies::State bits = {p[0], p[1], p[2], q[0], q[1], q[2], q[3],
                                     v[0], v[1], v[2], w[0], w[1], w[2], now.is_present ? 1.0 : 0.0};
  if (written.bytes.empty() || std::memcmp(written.state.data(), bits.data(), sizeof bits) != 0) {
    written.state = bits;
    written.bytes = wire::write_object(body.name, sense_body(body, state));
  }
  return written.bytes;
}

ObjectSensors ServedCell::sense_robot(const cell::CellState& state, const cell::ArmReading& reading,
                                      const Wrench& load) const {
  ObjectSensors robot;
  const control::MachineState& machine = state.arm->machine;
  const Pose& X_WB = simulation_.arm()->model().X_WB;
  robot.object = {vector_value(ValueType::Position, X_WB.p),
                  vector_value(ValueType::Rpy, rpy_of(X_WB.R, settings_.rpy))};
  robot.angles.assign(machine.joints.q.begin(), machine.joints.q.end());
  robot.velocities.assign(machine.joints.qd.begin(), machine.joints.qd.end());
  for (const record::JointSample& joint : reading.joints) robot.torques.push_back(joint.torque);
  if (settings_.joint_forces) {
    const auto forces =
        robot::joint_forces(simulation_.arm()->model(), {machine.joints.q, machine.joints.qd, machine.joints.qdd},
                            reading.F_Eo_W, simulation_.scenario().gravity);
    robot.forces.assign(forces.begin(), forces.begin() + static_cast<std::ptrdiff_t>(kinds_.size()));
  }
  robot.sensors[settings_.force_sensor] = {vector_value(ValueType::Force3D, reading.F_sensor.force),
                                           vector_value(ValueType::Torque3D, reading.F_sensor.torque)};
  robot.sensors[kToolSensor] = {vector_value(ValueType::Position, machine.tool.X_WE.p),
                                vector_value(ValueType::Rpy, rpy_of(machine.tool.X_WE.R, settings_.rpy)),
                                vector_value(ValueType::Velocity3D, machine.tool.V_WE.linear),
                                vector_value(ValueType::AngularVelocity3D, machine.tool.V_WE.angular)};
  robot.sensors[kHoldingSensor] = {{ValueType::Activated, Vector3::Zero(), 0.0, state.gripper.cup.body >= 0}};
  robot.sensors[kStoppedSensor] = {{ValueType::Activated, Vector3::Zero(), 0.0, reading.stop.has_value()}};
  robot.sensors[kPressureSensor] = {{ValueType::Force1D, Vector3::Zero(), state.gripper.cup.pressure_gauge, false}};
  robot.sensors[kPressureForceSensor] = {
      vector_value(ValueType::Force3D, Vector3(0.0, 0.0, state.gripper.cup.pressure_gauge))};
  robot.sensors[kLoadSensor] = {vector_value(ValueType::Force3D, load.force),
                                vector_value(ValueType::Torque3D, load.torque)};
  if (settings_.is_plant) {
    const double stiffness = simulation_.arm()->controller().settings().tool_stiffness;
    robot.sensors[kTrackingSensor] = {vector_value(ValueType::Acceleration3D, Vector3::Constant(stiffness))};
  }
  return robot;
}

ObjectSensors ServedCell::sense_body(const Body& body, const cell::CellState& state) const {
  ObjectSensors object;
  const bool is_present = state.world.bodies[static_cast<std::size_t>(body.id.index)].is_present;
  const physics::WorldModel& model = simulation_.world().model;
  const Pose X_WB = is_present ? physics::pose_of(model, state.world, body.id) : Pose{Matrix3::Identity(), kParked};
  object.object = {vector_value(ValueType::Position, X_WB.p),
                   vector_value(ValueType::Rpy, rpy_of(X_WB.R, settings_.rpy))};
  if (settings_.velocities) {
    const Twist V_WB = is_present ? physics::twist_of(model, state.world, body.id) : Twist{};
    object.object.push_back(vector_value(ValueType::Velocity3D, V_WB.linear));
    object.object.push_back(vector_value(ValueType::AngularVelocity3D, V_WB.angular));
  }
  object.sensors[kPresentSensor] = {{ValueType::Activated, Vector3::Zero(), 0.0, is_present}};
  if (!settings_.is_plant || body.item < 0) return object;
  std::vector<SensorValue>& axes = object.sensors[kAxesSensor];
  for (int i = 0; i < 3; ++i) axes.push_back(vector_value(ValueType::Position, X_WB.R.col(i)));
  object.sensors[kSizeSensor] = {vector_value(ValueType::Position, body.size)};
  return object;
}

}  // namespace snug::served_cell
