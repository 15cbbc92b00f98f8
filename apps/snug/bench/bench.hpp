// bench: how fast and how accurate the physics is, beside its targets.
#pragma once

#include <optional>
#include <string>

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct BenchOptions {
  bool json = false;
  std::optional<std::string> only;  ///< run the scenes whose figures start with this
  int drops = 40;                   ///< random drops
};

void add_bench(CLI::App& app, Action& action);
[[nodiscard]] int run_bench(const BenchOptions& options);

}  // namespace snug::app
