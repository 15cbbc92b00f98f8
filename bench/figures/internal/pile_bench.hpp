// Pile bench: figures of piles of dropped boxes, of random drops, of threads and of scenes that others wrote.
#pragma once

#include <vector>

#include "bench/figures/bench.hpp"

namespace snug::bench::internal {

void measure_piles(const BenchOptions& options, std::vector<Figure>& figures);
/// Large piles to 4 s, in windows of 0.2 s: what a heap costs while it comes to rest.
void measure_heaps(const BenchOptions& options, std::vector<Figure>& figures);
void measure_threads(const BenchOptions& options, std::vector<Figure>& figures);
void measure_random_drops(const BenchOptions& options, std::vector<Figure>& figures);
void measure_hard_scenes(const BenchOptions& options, std::vector<Figure>& figures);

}  // namespace snug::bench::internal
