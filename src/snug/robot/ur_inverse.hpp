// UrGeometry: the ideal arm nearest to a UR-like one, and its inverse in closed form.
#pragma once

#include <array>
#include <optional>

#include "snug/robot/arm.hpp"

namespace snug::robot {

/// An ideal arm at q = 0, in frame 0: z0 is the first axis, y0 the negative of the second, the origin where they meet.
/// The plane of the arm is spanned by x0 and z0; turns about the second axis, u = -y0, take x0 to z0 and count as
/// plane angles. docs/theory/robot.md derives the inverse.
struct UrGeometry {
  Pose X_B0;                      ///< frame 0 in the root link
  std::array<double, 6> sign{};   ///< of joints 2 to 4: +1 when their axis points along u (others +1)
  double upper_arm = 0.0;         ///< m, axis 2 to axis 3 in the plane
  double forearm = 0.0;           ///< m, axis 3 to axis 4
  double angle_upper_arm = 0.0;   ///< rad, plane angle of the upper arm at q = 0
  double angle_forearm = 0.0;     ///< rad
  double offset = 0.0;            ///< m, of the wrist along u (d4)
  double wrist = 0.0;             ///< m, along axis 5, from axis 4 to axis 6 (d5)
  Vector3 z5 = Vector3::UnitX();  ///< axis 5, in frame 0; at a right angle to u
  Vector3 z6 = Vector3::UnitX();  ///< axis 6; at a right angle to z5
  double angle_z6 = 0.0;          ///< rad, of z6 about z5, from u
  Matrix3 R_0E = Matrix3::Identity();
  Vector3 p_E6_E = Vector3::Zero();  ///< m, from E to the point where axes 5 and 6 meet, in E
};

/// Nothing when the arm is not UR-like (inverse.hpp).
[[nodiscard]] std::optional<UrGeometry> find_ur_geometry(const ArmModel& arm);

struct ClosedBranches {
  std::array<std::array<double, 6>, 8> q;
  int count = 0;
  double shortfall = 0.0;  ///< m, as in IkBranches
};

/// All branches of the ideal arm for a pose of E in the root link. Where the pose is beyond reach by less than `slack`
/// [m], the nearest stretched or folded arm is given, for the exact arm may reach. `q6` is used where joint 6 is free.
[[nodiscard]] ClosedBranches solve_ur(const UrGeometry& arm, const Pose& X_BE, double q6, double slack) noexcept;

}  // namespace snug::robot
