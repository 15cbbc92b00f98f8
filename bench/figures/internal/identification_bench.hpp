// measure_identification: how near the identified cup comes to the truth, how honest its errors are, and what it costs.
#pragma once

#include "bench/figures/bench.hpp"

namespace snug::bench::internal {

/// Figures whose names begin with "identification". Those of the reference data are said to be skipped without it.
void measure_identification(const BenchOptions& options, std::vector<Figure>& figures);

}  // namespace snug::bench::internal
