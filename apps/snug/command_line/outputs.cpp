// What a verb leaves besides what every program of the kind does.
#include "apps/snug/command_line/outputs.hpp"

#include <cstdio>

#include "snug/record/writer.hpp"

namespace snug::app {

std::optional<OutputFile> reserve_recording(const std::optional<std::string>& path) {
  if (!path) return std::nullopt;
  return record::reserve_recording(*path);
}

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) std::fprintf(stderr, "snug: warning: %s\n", warning.c_str());
}

}  // namespace snug::app
