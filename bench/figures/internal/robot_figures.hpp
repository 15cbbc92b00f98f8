// Figures of the robot: cost of a controller tick, of a program through the joints, of a check.
#pragma once

#include <vector>

#include "bench/figures/bench.hpp"

namespace snug::bench::internal {

void measure_robot(const BenchOptions& options, std::vector<Figure>& figures);

}  // namespace snug::bench::internal
