// JointLink: the joints of a known arm found in a simulator, its sensors taken over, commands put in its order.
#include "snug/click/joint_link.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/click/names.hpp"
#include "snug/click/rpy.hpp"

namespace snug::click {
namespace {

int index_of(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

}  // namespace

const SensorValue* find_sensor(const ObjectSensors& object, std::string_view name, ValueType type, std::size_t index) {
  const auto found = object.sensors.find(name);
  if (found == object.sensors.end() || index >= found->second.size()) return nullptr;
  const SensorValue& value = found->second[index];
  return value.type == type ? &value : nullptr;
}

bool is_active(const ObjectSensors& object, std::string_view name) {
  const SensorValue* value = find_sensor(object, name, ValueType::Activated);
  return value != nullptr && value->is_active;
}

std::optional<RobotFeel> feel_of(const ObjectSensors& robot) {
  const SensorValue* force = find_sensor(robot, kLoadSensor, ValueType::Force3D);
  const SensorValue* torque = find_sensor(robot, kLoadSensor, ValueType::Torque3D, 1);
  const SensorValue* pressure = find_sensor(robot, kPressureSensor, ValueType::Force1D);
  if (force == nullptr || torque == nullptr || pressure == nullptr) return std::nullopt;
  return RobotFeel{pressure->scalar, {force->vector, torque->vector}};
}

std::optional<Pose> sensed_pose(const ObjectSensors& object) {
  Pose X_WP;
  bool has_position = false;
  for (const SensorValue& value : object.object) {
    has_position = has_position || value.type == ValueType::Position;
    if (value.type == ValueType::Position) X_WP.p = value.vector;
    if (value.type == ValueType::Rpy) X_WP.R = rotation_of(value.vector, {});
  }
  for (int axis = 0; axis < 3; ++axis) {
    const SensorValue* exact = find_sensor(object, kAxesSensor, ValueType::Position, static_cast<std::size_t>(axis));
    if (exact != nullptr) X_WP.R.col(axis) = exact->vector;
  }
  const bool is_sound = has_position && X_WP.p.allFinite() && X_WP.R.allFinite() &&
                        (X_WP.R.transpose() * X_WP.R).isIdentity(1e-6) && X_WP.R.determinant() > 0.0;
  return is_sound ? std::optional(X_WP) : std::nullopt;
}

const Sensor JointLink::kNothing;

std::string JointLink::connect(double tick) {
  auto handshake = client_.shake_hands();
  if (!handshake) return handshake.error();
  handshake_ = std::move(*handshake);
  if (!(std::abs(handshake_.time_step - tick) <= 1e-9)) {  // nor NaN
    return fmt::format("the simulator steps by {} s, the controller by {} s", handshake_.time_step, tick);
  }
  std::string trouble = find_robot();
  if (trouble.empty()) trouble = find_joints();
  if (trouble.empty()) trouble = find_events();
  return trouble.empty() ? sense() : trouble;
}

std::string JointLink::find_robot() {
  const auto has_joints = [&](const ObjectDescription& object) {
    return std::all_of(arm_.joints.begin(), arm_.joints.end(),
                       [&](const robot::Joint& joint) { return index_of(object.controls, joint.name) >= 0; });
  };
  bool is_found = false;
  for (const auto& [name, object] : handshake_.objects) {
    if (settings_.object.empty() ? !has_joints(object) : name != settings_.object) continue;
    if (is_found) return fmt::format("both '{}' and '{}' have these joints: --object", robot_name_, name);
    is_found = true;
    robot_name_ = name;
  }
  if (is_found) return {};
  return settings_.object.empty() ? "the simulator has no object with the joints of " + arm_.name
                                  : "the simulator has no object '" + settings_.object + "'";
}

std::string JointLink::find_joints() {
  const ObjectDescription& robot = handshake_.objects[robot_name_];
  for (const robot::Joint& joint : arm_.joints) {
    const int control = index_of(robot.controls, joint.name), sensor = index_of(robot.joints, joint.name);
    if (control < 0 || sensor < 0) return fmt::format("object '{}' has no joint '{}'", robot_name_, joint.name);
    const ValueType type = robot.control_types[static_cast<std::size_t>(control)];
    if (!settings_.only_looks && type != ValueType::Angle && type != ValueType::AngularVelocity1D) {
      return fmt::format("joint '{}' takes {}; this controller has Angle and AngularVelocity1D", joint.name,
                         name_of(type));
    }
    joints_.push_back({static_cast<std::size_t>(control), static_cast<std::size_t>(sensor), type == ValueType::Angle});
  }
  if (robot.controls.size() == joints_.size()) return {};
  return fmt::format("object '{}' has {} joints, {} has {}", robot_name_, robot.controls.size(), arm_.name,
                     joints_.size());
}

std::string JointLink::find_events() {
  const ObjectDescription& robot = handshake_.objects[robot_name_];
  has_vacuum_ = robot.events.contains(settings_.vacuum_event);
  has_blow_off_ = robot.events.contains(settings_.blow_off_event);
  if (has_vacuum_ || !settings_.needs_vacuum) return {};
  return fmt::format("object '{}' has no event '{}': --vacuum-event", robot_name_, settings_.vacuum_event);
}

std::string JointLink::take(const Client::Sensed& sensed) {
  if (!sensed) return sensed.error();
  const Sensor* sensor = *sensed;
  const auto found = sensor->objects.find(robot_name_);
  if (found == sensor->objects.end()) return fmt::format("no sensors of '{}'", robot_name_);
  const ObjectSensors& robot = found->second;
  const std::size_t n = handshake_.objects[robot_name_].joints.size();
  if (robot.angles.size() != n || robot.velocities.size() != n) {
    return fmt::format("'{}' has {} joints but sends {} angles and {} speeds", robot_name_, n, robot.angles.size(),
                       robot.velocities.size());
  }
  const auto count = static_cast<Eigen::Index>(joints_.size());
  control::JointMotion measured;
  measured.q.resize(count);
  measured.qd.resize(count);
  measured.qdd.setZero(count);
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    measured.q[static_cast<Eigen::Index>(j)] = robot.angles[joints_[j].sensor];
    measured.qd[static_cast<Eigen::Index>(j)] = robot.velocities[joints_[j].sensor];
  }
  if (!measured.q.allFinite() || !measured.qd.allFinite() || !std::isfinite(sensor->time)) {
    return "the simulator sent sensor values that are not numbers";
  }
  measured_ = std::move(measured);
  last_ = sensor;
  return {};
}

void JointLink::command(const control::JointMotion& joints, const motion::IO& io, Control& control) const {
  ObjectControl& robot = control.objects[robot_name_];
  robot.list = CommandList::Values;
  robot.values.resize(joints_.size());
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const auto k = static_cast<Eigen::Index>(j);
    robot.values[joints_[j].control] = joints_[j].is_position ? joints.q[k] : joints.qd[k];
  }
  if (has_vacuum_) robot.events[settings_.vacuum_event] = io.vacuum;
  if (has_blow_off_) robot.events[settings_.blow_off_event] = io.blow_off;
}

}  // namespace snug::click
