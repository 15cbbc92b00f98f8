// init: a scenario to begin with, small, commented, and one that works.
#pragma once

#include <span>

namespace snug::app {

/// What can be begun with: a shipped file in scenarios/init and what to do with it.
struct InitKind {
  const char* name;
  const char* description;  ///< for --help
  const char* next;         ///< commands to run in the folder, one a line
  const char* arm = "";     ///< name of its robot in scenarios/robots; empty: none
};
[[nodiscard]] std::span<const InitKind> init_kinds();

}  // namespace snug::app
