// Identification of an arm's geometry from measured poses of its end (report eq. 15).
#pragma once

#include <string>
#include <vector>

#include "snug/core/table.hpp"
#include "snug/robot/arm.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::calibration {

/// Joints and where the end was measured to be.
struct PosePairs {
  Table table;
  std::vector<robot::JointVector> q;
  std::vector<Pose> X_BF;  ///< pose of the measured link in the base link
};

/// Columns q1 .. qn (rad, m), x, y, z (m), rx, ry, rz (rotation vector, rad).
[[nodiscard]] PosePairs load_pose_pairs(const std::filesystem::path& path, const robot::ArmModel& arm);
[[nodiscard]] PosePairs make_pose_pairs(Table table, const robot::ArmModel& arm);

/// Which links the poses are of.
struct MeasuredFrames {
  int base = 0;  ///< link that belongs to segment 0
  int end = 0;   ///< link that belongs to the last segment
};

/// Deviations of an arm: for each joint the line of its axis (two shifts, two turns across the nominal axis, in the
/// nominal frame that the joint before carries), then shift and turn of the end. The smallest set that describes every
/// deviation of an arm, and none of it grows where axes are parallel, as a DH parameter would.
[[nodiscard]] int deviation_count(const robot::ArmModel& arm);
[[nodiscard]] robot::ArmModel with_deviations(const robot::ArmModel& nominal, const Eigen::VectorXd& deviations);
/// "elbow_joint: turn about x" and the like.
[[nodiscard]] std::string deviation_name(const robot::ArmModel& arm, int index);

struct IdentifiedArm {
  robot::ArmModel arm;               ///< frames near nominal (exact_arm.hpp)
  Eigen::VectorXd deviations;        ///< m and rad
  Eigen::MatrixXd covariance;        ///< of the deviations
  double position_noise = 0.0;       ///< m, standard deviation of a measurement, each axis
  double angle_noise = 0.0;          ///< rad
  double rms_position = 0.0;         ///< m, of what is left
  double rms_angle = 0.0;            ///< rad
  double rms_position_before = 0.0;  ///< m, of the nominal arm
  double rms_angle_before = 0.0;     ///< rad
  int iterations = 0;
};

/// Least squares over all pairs; noise of positions and of angles is estimated from the residuals and weighs them.
/// InputError when there are too few pairs, when they leave a deviation undetermined (it is named), when the fit does
/// not converge, or when some rows do not belong to the rest (the lines are named).
[[nodiscard]] IdentifiedArm identify_arm(const robot::ArmModel& nominal, const PosePairs& pairs,
                                         const MeasuredFrames& frames);

}  // namespace snug::calibration
