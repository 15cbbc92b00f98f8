// run_study: the rows that are missing, each in a process of its own, as many at a time as asked for. The one way in
// which this program runs rows: studies, comparisons, repeated runs and benches.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "snug/study/table.hpp"

namespace snug::study {

/// Does what the words behind `snug` say, printing to standard output and error, and returns the exit code. Called in a
/// process of its own that ends afterwards: what it breaks, leaks or aborts is the row's alone.
using Verb = std::function<int(const std::vector<std::string>& words)>;

/// The same of a row by its index: what does not come from words. It prints the row's JSON, and throws InputError for a
/// row that cannot be run (exit code 2).
using RowWork = std::function<int(std::uint64_t row)>;

struct RunSettings {
  int processes = 1;  ///< rows at a time; tables do not depend on it, but for the order of their lines
  std::uint64_t first_chunk = 0;
  std::uint64_t last_chunk = UINT64_MAX;  ///< included
  std::string version = {};               ///< of the program that does the rows
  /// Called after every row.
  std::function<void(std::uint64_t done, std::uint64_t wanted)> progress;
  /// Called for every row that has a result, one of an earlier call too, in the order of their indices, as soon as
  /// those before it were told; what it throws ends the call. `said`: on standard error, now. Rows that come after one
  /// that was left out are told at the end.
  std::function<void(const RowResult& result, const std::string& said)> tell;
  /// Asked again and again. Once true, no row is begun, and those under way get SIGTERM; what they still give is told,
  /// but kept in no table.
  std::function<bool()> is_stopped;
};

struct RunSummary {
  std::uint64_t done = 0;      ///< in this call
  std::uint64_t failed = 0;    ///< of them, with an exit code that is not 0
  std::uint64_t left_out = 0;  ///< in chunks that others are at work on, or whose process was killed again and again
  double row_seconds = 0.0;    ///< wall clock, sum over the rows
};

/// Runs what the tables of `folder` lack. A row whose process somebody ends (SIGKILL, SIGTERM, SIGINT, SIGHUP) is tried
/// three times and then left for another call; any other end is its result. When the very first row of a study cannot
/// be used (exit code 2), the study's files are removed where `folder` began it, and InputError says what the row said.
/// Throws OutputError when a table cannot be written, and InputError where a file that rows have read, or the program,
/// is another one than for the rows that are done: rows of two worlds do not mix.
[[nodiscard]] RunSummary run_study(const Study& study, const Folder& folder, const Verb& verb,
                                   const RunSettings& settings);
/// The same without tables: every row is run and told.
[[nodiscard]] RunSummary run_study(const Study& study, const Verb& verb, const RunSettings& settings);
/// The same of rows that are done by `work`; the study says what they are and which outputs they have. `folder`: or
/// null, no tables.
[[nodiscard]] RunSummary run_rows(const Study& study, const Folder* folder, const RowWork& work,
                                  const RunSettings& settings);

}  // namespace snug::study
