// Fuzz: collide() against the reference on random pairs.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "random_pair.hpp"

namespace snug::geometry::test {

/// Worst deviations over a family, m unless said.
struct Worst {
  long long pairs = 0;
  long long contacts = 0;
  long long apart = 0;         ///< contacts with a positive distance
  long long corners = 0;       ///< dropped by the corner rule
  double phantom = 0.0;        ///< reported nearer or deeper than the truth, beyond the relative part of the allowance
  double missed = 0.0;         ///< reported farther or shallower
  double apart_phantom = 0.0;  ///< the first, only pairs that are apart
  double normal = 0.0;         ///< |separation along the normal - reported|
  double surface = 0.0;        ///< distance of a point from the surface it should lie on
  double symmetry = 0.0;       ///< between both argument orders
};

struct FuzzResult {
  std::array<Worst, kFamilies> worst;
  std::vector<std::string> failures;  ///< the first twenty
  long long failure_count = 0;
};

/// `count` pairs, all families in turn.
[[nodiscard]] FuzzResult run_fuzz(std::uint64_t seed, long long count);

/// One line per family.
[[nodiscard]] std::string to_text(const FuzzResult& result);

}  // namespace snug::geometry::test
