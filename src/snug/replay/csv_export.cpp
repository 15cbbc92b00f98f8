// export_csv: frame by frame.
#include "snug/replay/csv_export.hpp"

#include <fmt/format.h>

#include "snug/record/csv.hpp"

namespace snug::replay {

CsvTotals export_csv(record::RecordingReader& reader, const std::string& name, const Selection& selection,
                     OutputFile file) {
  record::CsvWriter writer(std::move(file), reader.header());
  record::Frame frame;
  const std::vector<std::size_t> frames = select_frames(reader, name, selection);
  for (const std::size_t index : frames) {
    reader.read_frame(index, frame);
    writer.append(frame);
  }
  writer.close();
  return {frames.size(), reader.times()[frames.front()], reader.times()[frames.back()]};
}

std::string to_text(const CsvTotals& totals) {
  return fmt::format("{} rows, {:.3f} s to {:.3f} s", totals.rows, totals.from, totals.to);
}

}  // namespace snug::replay
