// McapExport: a recording as MCAP, with the messages that common robotics viewers draw without further setting.
#pragma once

#include <cstdint>
#include <string>

#include "snug/replay/mcap_writer.hpp"
#include "snug/replay/replay.hpp"

namespace snug::replay {

struct McapTotals {
  std::uint64_t bytes = 0;
  std::uint64_t messages = 0;
  std::size_t frames = 0;
};
/// "40 frames, 1200 messages, 1.20 MB"
[[nodiscard]] std::string to_text(const McapTotals& totals);

/// Topics and messages: docs/formats.md, "MCAP". `name` is that of the recording; `robot`
/// is drawn as it is described. Throws InputError for a recording
/// without such frames.
McapTotals export_mcap(record::RecordingReader& reader, const std::string& name, const Selection& selection,
                       OutputFile file, const McapSettings& settings = {}, const RobotDescription& robot = {});

}  // namespace snug::replay
