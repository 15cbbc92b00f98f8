// The part of a recording that is fixed from the start: scenario, program, bodies, container.
#pragma once

#include "snug/record/internal/h5.hpp"
#include "snug/record/recording.hpp"

namespace snug::record::internal {

/// Writes root attributes, texts, bodies, shapes and the container.
void write_header(hid_t file, const RecordingHeader& header);
[[nodiscard]] RecordingHeader read_header(Source& source);

/// True if the open file is a recording of any version.
[[nodiscard]] bool is_recording(hid_t file);

}  // namespace snug::record::internal
