// Repeated runs of a program in drawn cells, as rows of a study: what became of each, and how far they spread.
#pragma once

#include <string>
#include <vector>

#include "snug/study/run.hpp"

namespace snug::study {

/// One run in a cell drawn from the scenario's uncertainty.
struct RepeatedRun {
  int packed = 0;
  int boxes = 0;
  double filling_degree_percent = 0.0;
  double worst_repick_mm = 0.0;
  std::string state_hash;
  std::string failure;  ///< empty, or why it did not reach its end, such as by a protective stop
};

/// Of the fraction of boxes that are packed, percent.
struct PackedSpread {
  double mean = 0.0, deviation = 0.0, lowest = 100.0;
  int failed = 0;
};

/// Of a row that `snug simulate --json` has made. A row without its state failed: then with what was said.
[[nodiscard]] RepeatedRun read_repeated_run(const RowResult& result);
/// `simulate --draw 1` to `count`, `processes` at a time; they do not depend on it. `options`: words that all runs
/// have. Throws InputError for words that cannot be used, and std::runtime_error where processes were killed.
[[nodiscard]] std::vector<RepeatedRun> repeat_runs(const std::string& scenario, const std::vector<std::string>& options,
                                                   int count, int processes, const Verb& verb);
/// Zeros of no runs.
[[nodiscard]] PackedSpread find_spread(const std::vector<RepeatedRun>& runs);

/// A line a run and the spread, for people; the keys of the JSON are described in docs/formats.md.
[[nodiscard]] std::string format_table(const std::vector<RepeatedRun>& runs);
[[nodiscard]] std::string format_json(const std::vector<RepeatedRun>& runs);

}  // namespace snug::study
