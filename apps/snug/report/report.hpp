// report: recordings as one HTML file that opens anywhere.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/verb.hpp"
#include "snug/replay/replay.hpp"

namespace snug::app {

struct ReportOptions {
  std::vector<std::string> recordings;  ///< one, or one and a second to lay over it
  std::string output;
  replay::Selection selection;
  std::optional<std::string> urdf;  ///< of the robot in it; absent: looked for
};

void add_report(CLI::App& app, Action& action);
[[nodiscard]] int run_report(const ReportOptions& options);

/// --from, --to and --every, as several verbs have them.
void add_selection_options(CLI::App& verb, replay::Selection& selection);

}  // namespace snug::app
