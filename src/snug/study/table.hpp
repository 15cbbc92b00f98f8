// Tables: what the rows of a study gave, one append-only file for each chunk; any number of writers, killed at any
// time.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "snug/study/design.hpp"
#include "snug/study/inputs.hpp"

namespace snug::study {

using Cell = std::variant<std::monostate, double, std::string>;

/// What is kept of a row's JSON: what is a function of the row, and what depends on a clock besides.
struct ResultValues {
  std::vector<std::pair<std::string, Cell>> values;
  std::vector<std::pair<std::string, Cell>> clock;
  bool operator==(const ResultValues&) const = default;
};

/// What a row says whose process was ended at its time limit.
inline constexpr const char* kOverTime = "over its time limit";

/// What became of a row.
struct RowResult : ResultValues {
  std::uint64_t row = 0;
  int exit_code = 0;     ///< of the program; -1: it did not end by itself
  double seconds = 0.0;  ///< wall clock: for status only, in no merged table
  std::string error;     ///< empty, or its last words
  std::string inputs;    ///< hash of what it is a function of besides its words; empty: by an older program
  /// Does not look at `seconds`, nor at what depends on a clock.
  bool operator==(const RowResult& other) const {
    return row == other.row && exit_code == other.exit_code && error == other.error && values == other.values &&
           inputs == other.inputs;
  }
};

/// The values kept of a verb's JSON: the outputs that the study names, a list or mapping as its text; else every
/// number, truth and word that is not in a list and does not depend on a clock. Which do the JSON says itself: its list
/// `of_clock` has their keys, at any depth; without such a list a name with seconds, wall or real_time in it does.
[[nodiscard]] ResultValues values_of(const Study& study, const std::string& json);

/// One line, ending with a sum over the others, so that a line cut short is known as such.
[[nodiscard]] std::string format_line(const RowResult& result);
/// Nothing for a line that is not whole.
[[nodiscard]] std::optional<RowResult> parse_line(const std::string& line);

/// The folder of a study: its file as it was when it began, and the tables.
class Folder {
 public:
  /// `path` is made when there is none and `may_make`. Throws InputError for a folder of another study, or of this one
  /// before it was changed, of another user, one that everybody can write, and where there is none.
  Folder(const Study& study, std::filesystem::path path, bool may_make);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path table(std::uint64_t chunk) const;
  /// Those of the study that are there: its file as it was, the tables.
  [[nodiscard]] std::vector<std::filesystem::path> files() const;
  /// Every row that is done, by index; lines that are not whole are passed over, equal ones count once, and one that
  /// passed its time limit only where no other is. Throws InputError when a row was done twice with different results
  /// (then it is no function of its index), for tables that are links, and where `world` refuses what rows read.
  [[nodiscard]] std::map<std::uint64_t, RowResult> read(std::uint64_t chunk, OneWorld* world = nullptr) const;
  /// What the first row of each table is a function of. Throws as OneWorld::add.
  [[nodiscard]] OneWorld read_world() const;
  /// Removes the study's files where this object began it and nobody else writes a table, and the folder where it made
  /// that: a study that cannot be run at all was not begun.
  void remove_if_new() const;

 private:
  /// Until `take` says that it is enough.
  void for_each_line(std::uint64_t chunk, const std::function<bool(const std::string& line)>& take) const;

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
  /// In one write, with its inputs before the first row of this writer that has them; on disk (not only in the system's
  /// memory) after sync(). Throws OutputError.
  void append(const RowResult& result, const Inputs& inputs = {});
  void sync();

 private:
  int descriptor_ = -1;
  std::filesystem::path path_;
  std::set<std::string> known_;  ///< hashes of inputs that were written
};

}  // namespace snug::study
