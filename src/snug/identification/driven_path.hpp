// DrivenPath: where a body that the recording drives was, without the noise of single samples.
#pragma once

#include <string>
#include <vector>

#include "snug/core/rng.hpp"
#include "snug/identification/recorded_motion.hpp"
#include "snug/model/pose_path.hpp"
#include "snug/numerics/smoothed_samples.hpp"

namespace snug::identification {

/// Origin (m, in W) and quaternion of the samples in which the body was seen, each smoothed as far as cross-validation
/// says that it is noise.
struct DrivenPath {
  std::string body;
  numerics::SmoothedSamples position;  ///< n x 3
  numerics::SmoothedSamples rotation;  ///< n x 4, w, x, y, z, of unit length but for the smoothing
  [[nodiscard]] double position_noise() const { return position.noise; }        ///< m, of each axis of a sample
  [[nodiscard]] double rotation_noise() const { return 2.0 * rotation.noise; }  ///< rad, the same
};

/// `times`: s, as many as poses; the body was seen in at least one.
[[nodiscard]] DrivenPath smooth_path(const std::vector<double>& times, const RecordedBody& recorded);
/// The same from samples that are off the path by new noise: how far noise moves the path.
[[nodiscard]] DrivenPath draw_again(const DrivenPath& path, Rng& rng);
/// The same from samples that are on the path: how far smoothing moves it where it bends.
[[nodiscard]] DrivenPath smooth_again(const DrivenPath& path);
/// The path with so much of how far each of some others at the same times is off it.
[[nodiscard]] DrivenPath moved_towards(const DrivenPath& path, const std::vector<DrivenPath>& others,
                                       const Eigen::VectorXd& shares);
/// `origin`: s, of the recording's clock at time 0 of the path.
[[nodiscard]] model::PosePath pose_path_of(const DrivenPath& path, double origin);

}  // namespace snug::identification
