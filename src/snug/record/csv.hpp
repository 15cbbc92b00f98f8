// CSV: a recording as one table with the column names of mc_rtc logs, for spreadsheets and plotting programs.
#pragma once

#include <memory>
#include <string>

#include "snug/core/output_file.hpp"
#include "snug/record/recording.hpp"

namespace snug::record {

/// The name under which tables and logs have a body: "BOX024" is "box024", as the demonstrator logs it; other names as
/// they are, but with what would break a table, or run in it, replaced.
[[nodiscard]] std::string log_name(const std::string& name);

/// Writes frames as docs/formats.md describes: separator ';', first column t [s] strictly increasing, an empty cell
/// where a value is missing (body not in the cell, not a number). Numbers read back to the same double.
///
/// Orientations are quaternions of the rotation world -> body (the inverse of ours), as mc_rtc logs them. The table is
/// at its path when it is closed; without close() nothing is left. Throws OutputError when writing fails.
class CsvWriter {
 public:
  CsvWriter(OutputFile file, const RecordingHeader& header);
  ~CsvWriter();
  CsvWriter(const CsvWriter&) = delete;
  CsvWriter& operator=(const CsvWriter&) = delete;

  /// Time must be finite and grow.
  void append(const Frame& frame);
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes a whole recording at once.
void write_csv(const Recording& recording, OutputFile file);

}  // namespace snug::record
