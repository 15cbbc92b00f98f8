// JointLink: the joints of a known arm found in a simulator, its sensors taken over, commands put in its order.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/click/client.hpp"
#include "snug/control/joint_drive.hpp"
#include "snug/motion/waypoint.hpp"
#include "snug/robot/arm.hpp"

namespace snug::click {

struct JointLinkSettings {
  std::string object = {};  ///< of the simulator; empty: the one that has all joints of the arm
  std::string vacuum_event = "vacuum";
  std::string blow_off_event = "blow_off";  ///< used if there is one
  bool needs_vacuum = true;
  bool only_looks = false;  ///< no commands: joints may take what they like
};

class JointLink {
 public:
  /// Client and arm outlive the link.
  JointLink(Client& client, const robot::ArmModel& arm, JointLinkSettings settings)
      : client_(client), arm_(arm), settings_(std::move(settings)) {}

  /// Finds what is needed in the handshake and where the joints are. `tick`: s, of the controller. Empty, or what is
  /// missing. To be called first.
  [[nodiscard]] std::string connect(double tick);
  /// What the simulator senses now; empty, or why that cannot be known.
  [[nodiscard]] std::string sense() { return take(client_.sense()); }
  /// One Control and what is sensed then; empty, or why there is nothing.
  [[nodiscard]] std::string send(const Control& control) { return take(client_.control(control)); }
  /// Adds a command for the joints, for the end of the coming step, and the switches.
  void command(const control::JointMotion& joints, const motion::IO& io, Control& control) const;

  [[nodiscard]] const Handshake& handshake() const { return handshake_; }
  [[nodiscard]] const std::string& robot() const { return robot_name_; }
  /// Where the joints were measured, in the order of the arm.
  [[nodiscard]] const control::JointMotion& measured() const { return measured_; }
  [[nodiscard]] const Sensor& last() const { return *last_; }
  /// The robot's object in it.
  [[nodiscard]] const ObjectSensors& last_of_robot() const { return last_->objects.find(robot_name_)->second; }
  /// Of a joint of the arm, in the lists of joint sensors.
  [[nodiscard]] std::size_t sensor_of(std::size_t joint) const { return joints_[joint].sensor; }

 private:
  struct JointPlace {
    std::size_t control = 0, sensor = 0;  ///< in the lists of the simulator
    bool is_position = false;
  };
  [[nodiscard]] std::string find_robot();
  [[nodiscard]] std::string find_joints();
  [[nodiscard]] std::string find_events();
  [[nodiscard]] std::string take(const Client::Sensed& sensed);

  Client& client_;
  const robot::ArmModel& arm_;
  JointLinkSettings settings_;
  Handshake handshake_;
  std::string robot_name_;
  std::vector<JointPlace> joints_;  ///< in the order of the arm
  bool has_vacuum_ = false, has_blow_off_ = false;
  control::JointMotion measured_;
  static const Sensor kNothing;     ///< before the first
  const Sensor* last_ = &kNothing;  ///< the client's
};

/// The value of a sensor of an object, or nullptr. `index`: of those with the name.
[[nodiscard]] const SensorValue* find_sensor(const ObjectSensors& object, std::string_view name, ValueType type,
                                             std::size_t index = 0);
[[nodiscard]] bool is_active(const ObjectSensors& object, std::string_view name);
/// What the robot's sensors of load and pressure say.
struct RobotFeel {
  double pressure_gauge = 0.0;  ///< Pa
  Wrench F_E;                   ///< on the tool, from what it carries and touches
};
/// Nothing where one of them is missing.
[[nodiscard]] std::optional<RobotFeel> feel_of(const ObjectSensors& robot);
/// Where an object says that it is, in W: its axes, where it tells them, else its RPY (about x, y, z). Nothing where it
/// has no position or what it says is no pose.
[[nodiscard]] std::optional<Pose> sensed_pose(const ObjectSensors& object);

}  // namespace snug::click
