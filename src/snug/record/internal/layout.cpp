// Layout: paths, shapes, units and frames of all datasets that grow; the writer and the reader both use it.
#include "snug/record/internal/layout.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace snug::record::internal {
namespace {

constexpr const char* kPose = "x,y,z,qw,qx,qy,qz";
constexpr const char* kPoseUnit = "m, -";
constexpr const char* kTwist = "vx,vy,vz,wx,wy,wz";
constexpr const char* kTwistUnit = "m/s, rad/s";
constexpr const char* kWrench = "fx,fy,fz,tx,ty,tz";
constexpr const char* kWrenchUnit = "N, Nm";
constexpr const char* kAxes = "x,y,z";
constexpr const char* kWorld = "W";

}  // namespace

std::size_t chunk_rows_for(double record_period) {
  const double rows = std::round(1.0 / record_period);
  return static_cast<std::size_t>(std::clamp(rows, 1.0, static_cast<double>(kMaxChunkRows)));
}

const ColumnSpec& frame_column(FrameColumn column) {
  using i32 = std::int32_t;
  using i64 = std::int64_t;
  using u8 = std::uint8_t;
  static const std::array<ColumnSpec, kFrameColumnCount> specs = {
      column_of<double>("/time", 1, "s", "", ""),
      column_of<i64>("/step", 1, "-", "", ""),
      column_of<i32>("/program_row", 1, "-", "", ""),
      column_of<double>("/tool/pose", 7, kPoseUnit, "X_WE", kPose),
      column_of<double>("/tool/twist", 6, kTwistUnit, "V_WE in W, at the origin of E", kTwist),
      column_of<double>("/tool/pose_command", 7, kPoseUnit, "X_WE", kPose),
      column_of<u8>("/cup/vacuum_command", 1, "0 or 1", "", ""),
      column_of<u8>("/cup/blow_off_command", 1, "0 or 1", "", ""),
      column_of<double>("/cup/pressure_gauge", 1, "Pa", "", ""),
      column_of<i32>("/cup/attached_body", 1, "-", "", ""),
      column_of<double>("/cup/pose", 7, kPoseUnit, "X_ES", kPose),
      column_of<double>("/cup/length", 1, "m", "E to S along z of E", ""),
      column_of<double>("/cup/bend", 1, "rad", "", ""),
      column_of<double>("/cup/wrench", 6, kWrenchUnit, "on the package, about the origin of S, in S", kWrench),
      column_of<double>("/flange/wrench", 6, kWrenchUnit, "on the flange, about the origin of F, in F", kWrench),
      column_of<double>("/solver/residual", 1, "as the solver defines it", "", ""),
      column_of<i32>("/solver/iterations", 1, "-", "", ""),
      column_of<u8>("/solver/status", 1, "0 converged, 1 not converged, 2 nothing to solve, 3 failed", "", ""),
      column_of<i64>("/contacts/frame_first", 1, "row of /contacts/frame_block", "", ""),
      column_of<i32>("/contacts/frame_count", 1, "rows of /contacts/frame_block", "", ""),
  };
  return specs[column];
}

ColumnSpec body_present_column(std::size_t bodies) {
  ColumnSpec spec = column_of<std::uint8_t>("/bodies/present", bodies, "0 or 1", "", "");
  spec.is_table = true;
  return spec;
}

ColumnSpec body_pose_column(std::size_t bodies) {
  ColumnSpec spec = column_of<double>("/bodies/pose", 7, kPoseUnit, "X_WB", kPose);
  spec.lanes = bodies;
  return spec;
}

ColumnSpec body_twist_column(std::size_t bodies) {
  ColumnSpec spec = column_of<double>("/bodies/twist", 6, kTwistUnit, "V_WB in W, at the origin of B", kTwist);
  spec.lanes = bodies;
  return spec;
}

ColumnSpec joint_column(std::size_t column, std::size_t joints) {
  static constexpr const char* kPaths[kJointColumnCount] = {"/joints/position", "/joints/velocity", "/joints/torque"};
  static constexpr const char* kUnits[kJointColumnCount] = {"rad or m", "rad/s or m/s", "Nm or N"};
  ColumnSpec spec = column_of<double>(kPaths[column], joints, kUnits[column], "", "");
  spec.is_table = true;
  return spec;
}

const ColumnSpec& contact_column(ContactColumn column) {
  using i32 = std::int32_t;
  using i64 = std::int64_t;
  using u8 = std::uint8_t;
  static const std::array<ColumnSpec, kContactColumnCount> specs = {
      column_of<float>("/contacts/point", 3, "m", kWorld, kAxes),
      column_of<float>("/contacts/normal", 3, "-", "W, from a to b", kAxes),
      column_of<float>("/contacts/force", 3, "N", "W, on b", kAxes),
      column_of<float>("/contacts/gap", 1, "m", "", ""),
      column_of<u8>("/contacts/state", 1, "0 unknown, 1 open, 2 sticking, 3 sliding", "", ""),
      column_of<i32>("/contacts/block_body", 2, "row of /bodies/name", "", "a,b"),
      column_of<i64>("/contacts/block_first", 1, "row of /contacts/point", "", ""),
      column_of<i32>("/contacts/block_count", 1, "rows of /contacts/point", "", ""),
      column_of<i32>("/contacts/frame_block", 1, "row of /contacts/block_*", "", ""),
  };
  return specs[column];
}

}  // namespace snug::record::internal
