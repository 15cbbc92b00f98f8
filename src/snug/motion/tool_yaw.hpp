// Tool yaw: how a tool that points down is turned about the vertical.
#pragma once

#include <optional>

#include "snug/spatial/pose.hpp"

namespace snug::motion {

/// Yaw [rad, in (-pi, pi]] of a tool that points down: R_WE = Rz(yaw) Ry(pi), whatever little it is tilted. Nothing
/// where it is tilted by more than 30 degrees.
[[nodiscard]] std::optional<double> yaw_of(const Matrix3& R_WE);

/// R_WE of a tool that points straight down: Rz(yaw) Ry(pi).
[[nodiscard]] Matrix3 upright_tool(double yaw);

}  // namespace snug::motion
