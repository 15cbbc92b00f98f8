// Archive: measurements of an experiment in the layout of the demonstrator's archives: poses, wrenches, encoders.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/core/output_file.hpp"
#include "snug/record/recording.hpp"

namespace snug::record {

/// Poses of one body, one for each instant of the source that saw it. A body that was lost has NaN there.
struct BodyTrack {
  std::string name;               ///< as the archive writes it: "Box013", "Base005"
  std::vector<PoseSample> poses;  ///< in the frame of the source: motion capture's, or the robot base for its tool
  bool operator==(const BodyTrack&) const = default;
};

/// False where the source had lost the body.
[[nodiscard]] bool is_tracked(const PoseSample& sample);
[[nodiscard]] PoseSample lost_pose();

/// Each source has a clock of its own; times are s, strictly increasing, and mean nothing across sources.
struct MotionCaptureLog {
  double sample_frequency = 0.0;  ///< Hz
  std::vector<double> times;
  std::vector<BodyTrack> bodies;  ///< in the order of their names
  bool operator==(const MotionCaptureLog&) const = default;
};

/// Readings of the sensor between flange and gripper, in its frame: a hanging load pulls down.
struct WrenchLog {
  std::vector<double> times;
  std::vector<Wrench> wrenches;
  std::vector<Vector3> accelerations;  ///< specific force of the sensor, m/s^2: at rest it points up; may be empty
  bool operator==(const WrenchLog&) const = default;
};

struct RobotLog {
  std::vector<double> times;
  std::vector<std::string> names;            ///< columns of the table beside the time: "actual_q_0"
  std::vector<std::vector<double>> columns;  ///< one for each name, each as long as `times`
  std::vector<PoseSample> tool;              ///< X_BE, B: robot base; empty when the archive has none
  bool operator==(const RobotLog&) const = default;
};

struct ArchiveObject {
  std::string name;
  double mass = 0.0;                     ///< kg
  Vector3 dimensions = Vector3::Zero();  ///< m
  Matrix3 inertia = Matrix3::Zero();     ///< about the centre of mass, kg m^2
  std::vector<Vector3> vertices;         ///< m, in the body's frame
  bool operator==(const ArchiveObject&) const = default;
};

/// One recording of the archive: a repetition of a sequence, or the calibration of the force/torque sensor. A source
/// that was not recorded has no times.
struct ArchiveRecording {
  std::string name;                                          ///< "Rec_20230511T093000Z"
  std::vector<std::pair<std::string, std::string>> remarks;  ///< text attributes: "note", "sequence"
  MotionCaptureLog motion_capture;
  WrenchLog force_torque;
  RobotLog robot;
  std::vector<ArchiveObject> objects;
  bool operator==(const ArchiveRecording&) const = default;
};

/// The value of a text attribute, or an empty text.
[[nodiscard]] std::string_view find_remark(const ArchiveRecording& recording, std::string_view key);

struct Archive {
  std::vector<ArchiveRecording> recordings;  ///< in the order of their names, so of their times
  bool operator==(const Archive&) const = default;
};

/// The archive's spelling of a body: "BOX013" is "Box013" there; other names stay as they are.
[[nodiscard]] std::string archive_name(std::string_view body);
/// Equal but for upper and lower case.
[[nodiscard]] bool is_same_body(std::string_view a, std::string_view b);

/// Reads archives strictly and one recording at a time. What is cut, missing, of another shape, no rotation, or out of
/// order in time throws InputError with the file, the path inside it and the index: nothing is half-read.
class ArchiveReader {
 public:
  explicit ArchiveReader(const std::filesystem::path& path);
  ~ArchiveReader();
  ArchiveReader(ArchiveReader&&) noexcept;
  ArchiveReader& operator=(ArchiveReader&&) noexcept;

  [[nodiscard]] const std::vector<std::string>& names() const;
  [[nodiscard]] std::size_t size() const { return names().size(); }
  [[nodiscard]] ArchiveRecording read(std::size_t index) const;
  /// Everything that is wrong with the recording, one error for each dataset, in the order of reading.
  [[nodiscard]] std::vector<InputError> find_defects(std::size_t index) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Of all recordings.
[[nodiscard]] std::vector<InputError> find_defects(const ArchiveReader& reader);

[[nodiscard]] Archive load_archive(const std::filesystem::path& path);

/// Writes an archive beside its place, one recording at a time, and renames it when it is whole: what was at `path`
/// stays until then, and when anything fails; what is no archive is not replaced. The same recordings make the same
/// bytes. Poses are rounded to single precision; spans of 10 s in which a body is lost take no space.
class ArchiveWriter {
 public:
  /// Throws InputError where something other than an earlier archive is.
  explicit ArchiveWriter(OutputFile file);
  ~ArchiveWriter();
  ArchiveWriter(ArchiveWriter&&) noexcept;
  ArchiveWriter& operator=(ArchiveWriter&&) noexcept;
  /// Throws InputError when the archive has a recording of that name, or when the recording is none that the reader
  /// would take (lengths that differ, times that do not grow).
  void add(const ArchiveRecording& recording);
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

void save_archive(OutputFile file, const Archive& archive);

/// All recordings of several archives, in their order: the repetitions of one sequence. Throws InputError for two of
/// one name, two sequences, and another mass or size of an object.
void merge_archives(const std::vector<std::filesystem::path>& archives, OutputFile file);

}  // namespace snug::record
