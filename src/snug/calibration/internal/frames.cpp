// Small helpers that all calibrations share.
#include "snug/calibration/internal/frames.hpp"

#include <charconv>
#include <cmath>

#include "snug/core/check.hpp"

namespace snug::calibration::internal {

Matrix3 turn_x(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return (Matrix3() << 1, 0, 0, 0, c, -s, 0, s, c).finished();
}

Matrix3 turn_z(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return (Matrix3() << c, -s, 0, s, c, 0, 0, 0, 1).finished();
}

static Matrix3 turn_y(double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return (Matrix3() << c, 0, s, 0, 1, 0, -s, 0, c).finished();
}

Vector3 urdf_angles(const Matrix3& R) {
  const double cosine = std::hypot(R(0, 0), R(1, 0));
  const double pitch = std::atan2(-R(2, 0), cosine);
  // Pitch of a quarter turn: only roll and yaw together are fixed; yaw 0 is chosen.
  if (cosine < 1e-12) return {std::atan2(-R(1, 2), R(1, 1)), pitch, 0.0};
  return {std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))};
}

Vector3 euler_xyz_angles(const Matrix3& R) {
  const double cosine = std::hypot(R(1, 2), R(2, 2));
  const double middle = std::atan2(R(0, 2), cosine);
  if (cosine < 1e-12) return {std::atan2(R(1, 0), R(1, 1)), middle, 0.0};
  return {std::atan2(-R(1, 2), R(2, 2)), middle, std::atan2(-R(0, 1), R(0, 0))};
}

Matrix3 from_urdf_angles(const Vector3& rpy) { return turn_z(rpy.z()) * turn_y(rpy.y()) * turn_x(rpy.x()); }

Matrix3 from_euler_xyz_angles(const Vector3& abc) { return turn_x(abc.x()) * turn_y(abc.y()) * turn_z(abc.z()); }

int joint_parent(const robot::ArmModel& arm, std::size_t joint) {
  for (const robot::Link& link : arm.links)
    if (link.segment == static_cast<int>(joint) + 1) return link.parent;  // the first of a segment is the joint's child
  SNUG_CHECK(false, "every joint has a child link");
}

Pose joint_origin(const robot::ArmModel& arm, std::size_t joint) {
  const robot::Link& parent = arm.links[static_cast<std::size_t>(joint_parent(arm, joint))];
  return parent.X_SL.inverse() * arm.joints[joint].X_SJ;
}

int last_link(const robot::ArmModel& arm) {
  int i = 0;
  while (arm.links[static_cast<std::size_t>(i)].segment != arm.last_segment()) ++i;
  return i;
}

void move_end(robot::ArmModel& arm, const Pose& move) {
  const int first = last_link(arm);
  for (std::size_t i = static_cast<std::size_t>(first) + 1; i < arm.links.size(); ++i)
    if (arm.links[i].segment == arm.last_segment()) arm.links[i].X_SL = move * arm.links[i].X_SL;
  if (arm.tool_link != first) arm.X_SE = move * arm.X_SE;
}

std::string to_text(double value) {
  char buffer[40];
  const auto [end, error] = std::to_chars(buffer, buffer + sizeof buffer, value == 0.0 ? 0.0 : value);
  return {buffer, end};
}

}  // namespace snug::calibration::internal
