// RobotParams: which arm a scenario has, where it stands, and the limits it is driven with.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/core/field.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::model {

/// Velocity damper of the joint limits: within `interaction` of a limit (fraction of the joint's range) the speed
/// toward it is bounded so that it is never nearer than `safety`; `offset` is added to the damping.
struct JointDamper {
  double interaction = 0.1;  ///< fraction of the range
  double safety = 0.01;      ///< fraction of the range
  double offset = 0.5;       ///< rad/s

  template <class Archive>
  void fields(Archive& a) {
    a("interaction", interaction, Range::Fraction);
    a("safety", safety, Range::Fraction);
    a("offset", offset, Range::NotNegative);
  }
  bool operator==(const JointDamper&) const = default;
};

/// Two links (or "cup", the cup's shapes) that keep apart.
struct SelfCollisionPair {
  std::string link_a;
  std::string link_b;
  double interaction = 0.2;  ///< m, below this the approach is damped
  double safety = 0.1;       ///< m, never nearer
  bool operator==(const SelfCollisionPair&) const = default;
};

/// Weights and stiffnesses of the tasks. The stiffness of the tool's task is controller.task_stiffness.
struct RobotTasks {
  double tool_weight = 5.0e6;
  double posture_weight = 10.0;
  double posture_stiffness = 1.0;  ///< 1/s^2; critically damped

  template <class Archive>
  void fields(Archive& a) {
    a("tool_weight", tool_weight, Range::Positive);
    a("posture_weight", posture_weight, Range::Positive);
    a("posture_stiffness", posture_stiffness, Range::NotNegative);
  }
  bool operator==(const RobotTasks&) const = default;
};

/// Beyond any of these the run ends.
struct ProtectiveStop {
  double torque_fraction = 1.0;  ///< of each joint's effort limit in the URDF
  double sensor_force = 150.0;   ///< N, beyond the weight of the gripper
  double sensor_torque = 20.0;   ///< Nm, likewise
  double tracking_error = 0.1;   ///< rad (m) between commanded and measured joint position

  template <class Archive>
  void fields(Archive& a) {
    a("torque_fraction", torque_fraction, Range::Positive);
    a("sensor_force", sensor_force, Range::Positive);
    a("sensor_torque", sensor_torque, Range::Positive);
    a("tracking_error", tracking_error, Range::Positive);
  }
  bool operator==(const ProtectiveStop&) const = default;
};

/// Errors of the force/torque sensor; none unless asked for. Seeded by the scenario.
struct ForceSensorParams {
  double force_noise = 0.0;                ///< N, standard deviation of one sample
  double torque_noise = 0.0;               ///< Nm
  Vector3 force_bias = Vector3::Zero();    ///< N, in the sensor's frame
  Vector3 torque_bias = Vector3::Zero();   ///< Nm
  Vector3 force_drift = Vector3::Zero();   ///< N/s
  Vector3 torque_drift = Vector3::Zero();  ///< Nm/s

  template <class Archive>
  void fields(Archive& a) {
    a("force_noise", force_noise, Range::NotNegative);
    a("torque_noise", torque_noise, Range::NotNegative);
  }
  bool operator==(const ForceSensorParams&) const = default;
};

struct RobotParams {
  std::string name;  ///< for --robot; file name of the URDF unless given
  std::string urdf;  ///< as written: relative to the scenario file
  std::string tool_frame = "E";
  std::string flange_frame = "flange";
  std::string sensor_frame = "ft_sensor";
  std::optional<Pose> X_LE;              ///< E in the link `tool_frame`, of a URDF without gripper; else the link is E
  Pose X_WB;                             ///< root link of the URDF in W
  std::vector<double> posture;           ///< rad (m): target of the posture task, and nearest to it the start is chosen
  std::vector<double> joints_start;      ///< rad (m); empty: the inverse of controller.start_pose nearest to posture
  double velocity_fraction = 0.5;        ///< of the URDF's joint speeds that may be used
  double max_joint_acceleration = 15.0;  ///< rad/s^2 (m/s^2)
  JointDamper damper;
  double contact_stiffness = 5.0e4;  ///< N/m, of the arm where it touches what does not give way
  double collision_damping = 10.0;   ///< of self_collision, rad/s or m/s scale as the report's controller
  std::vector<SelfCollisionPair> self_collision;
  RobotTasks tasks;
  ProtectiveStop protective_stop;
  ForceSensorParams sensor;

  template <class Archive>
  void fields(Archive& a) {
    a("velocity_fraction", velocity_fraction, Range::Fraction);
    a("max_joint_acceleration", max_joint_acceleration, Range::Positive);
    a("damper", damper);
    a("contact_stiffness", contact_stiffness, Range::Positive);
    a("collision_damping", collision_damping, Range::Positive);
    a("tasks", tasks);
    a("protective_stop", protective_stop);
  }
  bool operator==(const RobotParams&) const = default;
};

}  // namespace snug::model
