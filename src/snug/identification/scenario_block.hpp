// Scenario block: what was identified, as the text that a scenario takes.
#pragma once

#include <string>
#include <vector>

#include "snug/identification/parameter.hpp"
#include "snug/identification/stiffness.hpp"
#include "snug/model/cup_params.hpp"

namespace snug::identification {

/// One of the five numbers with what is known about it.
struct BlockEntry {
  std::string key;  ///< of the scenario: lateral, axial, ...
  double value = 0.0;
  double standard_error = 0.0;
  std::string unit;
  Verdict verdict = Verdict::Identified;
};

/// `cup:` with `stiffness:` and `damping:`, whichever is not empty. Numbers that are not identifiable, or that a
/// scenario does not take (negative), stay comments, so that the scenario keeps its own. `notes` become comments on
/// top. Before it is returned the text is loaded as part of a scenario, which then holds these numbers.
[[nodiscard]] std::string format_cup_block(const std::vector<BlockEntry>& stiffness,
                                           const std::vector<BlockEntry>& damping,
                                           const std::vector<std::string>& notes);

/// Entries of parameters named k_lat, k_ax, k_bend, k_tors, c or d_lat, d_ax, d_bend, d_tors, d_c; others are left out.
[[nodiscard]] std::vector<BlockEntry> block_entries(const std::vector<Parameter>& parameters, char letter);

/// The five numbers of a fit. Those of a fit with 21 have the errors of the entries that they are read from.
[[nodiscard]] std::vector<BlockEntry> block_entries(const StiffnessFit& fit);

}  // namespace snug::identification
