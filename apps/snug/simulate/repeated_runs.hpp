// Repeated runs: `simulate --monte-carlo N` as a study of `simulate --draw 1 .. N`: one lucky run proves nothing.
#pragma once

#include <vector>

#include "apps/snug/simulate/simulate.hpp"
#include "snug/study/repeated_runs.hpp"

namespace snug::app {

/// The cell of run `draw`, from 1, of those of one seed.
[[nodiscard]] model::Scenario draw_cell(const model::Scenario& scenario, const std::string& sequence, int draw);

/// All runs, `threads` at a time; they do not depend on it. Throws InputError for words that cannot be used.
[[nodiscard]] std::vector<study::RepeatedRun> repeat_runs(const SimulateOptions& options, std::uint64_t seed, int count,
                                                          int threads);

}  // namespace snug::app
