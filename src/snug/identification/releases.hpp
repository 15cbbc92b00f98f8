// Release: a held load swinging freely after it was let go, as measured; the input of the damping identification.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "snug/identification/static_poses.hpp"

namespace snug::identification {

/// The gripper stands still; the load moves on the cup.
struct Release {
  std::string name;       ///< file, with the case's id where it has several
  SpatialInertia load_S;  ///< mass, centre of mass in S, inertia about it in the axes of S
  Matrix3 R_WE = Matrix3::Identity();
  CupFrames frames;
  std::optional<Matrix6> K;  ///< in S1, where the file has it
  Vector3 gravity_W{0.0, 0.0, -9.81};
  MeasurementNoise noise;  ///< of the poses
  bool noise_is_given = false;
  std::optional<Pose> X_ES_start;  ///< where it was held before, known better than one sample: a mean of many
  std::vector<double> times;       ///< s, increasing
  std::vector<Pose> X_ES;          ///< measured, one for each time
};

/// Reads the releases of a .json file, or the one of a .csv file (docs/formats.md, releases). Throws InputError with
/// file, line or path: truncated, wrong shape, not a rotation, time that does not run forward.
[[nodiscard]] std::vector<Release> load_releases(const std::filesystem::path& path, const model::CupParams& cup = {});
[[nodiscard]] std::vector<Release> parse_releases_json(std::string_view text, const std::string& name,
                                                       const model::CupParams& cup = {});
[[nodiscard]] std::vector<Release> parse_releases_csv(const std::string& text, const std::string& name,
                                                      const model::CupParams& cup = {});

/// The JSON form of releases, as read by the above.
[[nodiscard]] std::string format_releases(const std::vector<Release>& releases);

}  // namespace snug::identification
