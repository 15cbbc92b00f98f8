// Merge: the tables of a study as one, rows in the order of their indices.
#pragma once

#include <functional>
#include <string>

#include "snug/core/output_file.hpp"
#include "snug/study/table.hpp"

namespace snug::study {

/// How far a study is.
struct Status {
  std::uint64_t rows = 0, done = 0, failed = 0;
  std::uint64_t chunks = 0, chunks_done = 0;
  double mean_seconds = 0.0;  ///< wall clock of a row
};
[[nodiscard]] Status status_of(const Study& study, const Folder& folder);

/// Calls `take` for every row that is done, in the order of indices; holds one chunk at a time. Throws InputError for
/// rows of two worlds.
void for_each_row(const Study& study, const Folder& folder, const std::function<void(const RowResult&)>& take);

/// A column of what rows gave.
struct ResultColumn {
  std::string name;
  bool is_of_clock = false;  ///< not the same when the row is done again
  bool operator==(const ResultColumn&) const = default;
};
/// All of them, in the order in which rows bring them, lower rows first; those of a clock behind the others.
[[nodiscard]] std::vector<ResultColumn> columns_of(const Study& study, const Folder& folder);

/// row, point, repeat, row_seed, the factors, exit, the values, those of a clock as clock.NAME (where the study names
/// them), error, and inputs: the hash of what the row is a function of besides its words. The same bytes whoever did
/// the rows in whatever order, but for the clocks. Rows that are missing are left out. Throws OutputError, and
/// InputError for rows of two worlds (OneWorld).
void write_csv(const Study& study, const Folder& folder, OutputFile file);
/// The same columns as data sets of an HDF5 file: numbers (NaN: none) or texts, each with its kind as an attribute:
/// design, result, clock or outcome.
void write_hdf5(const Study& study, const Folder& folder, OutputFile file);

/// One of these by the ending of `path`: .csv, .h5 or .hdf5. Throws InputError for another.
void write_table(const Study& study, const Folder& folder, const std::string& path, OutputFile file);

}  // namespace snug::study
