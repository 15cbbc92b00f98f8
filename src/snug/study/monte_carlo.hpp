// MonteCarlo: the program of a session repeated open loop in cells drawn from the scenario's uncertainty.
#pragma once

#include <string>
#include <vector>

#include "snug/cell/simulation.hpp"
#include "snug/packing/placement.hpp"

namespace snug::study {

struct MonteCarloOptions {
  int count = 20;
  std::uint64_t seed = 1;
  int threads = 1;  ///< results do not depend on it
  cell::SimulationOptions simulation;
};

/// One item over all runs.
struct ItemSpread {
  std::string id;
  int succeeded = 0;                    ///< runs at whose end it is packed
  Vector3 deviation = Vector3::Zero();  ///< m, standard deviation of its middle in T, where it succeeded
  double worst_distance = 0.0;          ///< m, from where it was planned
};

struct MonteCarloResult {
  int count = 0;
  int failed = 0;  ///< runs that did not reach the program's end, such as by a protective stop
  std::vector<ItemSpread> items;
  double success_percent = 0.0;  ///< of all items in all runs
  double mean_filling_percent = 0.0, lowest_filling_percent = 0.0;
};

/// Runs the program `count` times, each with everything uncertain drawn anew, as rows (run.hpp). Nothing is looked at
/// on the way.
[[nodiscard]] MonteCarloResult repeat(const model::Scenario& scenario, const std::string& sequence,
                                      const motion::Program& program, const std::vector<packing::Placement>& plan,
                                      const MonteCarloOptions& options);

}  // namespace snug::study
