// Pile bench: figures of piles of dropped boxes, of random drops, of threads and of scenes that others wrote.
#pragma once

#include <vector>

#include "apps/bench/bench.hpp"

namespace snug::bench::internal {

void measure_piles(const BenchOptions& options, std::vector<Figure>& figures);
void measure_threads(const BenchOptions& options, std::vector<Figure>& figures);
void measure_random_drops(const BenchOptions& options, std::vector<Figure>& figures);
void measure_hard_scenes(const BenchOptions& options, std::vector<Figure>& figures);

}  // namespace snug::bench::internal
