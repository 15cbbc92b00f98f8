// Small helpers that all calibrations share: turns about axes, joint origins, files.
#pragma once

#include <string>

#include "snug/robot/arm.hpp"

namespace snug::calibration::internal {

[[nodiscard]] Matrix3 turn_x(double angle);
[[nodiscard]] Matrix3 turn_z(double angle);
/// Angles of R = Rz(yaw) Ry(pitch) Rx(roll), as a URDF writes them; roll, pitch, yaw.
[[nodiscard]] Vector3 urdf_angles(const Matrix3& R);
/// Angles of R = Rx(a) Ry(b) Rz(c).
[[nodiscard]] Vector3 euler_xyz_angles(const Matrix3& R);
[[nodiscard]] Matrix3 from_urdf_angles(const Vector3& rpy);
[[nodiscard]] Matrix3 from_euler_xyz_angles(const Vector3& abc);

/// <origin> of joint i: its frame in the link it is fixed to.
[[nodiscard]] Pose joint_origin(const robot::ArmModel& arm, std::size_t joint);
/// Index of the link that joint i is fixed to.
[[nodiscard]] int joint_parent(const robot::ArmModel& arm, std::size_t joint);

/// Index of the first link of the last segment, the child of the last joint.
[[nodiscard]] int last_link(const robot::ArmModel& arm);
/// Moves everything that is fixed to the first link of the last segment: X_SL becomes move * X_SL.
void move_end(robot::ArmModel& arm, const Pose& move);

/// Seventeen digits: reads back as the same number.
[[nodiscard]] std::string to_text(double value);

}  // namespace snug::calibration::internal
