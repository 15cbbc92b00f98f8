// Averages: the mean of poses that may be lost, the median of numbers.
#include "snug/validation/internal/averages.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace snug::validation::internal {

std::optional<Pose> mean_pose(std::span<const record::PoseSample> poses, double least_tracked) {
  Vector3 p = Vector3::Zero();
  Eigen::Vector4d q = Eigen::Vector4d::Zero();
  double count = 0.0;
  for (const record::PoseSample& pose : poses) {
    if (!record::is_tracked(pose)) continue;
    p += pose.p;
    q += (pose.quat.coeffs().dot(q) < 0.0 ? -1.0 : 1.0) * pose.quat.coeffs();
    count += 1.0;
  }
  if (count == 0.0 || count < least_tracked * static_cast<double>(poses.size())) return std::nullopt;
  return Pose{Quaternion(q.normalized()).toRotationMatrix(), p / count};
}

MeanPoseError find_mean_error(std::span<const record::PoseSample> poses, const Pose& mean) {
  double position = 0.0, rotation = 0.0, count = 0.0;
  for (const record::PoseSample& pose : poses) {
    if (!record::is_tracked(pose)) continue;
    position += (pose.p - mean.p).squaredNorm();
    rotation += log_rotation(mean.R.transpose() * pose.pose().R).squaredNorm();
    count += 1.0;
  }
  const double squares = 3.0 * count * std::max(1.0, count - 1.0);
  return {std::sqrt(position / squares), std::sqrt(rotation / squares)};
}

double median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace snug::validation::internal
