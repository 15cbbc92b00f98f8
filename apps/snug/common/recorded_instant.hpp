// The instant of a recording that --time names.
#pragma once

#include <optional>
#include <string>

#include "snug/record/reader.hpp"

namespace snug::app {

/// Throws InputError for a recording without frames and for an instant that was not recorded: what is drawn of it would
/// show another. `path`: of the recording; `time`: s.
void expect_recorded(const record::RecordingReader& reader, const std::string& path, const std::optional<double>& time);

}  // namespace snug::app
