// measure_validation: what a virtual experiment with known parameters says of predictions, and what validating costs.
#pragma once

#include "bench/figures/bench.hpp"
#include "snug/validation/validate.hpp"

namespace snug::bench::internal {

/// A program run, measured with the demonstrator's sensors in three repetitions, and validated.
struct ValidationFigures {
  validation::Means true_clean, true_report;  ///< the experiment has the parameters of the prediction
  double rest_over_noise = 0.0;               ///< rms rest error of these over what the sensors' errors alone make
  validation::Means off_clean, off_report;    ///< each repetition has others: all off by one standard error
  double worst_shift_ms = 0.0;                ///< of any source and repetition, found less true
  double seconds = 0.0;  ///< CPU time: read three repetitions, find clocks, compare, write the page
};

/// One standard error: friction 0.01, restitution 0.03, centres of mass 2 mm in each axis, the cup's stiffness and
/// damping 5 %, clearance 0.3 mm (what identification is asked to reach); signs drawn for each repetition.
[[nodiscard]] ValidationFigures measure_validation(const BenchOptions& options);

}  // namespace snug::bench::internal
