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

/// At least one point, in order of time. The body moves smoothly through them: the origin by cubic Hermite polynomials
/// in W, the rotation by the same in the rotation vector of the shortest arc from point to point; linear and angular
/// velocity are continuous. At a point they are those of the parabola through it and its two neighbours (Bessel's;
/// order 2). Between two points of equal pose the body rests. At the first and the last point they are those of the
/// parabola through the nearest three, or zero where that turns back: the motion begins or ends at rest. Two points:
/// constant velocity. Before the first point and after the last the body stands still.
struct PosePath {
  std::vector<PathPoint> points;
  bool operator==(const PosePath&) const = default;
};

[[nodiscard]] Pose pose_at(const PosePath& path, double time);
/// Linear part at the origin of B, in W. At a point where the velocity jumps, the first or the last, that before it.
[[nodiscard]] Twist twist_at(const PosePath& path, double time);

/// Reads a table (docs/scenario.md, path): columns time,x,y,z and qw,qx,qy,qz or roll_deg,pitch_deg,yaw_deg, in any
/// order, poses in the frame X_WF. Throws InputError naming file, line and column.
[[nodiscard]] PosePath load_pose_path(const std::filesystem::path& file, const Pose& X_WF);
[[nodiscard]] PosePath parse_pose_path(std::string_view text, std::string_view name, const Pose& X_WF);

}  // namespace snug::model
