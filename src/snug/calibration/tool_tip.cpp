// Tool tip from touches of one point: linear least squares.
#include "snug/calibration/tool_tip.hpp"

#include "snug/calibration/internal/complaints.hpp"
#include "snug/calibration/internal/frames.hpp"
#include "snug/calibration/internal/linear_fit.hpp"
#include "snug/calibration/internal/pose_row.hpp"
#include "snug/core/input_error.hpp"

namespace snug::calibration {

std::vector<std::string> tool_tip_columns() { return {"x", "y", "z", "rx", "ry", "rz"}; }

ToolTip find_tool_tip(const Table& table) {
  internal::check_count(table, 4, "touches of the point");
  internal::check_poses(table, 0);
  const auto rows = static_cast<Eigen::Index>(table.rows.size());
  Eigen::MatrixXd A(3 * rows, 6);
  Eigen::VectorXd b(3 * rows);
  for (Eigen::Index k = 0; k < rows; ++k) {
    const Pose X_WF = internal::row_pose(table.rows[static_cast<std::size_t>(k)], 0);
    A.block<3, 3>(3 * k, 0) = X_WF.R;
    A.block<3, 3>(3 * k, 3) = -Matrix3::Identity();
    b.segment<3>(3 * k) = -X_WF.p;
  }
  const internal::LinearFit fit = internal::fit_linear(A, b, 3);
  // Turned by an angle t to either side of the middle, the poses have a spread of about t; 3 degrees is too little.
  if (fit.spread < 0.05) {
    const Vector3 along = fit.weakest.head<3>().normalized();
    throw InputError(
        table.name, "", "poses that all have nearly the same direction " + internal::to_text(along) + " of the flange",
        "poses turned about more than one axis, by 20 degrees or more: else the tip along it is not determined");
  }
  internal::check_outliers(table, fit.outliers);
  ToolTip tip;
  tip.p_FQ = fit.x.head<3>();
  tip.p_WQ = fit.x.tail<3>();
  if (!(tip.p_FQ.norm() <= internal::kLongestTool))
    throw InputError(table.name, "", "a tip at " + internal::to_text(tip.p_FQ) + " m of the flange",
                     "poses in metres and radians that put it within " + internal::to_text(internal::kLongestTool) +
                         " m of the flange");
  tip.covariance = fit.covariance.topLeftCorner<3, 3>();
  tip.point_covariance = fit.covariance.bottomRightCorner<3, 3>();
  tip.noise = fit.sigma;
  return tip;
}

}  // namespace snug::calibration
