// Tosses: real tosses of a cube onto a board, predicted by each engine after the same search over the same six numbers.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "peers/measure.hpp"

namespace snug::peers {

struct TossOptions {
  std::filesystem::path file;  ///< columns toss, t, x, y, z, qw, qx, qy, qz
  int evaluations = 120;       ///< of the search (subplex), the same for every engine
};

/// Friction, two numbers of softness, edge, moments and height of the board are searched on four fifths of the tosses
/// (mean distance + 0.05 m/rad mean angle, start from the free flight), then all tosses and those held back are
/// predicted. bench/README.md.
[[nodiscard]] std::vector<Result> measure_tosses(const std::function<std::unique_ptr<Engine>()>& make,
                                                 const TossOptions& options);

}  // namespace snug::peers
