// Measurements of many boxes: a stack, drops, what stands, piles.
#pragma once

#include <string>
#include <vector>

#include "peers/measure.hpp"

namespace snug::peers {

/// Of one pile: bench::drawn_pile.
struct PileSettings {
  int count, side;
  unsigned seed;
};

/// S1.
[[nodiscard]] std::vector<Result> measure_stack(Engine& engine);
/// S2.
[[nodiscard]] std::vector<Result> measure_drop(Engine& engine);
/// What stands, for 5 s: the largest way of a box, and its time.
[[nodiscard]] std::vector<Result> measure_standing(Engine& engine, const std::string& name, const Scene& scene);
/// The piles of `snug bench piles`, while they fall, land and settle: to `duration`, s, in windows of 0.2 s.
[[nodiscard]] std::vector<Result> measure_pile(Engine& engine, const std::string& name, const PileSettings& pile,
                                               double duration);

}  // namespace snug::peers
