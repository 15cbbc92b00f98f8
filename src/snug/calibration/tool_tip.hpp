// Tool tip: where the tip of a tool is, from poses of the flange in which it touched one and the same point.
#pragma once

#include "snug/core/table.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::calibration {

struct ToolTip {
  Vector3 p_FQ = Vector3::Zero();        ///< m, tip in the flange's frame
  Matrix3 covariance = Matrix3::Zero();  ///< m^2
  Vector3 p_WQ = Vector3::Zero();        ///< m, the point touched, in the frame of the poses
  Matrix3 point_covariance = Matrix3::Zero();
  double noise = 0.0;  ///< m, standard deviation of one touch, each axis
};

/// Columns x,y,z,rx,ry,rz: pose of the flange. Least squares of R p_FQ + p - p_WQ. InputError when there are fewer than
/// four poses, when all turn about one axis so that the tip along it is not determined, or when some do not belong to
/// the rest (the lines are named).
[[nodiscard]] ToolTip find_tool_tip(const Table& flange_poses);

/// Columns that find_tool_tip needs.
[[nodiscard]] std::vector<std::string> tool_tip_columns();

}  // namespace snug::calibration
