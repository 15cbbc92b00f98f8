// What deciding where boxes go depends on: the scenario's rules, and what a run allows.
#pragma once

#include <cstdint>

#include "snug/settings/session_settings.hpp"

namespace snug::packing {

using settings::PackingSettings;

/// What belongs to a run, not to the cell.
struct DecisionRun {
  double time = 0.5;  ///< s an item on one core of the reference machine: turned into a number of roll-outs
  std::uint64_t seed = 1;
  int threads = 1;            ///< results do not depend on it
  bool tries_places = false;  ///< every place is tried before it counts: PackingSettings::last_interference is used
  bool operator==(const DecisionRun&) const = default;
};

}  // namespace snug::packing
