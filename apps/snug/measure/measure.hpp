// measure: a virtual experiment: a simulation becomes measurements with stated sensors.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct MeasureOptions {
  std::vector<std::string> recordings;
  std::string sensors;
  std::string output;
  std::optional<std::string> truth;  ///< JSON file for what was drawn
  std::string date = "20000101T000000Z";
  std::uint64_t seed = 1;
  int repetitions = 1;
};

void add_measure(CLI::App& app, Action& action);
[[nodiscard]] int run_measure(const MeasureOptions& options);

}  // namespace snug::app
