// Layout: paths, shapes, units and frames of all datasets that grow; the writer and the reader both use it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "snug/record/internal/column.hpp"

namespace snug::record::internal {

inline constexpr const char* kFormatName = "snug recording";
inline constexpr std::size_t kMaxChunkRows = 1000;

/// Frames in a chunk: about a second.
[[nodiscard]] std::size_t chunk_rows_for(double record_period);

/// Datasets with one row per frame.
enum FrameColumn : std::size_t {
  kTime,
  kStep,
  kProgramRow,
  kToolPose,
  kToolTwist,
  kToolPoseCommand,
  kVacuumCommand,
  kBlowOffCommand,
  kPressureGauge,
  kAttachedBody,
  kCupPose,
  kCupLength,
  kCupBend,
  kCupWrench,
  kFlangeWrench,
  kSolverResidual,
  kSolverIterations,
  kSolverStatus,
  kContactFirst,
  kContactCount,
  kFrameColumnCount,
};
[[nodiscard]] const ColumnSpec& frame_column(FrameColumn column);

/// Datasets with one row per frame and body; not in the file when the scene has no bodies.
[[nodiscard]] ColumnSpec body_present_column(std::size_t bodies);
[[nodiscard]] ColumnSpec body_pose_column(std::size_t bodies);
[[nodiscard]] ColumnSpec body_twist_column(std::size_t bodies);

/// Datasets with one row per frame and joint; not in the file without a robot.
inline constexpr const char* kJointName = "/joints/name";
inline constexpr std::size_t kJointColumnCount = 3;  ///< position, velocity, torque
[[nodiscard]] ColumnSpec joint_column(std::size_t column, std::size_t joints);

/// Flat datasets of the contacts, what is referred to first: frames point to runs of `frame_block`, which point to
/// blocks, which point to runs of points.
enum ContactColumn : std::size_t {
  kPoint,
  kNormal,
  kForce,
  kGap,
  kState,
  kBlockBody,
  kBlockFirst,
  kBlockCount,
  kFrameBlock,
  kContactColumnCount,
};
[[nodiscard]] const ColumnSpec& contact_column(ContactColumn column);

// Fixed lengths: HDF5 keeps texts of any length in a heap without checksums, and crashes on a damaged one.
inline constexpr std::size_t kEventWordBytes = 64;
inline constexpr std::size_t kEventTextBytes = 1024;
inline constexpr const char* kProgram = "/program";
/// Bytes of the program as far as it was sent; kProgram is written when the recording is closed.
inline constexpr const char* kProgramSoFar = "/program_so_far";
inline constexpr const char* kResult = "/result";
inline constexpr const char* kEventTime = "/events/time";
inline constexpr const char* kEventKind = "/events/kind";
inline constexpr const char* kEventBody = "/events/body";
inline constexpr const char* kEventText = "/events/text";
inline constexpr const char* kEventNumberFirst = "/events/number_first";
inline constexpr const char* kEventNumberCount = "/events/number_count";
inline constexpr const char* kNumberName = "/events/number_name";
inline constexpr const char* kNumberValue = "/events/number_value";

}  // namespace snug::record::internal
