// cup: what wrench a deformation gives, and where a held box hangs; JSON lines in, JSON lines out.
#pragma once

#include <string>

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct CupOptions {
  std::string input = "-";  ///< file of JSON lines; "-": stdin
};

void add_cup(CLI::App& app, Action& action);
/// Answers line by line, so that it can stand in a pipe. Throws InputError with the line that cannot be used.
[[nodiscard]] int run_cup_evaluate(const CupOptions& options);
[[nodiscard]] int run_cup_settle(const CupOptions& options);

}  // namespace snug::app
