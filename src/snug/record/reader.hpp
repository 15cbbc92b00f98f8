// RecordingReader: opens a recording and fetches frames by number or time.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "snug/record/recording.hpp"

namespace snug::record {

/// Random access to a recording without loading all of it: times, header and events are in memory, frames are read
/// in blocks of about a second as they are asked for.
///
/// A recording that is being written is read as it was when it was opened.
///
/// A file that is missing, truncated, not a recording, or newer than this program throws InputError that says so; so
/// does one whose counts say more than a file of its size can hold, or that refers to other files. It takes at most
/// some 50 MB and a few times the size of the file.
class RecordingReader {
 public:
  explicit RecordingReader(const std::filesystem::path& path);
  ~RecordingReader();
  RecordingReader(RecordingReader&&) noexcept;
  RecordingReader& operator=(RecordingReader&&) noexcept;

  [[nodiscard]] const RecordingHeader& header() const;
  [[nodiscard]] const std::vector<Event>& events() const;
  /// Time of every frame, s, strictly increasing.
  [[nodiscard]] const std::vector<double>& times() const;
  [[nodiscard]] std::size_t frame_count() const { return times().size(); }
  /// Size of the file.
  [[nodiscard]] std::size_t file_bytes() const;
  /// False for the file of a run that was killed, failed, is going on, or was interrupted.
  [[nodiscard]] bool is_complete() const;
  /// The run was ended early by who watched it.
  [[nodiscard]] bool is_interrupted() const;
  /// What became of the run (docs/formats.md, result), JSON; empty when the recording does not hold it.
  [[nodiscard]] const std::string& result() const;

  /// Index of the last frame at or before `time`; the first frame for earlier times. Needs at least one frame.
  [[nodiscard]] std::size_t find_frame(double time) const;
  /// Reads frame `index` (< frame_count()) into `frame`, reusing its memory.
  void read_frame(std::size_t index, Frame& frame);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads everything.
[[nodiscard]] Recording load_recording(const std::filesystem::path& path);

}  // namespace snug::record
