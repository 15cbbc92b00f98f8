// Drawn scenes: piles of dropped boxes and random drops of all kinds of bodies, from a size and a seed.
#pragma once

#include <cstdint>

#include "snug/model/scenario.hpp"

namespace snug::bench {

/// Boxes of 9 to 16 cm and 300 kg/m^3 that fall in layers of side x side into a tote which they just fit into beside
/// each other; friction 0.4, restitution 0.1, time step 2 ms, everything else by default.
struct Pile {
  int count = 100;
  int side = 5;
  std::uint64_t seed = 1;
};
[[nodiscard]] model::Scenario drawn_pile(const Pile& pile);

/// 5 to 40 boxes, hulls and capsules of 3 to 16 cm, thrown with spin into a tote, masses within the ratio given.
struct RandomDrop {
  double time_step = 0.001;  ///< s
  double mass_ratio = 100.0;
  std::uint64_t seed = 1;
};
[[nodiscard]] model::Scenario drawn_drop(const RandomDrop& drop);

}  // namespace snug::bench
