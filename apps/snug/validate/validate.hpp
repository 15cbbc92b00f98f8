// validate: a simulation beside the measurements of its experiment.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct ValidateOptions {
  std::string simulated, measured;
  std::optional<std::string> page, svg, csv, windows;
  std::vector<std::string> shifts;  ///< "SOURCE=SECONDS"
  bool json = false;
};

void add_validate(CLI::App& app, Action& action);
[[nodiscard]] int run_validate(const ValidateOptions& options);

}  // namespace snug::app
