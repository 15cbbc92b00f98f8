// load: fills a container from a list of boxes known in advance, by geometry alone.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct LoadOptions {
  std::string file;
  std::vector<double> container_mm;  ///< length, width, height; for orders
  double time = 30.0;                ///< s for each problem
  int first = 0;                     ///< only so many problems; 0: all
  int threads = 1;
  bool json = false;
  std::optional<std::string> output;
};

void add_load(CLI::App& app, Action& action);
[[nodiscard]] int run_load(const LoadOptions& options);

}  // namespace snug::app
