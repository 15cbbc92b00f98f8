// StaticPoses: a held load at rest in several poses, as measured; the input of the stiffness identification.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "snug/model/cup_params.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::identification {

/// Standard deviations of one reading along each axis.
struct MeasurementNoise {
  double position = 5.0e-4;                 ///< m, of the lip in the gripper's frame
  double rotation = 0.0034906585039886591;  ///< rad (0.2 degrees), about each axis
  double force = 0.3;                       ///< N
  double torque = 0.02;                     ///< Nm
  bool operator==(const MeasurementNoise&) const = default;
};

/// Where the two ends of the spring are, see model::CupParams.
struct CupFrames {
  Pose X_ES2;
  Pose X_SS1;
  bool operator==(const CupFrames&) const = default;
};
[[nodiscard]] CupFrames frames_of(const model::CupParams& cup);

/// A payload of known mass, hanging.
struct KnownLoad {
  Matrix3 R_WE = Matrix3::Identity();
  double mass = 0.0;                 ///< kg
  Vector3 p_SScm = Vector3::Zero();  ///< m, centre of mass seen from the lip, in S
  bool operator==(const KnownLoad&) const = default;
};

struct StaticPose {
  int index = 0;      ///< place in the file, from 0
  std::string where;  ///< "file:line" or "file: records[3]", for messages
  Pose X_ES;          ///< measured
  std::optional<KnownLoad> load;
  std::optional<Vector6> wrench_S;  ///< of the cup on the package, in S about the lip, measured: N, Nm
};

struct StaticPoses {
  std::string source;
  std::vector<StaticPose> poses;
  CupFrames frames;
  MeasurementNoise noise;
  bool noise_is_given = false;  ///< false: the defaults are assumed
  Vector3 gravity_W{0.0, 0.0, -9.81};
};

/// Reads a .json or .csv file (docs/formats.md, static poses). `cup` gives the frames where the file does not. Throws
/// InputError with file, line or path and index: truncated, wrong shape, not a rotation, bent beyond the law.
[[nodiscard]] StaticPoses load_static_poses(const std::filesystem::path& path, const model::CupParams& cup = {});
/// The same from text.
[[nodiscard]] StaticPoses parse_static_poses_json(std::string_view text, const std::string& name,
                                                  const model::CupParams& cup = {});
[[nodiscard]] StaticPoses parse_static_poses_csv(const std::string& text, const std::string& name,
                                                 const model::CupParams& cup = {});

}  // namespace snug::identification
