// UrArm: the arm of a cell in the frames and numbers of a UR controller.
#pragma once

#include <optional>

#include "snug/cell/simulation.hpp"
#include "snug/robot/inverse.hpp"
#include "snug/ur/robot_data.hpp"

namespace snug::served_ur {

/// Base: the controller's base, the link `base` of the URDF, or base_link turned by pi about z. F: the flange, the link
/// `tool0`, or the scenario's flange_frame. Joints are those of the arm, base to tool.
class UrArm {
 public:
  /// Throws InputError for an arm that is not built as a UR: six joints between frames of a DH chain.
  explicit UrArm(const cell::Simulation& simulation);
  /// The same of the arm of a scenario with a robot, which has to outlive this.
  UrArm(const robot::ArmModel& arm, const model::Scenario& scenario);

  [[nodiscard]] const ur::RobotFacts& facts() const { return facts_; }
  [[nodiscard]] const robot::ArmModel& model() const { return arm_; }
  /// X_FE: the tool's end, where the controller's TCP is at first.
  [[nodiscard]] const Pose& tool() const { return X_FE_; }
  /// Of everything behind the flange, in F.
  [[nodiscard]] const SpatialInertia& tool_load() const { return tool_load_; }
  [[nodiscard]] const Pose& base() const { return X_WBase_; }

  /// X_BaseF.
  [[nodiscard]] Pose forward(const ur::Values6& q) const;
  /// The joints for X_BaseF that are nearest to `near` and within their limits; none: out of reach.
  [[nodiscard]] std::optional<ur::Values6> inverse(const Pose& X_BaseF, const ur::Values6& near) const;
  /// Of a TCP at X_FE: linear and angular, in Base.
  [[nodiscard]] ur::Values6 tcp_speed(const ur::Values6& q, const ur::Values6& qd, const Pose& X_FE) const;

 private:
  const robot::ArmModel& arm_;
  robot::InverseKinematics inverse_;
  ur::RobotFacts facts_;
  int flange_ = -1;
  Pose X_WBase_;  ///< the scenario's world is snug's W
  Pose X_FE_;
  SpatialInertia tool_load_;
};

/// Position [m] and rotation vector [rad], as UR writes poses.
[[nodiscard]] ur::Values6 to_values(const Pose& pose);
[[nodiscard]] Pose to_pose(const ur::Values6& values);
[[nodiscard]] robot::JointVector to_vector(const ur::Values6& values);
[[nodiscard]] ur::Values6 to_values(const robot::JointVector& joints);

}  // namespace snug::served_ur
