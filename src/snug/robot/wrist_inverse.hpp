// WristGeometry: the ideal arm nearest to one with a spherical wrist, and its inverse in closed form.
#pragma once

#include <array>
#include <optional>

#include "snug/robot/arm.hpp"
#include "snug/robot/ur_inverse.hpp"

namespace snug::robot {

/// An ideal arm at q = 0, in the root link: six axes that turn, the second and third parallel and at a right angle to
/// the first, the last three through one point. Offsets between the axes are free: most arms of industry that are not
/// UR-like are so. The first three joints move the wrist's point, the others turn about it (Pieper 1968).
struct WristGeometry {
  std::array<Vector3, 6> axis;         ///< unit
  std::array<Vector3, 3> point;        ///< m, on the first three axes
  Vector3 wrist = Vector3::Zero();     ///< m, where the last three meet
  Matrix3 R_BE = Matrix3::Identity();  ///< of E at q = 0
  Vector3 p_EC_E = Vector3::Zero();    ///< m, from E to the wrist's point, in E
};

/// Nothing when the arm is not such a one, up to 3 degrees and 20 mm.
[[nodiscard]] std::optional<WristGeometry> find_wrist_geometry(const ArmModel& arm);

/// All branches of the ideal arm for a pose of E in the root link, as solve_ur.
[[nodiscard]] ClosedBranches solve_wrist_arm(const WristGeometry& arm, const Pose& X_BE, double q6,
                                             double slack) noexcept;

}  // namespace snug::robot
