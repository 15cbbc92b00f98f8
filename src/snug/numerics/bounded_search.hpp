// minimize_bounded: packaged searches for the least of a function that has no useful derivatives.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>

namespace snug::numerics {

enum class SearchMethod {
  ControlledRandom,  ///< global: CRS2 with local mutation (Kaelo and Ali 2006)
  Subplex,           ///< local: simplex steps in subspaces (Rowan 1990), at ease with noise
};

struct SearchOptions {
  SearchMethod method = SearchMethod::Subplex;
  int evaluations = 1000;   ///< at most
  double tolerance = 1e-4;  ///< a local search ends below it; of the unknowns, relative to what the bounds span
  Eigen::VectorXd step;     ///< first step of a local search; empty: a tenth of what the bounds span
  std::uint64_t seed = 1;
};

struct SearchResult {
  Eigen::VectorXd x;
  double cost = 0.0;
  int evaluations = 0;
  std::string message;  ///< why it ended
};

/// Within lower and upper, lower < upper; `start` is inside. One thread: the same function gives the same bytes. A cost
/// that is no number counts as the worst. Not to be called from two threads at once with ControlledRandom: NLopt has
/// one random generator a thread, which is seeded here.
[[nodiscard]] SearchResult minimize_bounded(const std::function<double(const Eigen::VectorXd&)>& cost,
                                            const Eigen::VectorXd& start, const Eigen::VectorXd& lower,
                                            const Eigen::VectorXd& upper, const SearchOptions& options);

}  // namespace snug::numerics
