// What a verb leaves: files that are reserved before the work begins, and text on stdout.
#pragma once

#include "snug/commands/outputs.hpp"

namespace snug::app {

using namespace commands;  // NOLINT(google-build-using-namespace): the words of every verb

[[nodiscard]] std::optional<OutputFile> reserve_recording(const std::optional<std::string>& path);

/// "snug: warning: ..." on stderr, a line for each.
void print_warnings(const std::vector<std::string>& warnings);

}  // namespace snug::app
