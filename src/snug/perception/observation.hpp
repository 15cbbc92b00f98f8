// Observation: what a look at the cell tells: poses with covariance, sizes where they were measured, what was not seen.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/camera/common_error.hpp"
#include "snug/perception/obstacle.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::perception {

using camera::CommonError;

/// One box as it was seen.
struct PoseEstimate {
  std::string item;  ///< id
  Pose X_WP;
  /// Of the error (p in W [m], rotation vector in W [rad]), linear first, as `as_vector` orders twists.
  Matrix6 covariance = Matrix6::Zero();
  std::optional<Vector3> size;  ///< m, along Px, Py, Pz, where it was measured
  double size_deviation = 0.0;  ///< m, standard deviation of each edge of `size`
  /// What part of the error is common: its product with its transpose is a part of `covariance`.
  CommonError common = CommonError::Zero();
  bool operator==(const PoseEstimate&) const = default;
};

/// Why a look tells nothing of what it was to show.
enum class LookFault {
  None,
  TooFewPoints,  ///< a dirty or blinded picture
  ViewBlocked,   ///< something is between the camera and the container: the arm, say
  NoFrame,       ///< the camera gave none that can be used
};
[[nodiscard]] const char* name_of(LookFault fault);

struct Observation {
  double time = 0.0;  ///< s, of the plant
  std::vector<PoseEstimate> seen;
  std::vector<std::string> not_seen;  ///< items that were asked for, in the order asked
  std::vector<std::string> missing;   ///< of these: their place was seen and is empty, and they were found nowhere
  LookFault fault = LookFault::None;
  std::string trouble = {};  ///< of NoFrame: why, for people
  /// What is there and was not expected, the largest first; absent: this look does not tell.
  std::optional<std::vector<Obstacle>> obstacles;
  /// Absent with obstacles: everything was seen, and what is not among them is not there.
  std::optional<HeightMap> heights;
  bool operator==(const Observation&) const = default;
};

/// What is expected before the look: a real estimator needs it to tell boxes of one size apart.
struct Expectation {
  std::string item;
  Vector3 size = Vector3::Constant(0.1);  ///< m
  std::optional<Pose> X_WP;               ///< absent: no idea
  bool operator==(const Expectation&) const = default;
};

/// nullptr when it was not seen.
[[nodiscard]] const PoseEstimate* find(const Observation& observation, const std::string& item);

}  // namespace snug::perception
