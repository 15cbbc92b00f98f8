// Search: where a known line of pieces goes, in its order, so that as many as can be get in.
#pragma once

#include <functional>
#include <vector>

#include "snug/packing/internal/roll_out.hpp"

namespace snug::packing::internal {

struct SearchSettings {
  std::uint64_t seed = 1;
  int threads = 1;
  std::int64_t effort = 0;  ///< places to be looked at, about
  int breadth = 16;         ///< poses tried at each node, the policy's best
  int trials = 2;           ///< roll-outs of each, with different weights of the policy
  /// Whether piece `index` may really go there (orientation, balance, reach); absent: always.
  std::function<bool(const Layout&, int index, const CandidatePose&)> accept;
};

/// Candidate poses of the first pieces, as many as got in. Beam search: every node is valued by roll-outs of the real
/// line.
[[nodiscard]] std::vector<CandidatePose> plan_in_order(const Layout& start, const Policy& policy,
                                                       const std::vector<Piece>& pieces,
                                                       const SearchSettings& settings);

/// A policy whose weights are shaken: number 0 is the policy itself.
[[nodiscard]] Policy shaken(const Policy& policy, std::uint64_t seed, int number);

}  // namespace snug::packing::internal
