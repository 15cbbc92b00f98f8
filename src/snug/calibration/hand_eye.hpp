// Hand-eye: where a camera that stands in the cell is, from poses of a board, or of a box, that the robot holds before
// it.
#pragma once

#include "snug/core/table.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::calibration {

struct HandEye {
  Pose X_WC;  ///< camera in the frame of the robot's poses
  Pose X_EB;  ///< board in the tool
  /// Of X_WC: [translation, m; rotation vector, rad], both in W, the rotation about the camera's origin.
  Matrix6 covariance = Matrix6::Zero();
  Matrix6 board_covariance = Matrix6::Zero();  ///< of X_EB, in E
  double position_noise = 0.0;                 ///< m, standard deviation of one measured pose, each coordinate
  double angle_noise = 0.0;                    ///< rad, about each axis
};

/// Columns x,y,z,rx,ry,rz: pose of the tool in W; cx,cy,cz,crx,cry,crz: pose of the board in C, as the camera measured
/// it (m; rotation vectors, rad). Least squares of X_WE X_EB = X_WC X_CB, weighed by what is left over. InputError when
/// there are fewer than four rows, when the tool is turned about fewer than two axes, or when some rows do not belong
/// to the rest (the lines are named).
[[nodiscard]] HandEye find_hand_eye(const Table& poses);

/// Columns that find_hand_eye needs.
[[nodiscard]] std::vector<std::string> hand_eye_columns();

}  // namespace snug::calibration
