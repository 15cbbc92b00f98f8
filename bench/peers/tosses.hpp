// Tosses: real tosses of a cube onto a board, predicted by each engine after the same searches.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "peers/measure.hpp"

namespace snug::peers {

struct TossOptions {
  std::filesystem::path file;  ///< columns toss, t, x, y, z, qw, qx, qy, qz
  int evaluations = 400;       ///< of each search (subplex), the same for every engine
  int starts = 4;              ///< searches from the same starts in every engine; the best is taken
};

/// Gravity and the centre of mass come from the free flights, before any engine. Then friction, two numbers of
/// softness, edge, moments, middle of the cube, height of the board and one number of the engine's own are searched on
/// four fifths of the tosses (mean distance + 0.05 m/rad mean angle, start from the free flight), and all tosses and
/// those held back are predicted. bench/README.md.
[[nodiscard]] std::vector<Result> measure_tosses(const std::function<std::unique_ptr<Engine>()>& make,
                                                 const TossOptions& options);

}  // namespace snug::peers
