// run: a URScript program on the simulated cell, by the interpreter of the served controller, as fast as it goes.
#pragma once

#include <string>

#include "apps/snug/serve/serve.hpp"

namespace snug::app {

struct RunOptions {
  std::string program;   ///< URScript
  ServeOptions cell;     ///< scenario, sequence, plant, recording, model
  double until = 600.0;  ///< s
};

void add_run(CLI::App& app, Action& action);
/// Throws InputError for a program that cannot be read.
[[nodiscard]] int run_script(const RunOptions& options);

}  // namespace snug::app
