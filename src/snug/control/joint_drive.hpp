// JointDrive: how the joints of an arm follow targets for their position, speed or torque within what the drives can
// do.
#pragma once

#include <cstdint>
#include <vector>

#include "snug/robot/kinematics.hpp"

namespace snug::control {

/// Where the joints are and how they move.
struct JointMotion {
  robot::JointVector q;    ///< rad (m)
  robot::JointVector qd;   ///< rad/s (m/s)
  robot::JointVector qdd;  ///< over the last tick, rad/s^2 (m/s^2)
  bool operator==(const JointMotion&) const = default;
};

/// What a target is for.
enum class DriveKind : std::uint8_t { Position, Speed, Torque };

/// A target for each joint, for the end of the coming tick (Position, Speed) or throughout it (Torque).
struct DriveCommand {
  std::vector<DriveKind> kinds;
  robot::JointVector target;  ///< rad, rad/s, Nm (m, m/s, N)
};

/// The way of the joints within a tick: q + t (v + t a / 2). That of joints under torque is not known before: there it
/// stands still.
struct JointWay {
  robot::JointVector v;  ///< rad/s (m/s)
  robot::JointVector a;  ///< rad/s^2 (m/s^2)
};

/// The largest speed from which `room` [rad or m] >= 0 is enough to stop with `deceleration`, speeds held for `dt`.
[[nodiscard]] double stopping_speed(double room, double deceleration, double dt) noexcept;

class JointDrive {
 public:
  /// `max_acceleration`: rad/s^2 (m/s^2), of every joint. Speeds and ranges are those of the arm.
  JointDrive(const robot::ArmModel& arm, double max_acceleration, double tick);

  [[nodiscard]] double tick() const { return tick_; }

  /// One tick toward a speed of each joint: as much of the change as the acceleration allows, never faster than the
  /// joint can, and so that it stops at the end of its range. `motion` is then that at the end of the tick.
  JointWay follow_speed(const robot::JointVector& target, JointMotion& motion) const;

  /// One tick toward mixed targets. `position_before`: the position targets of the tick before (where the joints were,
  /// when there are none); brought up to date. A joint whose target moves no faster than it can is exactly there at the
  /// end of the tick; one that has to catch up brakes in time. Joints under torque keep their q and qd.
  JointWay follow(const DriveCommand& command, robot::JointVector& position_before, JointMotion& motion) const;

 private:
  /// `wanted`, as far as speed, range and acceleration of joint j allow.
  [[nodiscard]] double reachable_speed(int j, double wanted, const JointMotion& motion) const;
  void move_by_speed(int j, double target, JointMotion& motion, JointWay& way) const;
  void move_to_position(int j, double target, double before, JointMotion& motion, JointWay& way) const;

  std::vector<robot::Joint> joints_;
  double max_acceleration_;
  double tick_;
};

/// Accelerations of the joints under torque: M(q) qdd + C(q, qd) qd + G(q) = tau + `torques_felt`, for these rows, the
/// other joints accelerating as `motion.qdd` says. `torques_felt`: what contacts apply, at the joints. No friction, no
/// rotor inertia (docs/theory/robot.md).
[[nodiscard]] robot::JointVector compute_torque_accelerations(const robot::ArmModel& arm, const DriveCommand& command,
                                                              const JointMotion& motion,
                                                              const robot::JointVector& torques_felt,
                                                              const Vector3& gravity_W);

}  // namespace snug::control
