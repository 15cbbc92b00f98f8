// Scene bench: figures of the scenes S1 to S6 and of fields of columns.
#pragma once

#include <string>
#include <vector>

#include "bench/figures/bench.hpp"

namespace snug::bench::internal {

/// A figure with a highest value as its target.
[[nodiscard]] Figure at_most(std::string name, double value, std::string unit, double limit);

void measure_stack(const BenchOptions& options, std::vector<Figure>& figures);
void measure_drops(const BenchOptions& options, std::vector<Figure>& figures);
void measure_slides(const BenchOptions& options, std::vector<Figure>& figures);
void measure_bounce(const BenchOptions& options, std::vector<Figure>& figures);
void measure_swing(const BenchOptions& options, std::vector<Figure>& figures);
void measure_press(const BenchOptions& options, std::vector<Figure>& figures);
void measure_growth(const BenchOptions& options, std::vector<Figure>& figures);

}  // namespace snug::bench::internal
