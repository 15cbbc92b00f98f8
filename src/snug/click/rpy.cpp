// Rpy: a rotation as roll, pitch, yaw: the protocol does not say in which order they apply, so a user can.
#include "snug/click/rpy.hpp"

#include <algorithm>
#include <cmath>

namespace snug::click {
namespace {

// Of the cosine of the second angle: below, the first and the last turn about the same line.
constexpr double kLocked = 1e-9;

}  // namespace

std::optional<RpyOrder> parse_rpy_order(std::string_view word) {
  std::string letters(word);
  std::sort(letters.begin(), letters.end());
  if (letters != "xyz") return std::nullopt;
  return RpyOrder{{word[0] - 'x', word[1] - 'x', word[2] - 'x'}};
}

Vector3 rpy_of(const Matrix3& R, const RpyOrder& order) {
  const auto [first, second, last] = order.axes;  // R = R_last R_second R_first
  const double sign = (second - last + 3) % 3 == 1 ? 1.0 : -1.0;
  const double sine = std::clamp(sign * R(last, first), -1.0, 1.0);
  Vector3 angles;
  angles[second] = std::asin(sine);
  if (std::sqrt(1.0 - sine * sine) > kLocked) {
    angles[last] = std::atan2(-sign * R(second, first), R(first, first));
    angles[first] = std::atan2(-sign * R(last, second), R(last, last));
  } else {
    angles[first] = 0.0;
    angles[last] = std::atan2(sign * R(first, second), R(second, second));
  }
  return angles;
}

Matrix3 rotation_of(const Vector3& rpy, const RpyOrder& order) {
  Matrix3 R = Matrix3::Identity();
  for (const int axis : order.axes) R = Eigen::AngleAxisd(rpy[axis], Vector3::Unit(axis)).toRotationMatrix() * R;
  return R;
}

}  // namespace snug::click
