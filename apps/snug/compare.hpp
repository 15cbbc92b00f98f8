// compare: the agents side by side on the sequences of a scenario, planned and executed.
#pragma once

#include <string>
#include <vector>

#include "pack.hpp"

namespace snug::app {

/// The words of `snug compare`.
struct CompareOptions {
  PackOptions pack;               ///< scenario, seed, decision time, threads, samples
  std::string sequences = "all";  ///< or names, separated by commas
  std::string agents = "all";     ///< or names, separated by commas
  bool json = false;
  bool csv = false;
};

void add_compare(CLI::App& app, Action& action);
/// Throws InputError for input that cannot be used.
[[nodiscard]] int run_compare(const CompareOptions& options);

}  // namespace snug::app
