// measure_planted: figures of numbers planted in virtual experiments.
#pragma once

#include <vector>

#include "bench/figures/bench.hpp"

namespace snug::bench::internal {

/// Stiffness of the cup and centre of mass of the first box, from 20 s of the program as the sensors saw it.
void measure_planted(const BenchOptions& options, std::vector<Figure>& figures);

}  // namespace snug::bench::internal
