// DrivenPath: smoothed positions and quaternions.
#include "snug/identification/driven_path.hpp"

#include <Eigen/Geometry>

namespace snug::identification {
namespace {

numerics::SmoothedSamples with_noise(const numerics::SmoothedSamples& smoothed, Rng& rng) {
  Eigen::MatrixXd samples = smoothed.values;
  for (Eigen::Index i = 0; i < samples.rows(); ++i)
    for (Eigen::Index j = 0; j < samples.cols(); ++j) samples(i, j) += smoothed.noise * rng.normal();
  return numerics::smooth_alike(smoothed, samples);
}

}  // namespace

DrivenPath smooth_path(const std::vector<double>& times, const RecordedBody& recorded) {
  std::vector<double> seen;
  Eigen::MatrixXd p(static_cast<Eigen::Index>(times.size()), 3), q(p.rows(), 4);
  Eigen::Index n = 0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (!record::is_tracked(recorded.poses[k])) continue;
    const Pose pose = recorded.poses[k].pose();
    const Quaternion turn(pose.R);
    seen.push_back(times[k]);
    p.row(n) = pose.p.transpose();
    q.row(n) << turn.w(), turn.x(), turn.y(), turn.z();
    if (n > 0 && q.row(n).dot(q.row(n - 1)) < 0.0) q.row(n) *= -1.0;
    ++n;
  }
  return {recorded.body, numerics::smooth_samples(seen, p.topRows(n)), numerics::smooth_samples(seen, q.topRows(n))};
}

DrivenPath draw_again(const DrivenPath& path, Rng& rng) {
  return {path.body, with_noise(path.position, rng), with_noise(path.rotation, rng)};
}

DrivenPath smooth_again(const DrivenPath& path) {
  return {path.body, numerics::smooth_alike(path.position, path.position.values),
          numerics::smooth_alike(path.rotation, path.rotation.values)};
}

DrivenPath moved_towards(const DrivenPath& path, const std::vector<DrivenPath>& others, const Eigen::VectorXd& shares) {
  DrivenPath result = path;
  for (Eigen::Index k = 0; k < shares.size(); ++k) {
    const DrivenPath& other = others[static_cast<std::size_t>(k)];
    result.position.values += shares[k] * (other.position.values - path.position.values);
    result.rotation.values += shares[k] * (other.rotation.values - path.rotation.values);
  }
  return result;
}

model::PosePath pose_path_of(const DrivenPath& driven, double origin) {
  model::PosePath path;
  for (std::size_t k = 0; k < driven.position.times.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    const Vector3 p = driven.position.values.row(row).transpose();
    const Eigen::Vector4d q = driven.rotation.values.row(row).transpose();
    path.points.push_back(
        {driven.position.times[k] - origin, {Quaternion(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix(), p}});
  }
  return path;
}

}  // namespace snug::identification
