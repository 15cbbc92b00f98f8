// UrArm: the arm of a cell in the frames and numbers of a UR controller.
#include "snug/served_ur/ur_arm.hpp"

#include <algorithm>
#include <numbers>

#include "snug/calibration/dh.hpp"
#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"

namespace snug::served_ur {
namespace {

const cell::CellArm& arm_of(const cell::Simulation& simulation) {
  SNUG_CHECK(simulation.arm() != nullptr, "a served UR has a robot");
  return *simulation.arm();
}

Pose base_in_world(const robot::ArmModel& arm) {
  const robot::ArmPose at = robot::forward(arm, robot::JointVector::Zero(arm.joint_count()));
  const int base = robot::find_link(arm, "base");
  if (base >= 0 && arm.links[static_cast<std::size_t>(base)].segment == 0) return robot::link_pose(arm, at, base);
  const int root = std::max(0, robot::find_link(arm, "base_link"));
  return robot::link_pose(arm, at, root) * Pose{exp_rotation(Vector3(0.0, 0.0, std::numbers::pi)), Vector3::Zero()};
}

int find_flange(const robot::ArmModel& arm, const model::Scenario& scenario) {
  int flange = robot::find_link(arm, "tool0");
  if (flange < 0) flange = robot::find_link(arm, scenario.robot->flange_frame);
  if (flange < 0 || arm.links[static_cast<std::size_t>(flange)].segment != arm.joint_count()) {
    throw InputError(scenario.source_name, "robot.flange_frame", scenario.robot->flange_frame,
                     "the link `tool0`, or the frame of the arm's flange");
  }
  return flange;
}

}  // namespace

ur::Values6 to_values(const Pose& pose) {
  const Vector3 turn = log_rotation(pose.R);
  return {pose.p.x(), pose.p.y(), pose.p.z(), turn.x(), turn.y(), turn.z()};
}

Pose to_pose(const ur::Values6& values) {
  return {exp_rotation(Vector3(values[3], values[4], values[5])), Vector3(values[0], values[1], values[2])};
}

robot::JointVector to_vector(const ur::Values6& values) {
  robot::JointVector joints(6);
  std::ranges::copy(values, joints.begin());
  return joints;
}

ur::Values6 to_values(const robot::JointVector& joints) {
  SNUG_CHECK(joints.size() == 6, "a UR has six joints");
  ur::Values6 values{};
  std::copy(joints.begin(), joints.end(), values.begin());
  return values;
}

UrArm::UrArm(const cell::Simulation& simulation) : UrArm(arm_of(simulation).model(), simulation.scenario()) {}

UrArm::UrArm(const robot::ArmModel& arm, const model::Scenario& scenario)
    : arm_(arm), inverse_(arm_), flange_(find_flange(arm, scenario)) {
  const calibration::DhTable dh = calibration::nominal_dh(arm_, scenario.source_name);
  for (std::size_t j = 0; j < 6; ++j) {
    const robot::Joint& joint = arm_.joints[j];
    facts_.dh_theta[j] = dh[j].theta;
    facts_.dh_d[j] = dh[j].d;
    facts_.dh_a[j] = dh[j].a;
    facts_.dh_alpha[j] = dh[j].alpha;
    facts_.joint_min[j] = std::max(joint.lower, -2.0 * std::numbers::pi);
    facts_.joint_max[j] = std::min(joint.upper, 2.0 * std::numbers::pi);
    facts_.joint_speed[j] = joint.max_speed;
    facts_.joint_acceleration[j] = scenario.robot->max_joint_acceleration;
  }
  X_WBase_ = base_in_world(arm_);
  X_FE_ = arm_.links[static_cast<std::size_t>(flange_)].X_SL.inverse() * arm_.X_SE;
  tool_load_ = robot::distal_inertia(arm_, flange_);
}

Pose UrArm::forward(const ur::Values6& q) const {
  return X_WBase_.inverse() * robot::forward_tool(arm_, to_vector(q)) * X_FE_.inverse();
}

std::optional<ur::Values6> UrArm::inverse(const Pose& X_BaseF, const ur::Values6& near) const {
  const auto q = inverse_.nearest(X_WBase_ * X_BaseF * X_FE_, to_vector(near));
  if (!q) return std::nullopt;
  return to_values(*q);
}

ur::Values6 UrArm::tcp_speed(const ur::Values6& q, const ur::Values6& qd, const Pose& X_FE) const {
  const robot::ArmPose at = robot::forward(arm_, to_vector(q));
  const Twist V_WE = twist_from(robot::tool_jacobian(arm_, at) * to_vector(qd));
  const Vector3 p_EoTo_W = at.X_WE.R * (X_FE_.inverse() * X_FE.p);
  const Vector3 v = X_WBase_.R.transpose() * (V_WE.linear + V_WE.angular.cross(p_EoTo_W));
  const Vector3 w = X_WBase_.R.transpose() * V_WE.angular;
  return {v.x(), v.y(), v.z(), w.x(), w.y(), w.z()};
}

}  // namespace snug::served_ur
