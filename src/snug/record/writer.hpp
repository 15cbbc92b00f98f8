// RecordingWriter: appends frames and events to a file that stays readable if the run is killed.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "snug/record/recording.hpp"

namespace snug::record {

/// Writes the HDF5 layout of docs/formats.md. Frames are gathered in columns and written about once per second of
/// recorded time; a process that is killed leaves a file with all frames but those of the last second.
///
/// A header that cannot be stored and a file that cannot be written (no such folder, disk full) throw InputError
/// naming the path. HDF5 is not thread-safe: use one writer or reader at a time in a process.
class RecordingWriter {
 public:
  /// Creates the file; an earlier recording at that path is replaced, any other file is refused.
  RecordingWriter(const std::filesystem::path& path, const RecordingHeader& header);
  /// Writes the rest like close(), but leaves the recording marked incomplete, and stays silent when that fails.
  ~RecordingWriter();
  RecordingWriter(RecordingWriter&&) noexcept;
  RecordingWriter& operator=(RecordingWriter&&) noexcept;

  /// Time must be finite and grow, `bodies` must be as many as in the header, body indices must be valid: a frame
  /// that breaks this is a bug of the caller and aborts.
  void append(const Frame& frame);
  /// In any order; kept in the order of the calls.
  void append(const Event& event);
  /// Writes out what is gathered so far.
  void flush();
  /// Writes the rest and `result_json` (what became of the run; empty: nothing), marks the recording complete and
  /// closes the file. Nothing may be appended afterwards.
  void close(const std::string& result_json = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes a whole recording at once.
void save_recording(const std::filesystem::path& path, const Recording& recording);

}  // namespace snug::record
