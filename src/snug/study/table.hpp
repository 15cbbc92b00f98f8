// Tables: what the rows of a study gave, one append-only file for each chunk; any number of writers, killed at any
// time.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "snug/study/design.hpp"

namespace snug::study {

using Cell = std::variant<std::monostate, double, std::string>;

/// What became of a row.
struct RowResult {
  std::uint64_t row = 0;
  int exit_code = 0;     ///< of the program; -1: it did not end by itself
  double seconds = 0.0;  ///< wall clock: for status only, in no merged table
  std::string error;     ///< empty, or its last words
  std::vector<std::pair<std::string, Cell>> values;
  /// Does not look at `seconds`.
  bool operator==(const RowResult& other) const {
    return row == other.row && exit_code == other.exit_code && error == other.error && values == other.values;
  }
};

/// The values kept of a verb's JSON: the outputs that the study names, a list or mapping as its text; else every
/// number, truth and word that is not in a list and does not tell of a clock (seconds, wall, real_time in its name).
[[nodiscard]] std::vector<std::pair<std::string, Cell>> values_of(const Study& study, const std::string& json);

/// One line, ending with a sum over the others, so that a line cut short is known as such.
[[nodiscard]] std::string format_line(const RowResult& result);
/// Nothing for a line that is not whole.
[[nodiscard]] std::optional<RowResult> parse_line(const std::string& line);

/// The folder of a study: its file as it was when it began, and the tables.
class Folder {
 public:
  /// `path` is made when there is none and `may_make`. Throws InputError for a folder of another study, or of this one
  /// before it was changed, and where there is none.
  Folder(const Study& study, std::filesystem::path path, bool may_make);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path table(std::uint64_t chunk) const;
  /// Those of the study that are there: its file as it was, the tables.
  [[nodiscard]] std::vector<std::filesystem::path> files() const;
  /// Every row that is done, by index; lines that are not whole are passed over, equal ones count once. Throws
  /// InputError when a row was done twice with different results: then it is no function of its index.
  [[nodiscard]] std::map<std::uint64_t, RowResult> read(std::uint64_t chunk) const;
  /// Removes the study's files where this object began it and nobody else writes a table, and the folder where it made
  /// that: a study that cannot be run at all was not begun.
  void remove_if_new() const;

 private:
  const Study& study_;
  std::filesystem::path path_;
  bool has_made_folder_ = false, has_begun_ = false;
};

/// Appends to the table of a chunk. Others are kept from the same chunk while this lives, where the file system knows
/// locks; where it does not, both do the same rows and readers count them once.
class TableWriter {
 public:
  TableWriter() = default;
  TableWriter(TableWriter&& other) noexcept;
  TableWriter& operator=(TableWriter&& other) noexcept;
  ~TableWriter();
  /// Nothing while somebody else writes it. Throws OutputError.
  [[nodiscard]] static std::optional<TableWriter> open(const std::filesystem::path& path);
  /// In one write; on disk (not only in the system's memory) after sync(). Throws OutputError.
  void append(const RowResult& result);
  void sync();

 private:
  int descriptor_ = -1;
  std::filesystem::path path_;
};

}  // namespace snug::study
