// MonteCarlo: the same run in cells drawn from the scenario's uncertainty: one lucky run proves nothing.
#pragma once

#include <vector>

#include "snug/cell/run.hpp"
#include "snug/core/rng.hpp"

namespace snug::cell {

struct MonteCarloOptions {
  int count = 20;
  std::uint64_t seed = 1;
  int threads = 1;  ///< the results do not depend on it
};

struct MonteCarloRun {
  int packed = 0;
  int boxes = 0;
  double filling_degree_percent = 0.0;
  double worst_repick = 0.0;  ///< m
  std::uint64_t state_hash = 0;
  std::string failure;
};

struct MonteCarloResult {
  std::vector<MonteCarloRun> runs;
  double mean_packed_percent = 0.0;
  double standard_deviation_percent = 0.0;
  double lowest_packed_percent = 0.0;
  int failed_runs = 0;  ///< that did not reach their end, such as by a protective stop
};

/// Runs the program `count` times. Throws like run(). Nothing is recorded.
[[nodiscard]] MonteCarloResult run_monte_carlo(const model::Scenario& scenario, const RunOptions& options,
                                               const MonteCarloOptions& monte_carlo);

}  // namespace snug::cell
