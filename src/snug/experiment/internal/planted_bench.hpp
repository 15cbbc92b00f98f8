// measure_planted: figures of numbers planted in virtual experiments.
#pragma once

#include <vector>

#include "snug/experiment/bench.hpp"

namespace snug::experiment::internal {

/// Stiffness of the cup and centre of mass of the first box, from 20 s of the program as the sensors saw it.
void measure_planted(const BenchOptions& options, std::vector<Figure>& figures);

}  // namespace snug::experiment::internal
