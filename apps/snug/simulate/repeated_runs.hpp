// Repeated runs: `simulate --monte-carlo N` as a study of `simulate --draw 1 .. N`: one lucky run proves nothing.
#pragma once

#include <string>
#include <vector>

#include "apps/snug/simulate/simulate.hpp"

namespace snug::app {

/// One run in a cell drawn from the scenario's uncertainty.
struct RepeatedRun {
  int packed = 0;
  int boxes = 0;
  double filling_degree_percent = 0.0;
  double worst_repick_mm = 0.0;
  std::string state_hash;
  std::string failure;  ///< empty, or why it did not reach its end, such as by a protective stop
};

/// The cell of run `draw`, from 1, of those of one seed.
[[nodiscard]] model::Scenario draw_cell(const model::Scenario& scenario, const std::string& sequence, int draw);

/// All runs, `threads` at a time; they do not depend on it. Throws InputError for words that cannot be used.
[[nodiscard]] std::vector<RepeatedRun> repeat_runs(const SimulateOptions& options, std::uint64_t seed, int count,
                                                   int threads);

/// A line a run and the spread, for people; the keys of the JSON are described in docs/formats.md.
[[nodiscard]] std::string format_table(const std::vector<RepeatedRun>& runs);
[[nodiscard]] std::string format_json(const std::vector<RepeatedRun>& runs);

}  // namespace snug::app
