// PosePath: where a body is over time, from a table that another program wrote.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "snug/spatial/pose.hpp"

namespace snug::model {

struct PathPoint {
  double time = 0.0;  ///< s
  Pose X_WB;
  bool operator==(const PathPoint&) const = default;
};

/// At least one point, in order of time. Between two points the origin moves straight at constant speed while the body
/// turns about a fixed axis at constant speed; before the first and after the last it stands still.
struct PosePath {
  std::vector<PathPoint> points;
  bool operator==(const PosePath&) const = default;
};

[[nodiscard]] Pose pose_at(const PosePath& path, double time);

/// Reads a table (docs/scenario.md, path): columns time,x,y,z and qw,qx,qy,qz or roll_deg,pitch_deg,yaw_deg, in any
/// order, poses in the frame X_WF. Throws InputError naming file, line and column.
[[nodiscard]] PosePath load_pose_path(const std::filesystem::path& file, const Pose& X_WF);
[[nodiscard]] PosePath parse_pose_path(std::string_view text, std::string_view name, const Pose& X_WF);

}  // namespace snug::model
