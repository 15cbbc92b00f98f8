// Rpy: a rotation as roll, pitch, yaw: the protocol does not say in which order they apply, so a user can.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "snug/spatial/pose.hpp"

namespace snug::click {

/// About which fixed axis one turns first, second and last: {0, 1, 2} is R = Rz(yaw) Ry(pitch) Rx(roll), that of URDF.
/// The same as the opposite order about axes that turn along.
struct RpyOrder {
  std::array<int, 3> axes = {0, 1, 2};
  bool operator==(const RpyOrder&) const = default;
};

/// "xyz", "zyx" and the four others; nothing for other words.
[[nodiscard]] std::optional<RpyOrder> parse_rpy_order(std::string_view word);

/// Angles about x, y and z [rad]: the second of the order within +-pi/2, the others within +-pi. Where the second is
/// +-pi/2 and the others turn about the same line, the first is 0.
[[nodiscard]] Vector3 rpy_of(const Matrix3& R, const RpyOrder& order);
[[nodiscard]] Matrix3 rotation_of(const Vector3& rpy, const RpyOrder& order);

}  // namespace snug::click
