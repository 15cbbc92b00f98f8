// GlbExport: one instant of a recording as a binary glTF file, for slides, viewers and programs of drawing.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "snug/core/output_file.hpp"
#include "snug/record/reader.hpp"
#include "snug/replay/robot_description.hpp"

namespace snug::replay {

struct GlbSettings {
  std::optional<double> time;  ///< s; the frame nearest to it is taken; absent: the last
  bool load_only = false;      ///< the container and the boxes in it, in the container's frame
};

struct GlbTotals {
  double time = 0.0;  ///< s, of the frame
  std::size_t bodies = 0, triangles = 0, bytes = 0;
};
/// "20 bodies at 8.000 s, 1200 triangles, 1.20 MB"
[[nodiscard]] std::string to_text(const GlbTotals& totals);

/// Writes glTF 2.0 (docs/formats.md, "GLB"): a node for each body that is there. `name` is that of the recording.
/// Throws InputError for a recording without frames, and with `load_only` for one without a container.
GlbTotals export_glb(record::RecordingReader& reader, const std::string& name, const GlbSettings& settings,
                     OutputFile file, const RobotDescription& robot = {});

}  // namespace snug::replay
