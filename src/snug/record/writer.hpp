// RecordingWriter: appends frames and events to a file that stays readable if the run is killed.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "snug/core/output_file.hpp"
#include "snug/record/recording.hpp"

namespace snug::record {

/// How a run that was closed came to its end.
enum class RunEnd {
  Complete,
  Interrupted,  ///< early, because who watched it had enough
};

/// When the program of a recording is known.
enum class ProgramText {
  Known,  ///< RecordingHeader::program_text
  Grows,  ///< append_program, while it is sent
};

/// The file of a recording, before there is anything to record. Throws InputError like OutputFile, and for a path that
/// holds anything but an earlier recording or an empty file.
[[nodiscard]] OutputFile reserve_recording(const std::filesystem::path& path);

/// Writes the HDF5 layout of docs/formats.md. Frames are gathered in columns and written about once per second of
/// recorded time; a process that is killed leaves a file with all frames but those of the last second.
///
/// The file appears at its path with its first frames. An earlier recording stays there until the new one is closed,
/// also when the new one is killed or fails; until then the new one is beside it (OutputFile).
///
/// A header that cannot be stored and a file that cannot be written (no such folder) throw InputError, a write that
/// fails (disk full) OutputError, both naming the path. HDF5 is not thread-safe: use one writer or reader at a time in
/// a process.
class RecordingWriter {
 public:
  /// Begins the file; an earlier recording at that path is replaced, any other file is refused.
  RecordingWriter(const std::filesystem::path& path, const RecordingHeader& header);
  /// The same into a file of reserve_recording().
  RecordingWriter(OutputFile file, const RecordingHeader& header, ProgramText program = ProgramText::Known);
  /// Without close() the recording stays marked incomplete, where it does not take the place of an earlier one; silent
  /// when writing fails.
  ~RecordingWriter();
  RecordingWriter(RecordingWriter&&) noexcept;
  RecordingWriter& operator=(RecordingWriter&&) noexcept;

  /// Time must be finite and grow, `bodies` must be as many as in the header, body indices must be valid: a frame
  /// that breaks this is a bug of the caller and aborts.
  void append(const Frame& frame);
  /// In any order; kept in the order of the calls, and read in the order of their times.
  void append(const Event& event);
  /// Whole lines of a program's file, behind those before. Only with ProgramText::Grows (checked).
  void append_program(std::string_view lines);
  /// Writes out what is gathered so far.
  void flush();
  /// Writes the rest and `result_json` (what became of the run; empty: nothing), marks how the run ended and closes the
  /// file. Nothing may be appended afterwards.
  void close(const std::string& result_json = {}, RunEnd end = RunEnd::Complete);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes a whole recording at once.
void save_recording(const std::filesystem::path& path, const Recording& recording);

}  // namespace snug::record
