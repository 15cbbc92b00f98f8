// Measure: runs a scene in an engine and says how fast and how right it was; the same code for every engine.
#pragma once

#include <string>
#include <vector>

#include "peers/engine.hpp"

namespace snug::peers {

struct Result {
  std::string name;  ///< "s1.awake.us_per_step"
  double value = 0.0;
  std::string unit;
};

/// scene: "s1" .. "s8", "tower", "wall", "pile100", "heap100" and the same of 300 and 1000; anything else gives
/// nothing. bench/README.md says what each figure means.
[[nodiscard]] std::vector<Result> measure(Engine& engine, const std::string& scene);

}  // namespace snug::peers
