// ui: a page to work in, served on this machine: scenarios, items and runs of a folder.
#pragma once

#include <string>

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct UiOptions {
  std::string folder = ".";
  int port = 0;  ///< 0: any that is free
  int runs = 1;  ///< at the same time
  bool opens_browser = true;
};

void add_ui(CLI::App& app, Action& action);
/// Serves until the program is told to stop (Ctrl-C).
[[nodiscard]] int run_ui(const UiOptions& options);

}  // namespace snug::app
