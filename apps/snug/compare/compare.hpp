// compare: agents x sequences x plants.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/snug/pack/pack.hpp"

namespace snug::app {

/// The words of `snug compare`.
struct CompareOptions {
  PackOptions pack;  ///< scenario, seeds, perception, robot, decision time, threads, samples
  int plants = 1;    ///< of the seeds pack.plant_seed and those after it
  std::optional<std::string>
      sequences;               ///< "all", or names, separated by commas; absent: all, or the random ones alone
  std::string agents = "all";  ///< or names, separated by commas
  int random = 0;              ///< so many random sequences beside them
  std::uint64_t random_seed = 1;
  bool json = false;
  bool csv = false;
  std::optional<std::string> page;  ///< HTML file
  std::optional<std::string> runs;  ///< folder for a recording and a report page of every session
  std::optional<std::string> dir;   ///< folder that keeps the rows, so that the same words go on after a kill
};

void add_compare(CLI::App& app, Action& action);
/// Throws InputError for input that cannot be used.
[[nodiscard]] int run_compare(const CompareOptions& options);

}  // namespace snug::app
