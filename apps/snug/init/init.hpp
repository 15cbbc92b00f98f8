// init: a scenario to begin with, small, commented, and one that works.
#pragma once

#include <span>
#include <string>

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct InitOptions {
  std::string kind;    ///< name of an InitKind
  std::string folder;  ///< to write into; made when it is not there
};

/// What can be begun with: a shipped file in scenarios/init and what to do with it.
struct InitKind {
  const char* name;
  const char* description;  ///< for --help
  const char* next;         ///< commands to run in the folder, one a line
};
[[nodiscard]] std::span<const InitKind> init_kinds();

void add_init(CLI::App& app, Action& action);
/// Throws InputError for a folder that cannot be made and for a file that is there already.
[[nodiscard]] int run_init(const InitOptions& options);

}  // namespace snug::app
