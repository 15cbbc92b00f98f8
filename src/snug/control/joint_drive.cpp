// JointDrive: how the joints of an arm follow targets for their position, speed or torque within what the drives can
// do.
#include "snug/control/joint_drive.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "snug/core/check.hpp"
#include "snug/robot/dynamics.hpp"

namespace snug::control {
namespace {

using robot::JointVector;

// Part of the acceleration that a joint counts on when it brakes toward a position or an end of its range: the rest
// takes up that speeds are chosen once a tick.
constexpr double kBrakingPart = 0.8;

}  // namespace

double stopping_speed(double room, double deceleration, double dt) noexcept {
  return deceleration * (std::sqrt(dt * dt + 2.0 * room / deceleration) - dt);
}

JointDrive::JointDrive(const robot::ArmModel& arm, double max_acceleration, double tick)
    : joints_(arm.joints), max_acceleration_(max_acceleration), tick_(tick) {
  SNUG_CHECK(max_acceleration > 0.0 && tick > 0.0, "a drive needs an acceleration and a tick");
}

double JointDrive::reachable_speed(int j, double wanted, const JointMotion& motion) const {
  const robot::Joint& joint = joints_[static_cast<std::size_t>(j)];
  double speed = std::clamp(wanted, -joint.max_speed, joint.max_speed);
  const double room = speed > 0.0 ? joint.upper - motion.q[j] : motion.q[j] - joint.lower;
  if (std::isfinite(room)) {
    const double used = 0.5 * tick_ * std::max(0.0, speed > 0.0 ? motion.qd[j] : -motion.qd[j]);  // by what it has
    const double fastest = stopping_speed(std::max(0.0, room - used), kBrakingPart * max_acceleration_, tick_);
    speed = std::clamp(speed, -fastest, fastest);
  }
  const double most = max_acceleration_ * tick_;
  const double change = speed - motion.qd[j];
  return std::abs(change) > most ? motion.qd[j] + std::copysign(most, change) : speed;
}

void JointDrive::move_by_speed(int j, double target, JointMotion& motion, JointWay& way) const {
  const double speed = reachable_speed(j, target, motion);
  way.v[j] = motion.qd[j];
  way.a[j] = motion.qdd[j] = (speed - motion.qd[j]) / tick_;
  motion.q[j] += tick_ * (motion.qd[j] + 0.5 * tick_ * motion.qdd[j]);
  motion.qd[j] = speed;
}

void JointDrive::move_to_position(int j, double target, double before, JointMotion& motion, JointWay& way) const {
  const double behind = before - motion.q[j];  // of where it should have been by now
  const double catch_up = stopping_speed(std::abs(behind), kBrakingPart * max_acceleration_, tick_);
  const bool is_near = std::abs(behind) <= 0.5 * kBrakingPart * max_acceleration_ * tick_ * tick_;
  const double direct = (target - motion.q[j]) / tick_;
  const double wanted = is_near ? direct : (target - before) / tick_ + std::copysign(catch_up, behind);
  const double speed = reachable_speed(j, wanted, motion);
  motion.qdd[j] = (speed - motion.qd[j]) / tick_;
  motion.q[j] = is_near && speed == direct ? target : motion.q[j] + tick_ * speed;
  motion.qd[j] = way.v[j] = speed;
  way.a[j] = 0.0;
}

JointWay JointDrive::follow_speed(const JointVector& target, JointMotion& motion) const {
  JointWay way{motion.qd, motion.qdd};
  for (int j = 0; j < static_cast<int>(motion.q.size()); ++j) move_by_speed(j, target[j], motion, way);
  return way;
}

JointWay JointDrive::follow(const DriveCommand& command, JointVector& position_before, JointMotion& motion) const {
  if (position_before.size() != motion.q.size()) position_before = motion.q;
  JointWay way{JointVector::Zero(motion.q.size()), JointVector::Zero(motion.q.size())};
  for (int j = 0; j < static_cast<int>(motion.q.size()); ++j) {
    const DriveKind kind = command.kinds[static_cast<std::size_t>(j)];
    if (kind == DriveKind::Position) {
      move_to_position(j, command.target[j], position_before[j], motion, way);
    } else if (kind == DriveKind::Speed) {
      move_by_speed(j, command.target[j], motion, way);
    }
    position_before[j] = kind == DriveKind::Position ? command.target[j] : motion.q[j];
  }
  return way;
}

JointVector compute_torque_accelerations(const robot::ArmModel& arm, const DriveCommand& command,
                                         const JointMotion& motion, const JointVector& torques_felt,
                                         const Vector3& gravity_W) {
  const auto n = static_cast<int>(motion.q.size());
  JointVector known = motion.qdd;
  std::array<int, robot::kMaxJoints> free{};
  int count = 0;
  for (int j = 0; j < n; ++j) {
    if (command.kinds[static_cast<std::size_t>(j)] != DriveKind::Torque) continue;
    free[static_cast<std::size_t>(count++)] = j;
    known[j] = 0.0;
  }
  const JointVector rest =
      command.target + torques_felt - robot::inverse_dynamics(arm, {motion.q, motion.qd, known}, Wrench{}, gravity_W);
  const robot::JointMatrix M = robot::mass_matrix(arm, motion.q);
  robot::JointMatrix M_free(count, count);
  JointVector rest_free(count);
  for (int a = 0; a < count; ++a) {
    const int row = free[static_cast<std::size_t>(a)];
    rest_free[a] = rest[row];
    for (int b = 0; b < count; ++b) M_free(a, b) = M(row, free[static_cast<std::size_t>(b)]);
  }
  const JointVector accelerations_free = M_free.ldlt().solve(rest_free);
  for (int a = 0; a < count; ++a) known[free[static_cast<std::size_t>(a)]] = accelerations_free[a];
  return known;
}

}  // namespace snug::control
