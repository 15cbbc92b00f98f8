// measure_click: what a controller in another thread waits for a step of the demonstrator's cell at rest.
#pragma once

#include <vector>

#include "bench/figures/bench.hpp"

namespace snug::bench::internal {

/// Round trips over ipc and tcp, and the server's own part, medians of 5000 each. Clock time, unlike other figures.
void measure_click(const BenchOptions& options, std::vector<Figure>& figures);

}  // namespace snug::bench::internal
