// CsvExport: a recording as one table with the column names of mc_rtc logs.
#pragma once

#include <cstddef>
#include <string>

#include "snug/core/output_file.hpp"
#include "snug/replay/replay.hpp"

namespace snug::replay {

struct CsvTotals {
  std::size_t rows = 0;
  double from = 0.0, to = 0.0;  ///< s, of the first and the last
};
/// "40 rows, 0.000 s to 8.000 s"
[[nodiscard]] std::string to_text(const CsvTotals& totals);

/// Columns: docs/formats.md, "Table (CSV)". `name` is that of the recording. Throws InputError for a recording without
/// such frames.
CsvTotals export_csv(record::RecordingReader& reader, const std::string& name, const Selection& selection,
                     OutputFile file);

}  // namespace snug::replay
