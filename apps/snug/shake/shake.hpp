// shake: whether a load survives the ride.
#pragma once

#include <optional>
#include <string>

#include "apps/snug/command_line/scenario_options.hpp"
#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct ShakeOptions {
  std::string load;                     ///< recording (.h5), or placements
  std::optional<std::string> scenario;  ///< of the placements
  ScenarioChanges changes;
  std::string profile;
  double level = 0.5;  ///< g
  std::string hold = "none";
  int draws = 4;
  std::uint64_t seed = 1;
  double shift = 20.0;              ///< mm
  double tilt = 6.0;                ///< degrees
  std::optional<double> time_step;  ///< s
  std::optional<int> threads;       ///< absent: all cores
  std::optional<std::string> page;
  bool json = false;
};

void add_shake(CLI::App& app, Action& action);
/// Throws InputError for input that cannot be used.
[[nodiscard]] int run_shake(const ShakeOptions& options);

}  // namespace snug::app
