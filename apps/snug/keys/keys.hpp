// keys: makes the keys by which a served cell and its controllers know each other.
#pragma once

#include <optional>
#include <string>

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct KeysOptions {
  std::string folder;
  std::optional<std::string> name;  ///< one more that may drive; absent: the served cell's and a controller's
};

void add_keys(CLI::App& app, Action& action);
[[nodiscard]] int run_keys(const KeysOptions& options);

}  // namespace snug::app
