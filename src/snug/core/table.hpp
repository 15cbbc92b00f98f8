// Table: measured numbers from a CSV with a header, every complaint with file and line.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace snug {

/// Rows of numbers under named columns.
struct Table {
  std::string name;  ///< file, for messages
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;  ///< each as long as `columns`
  std::vector<int> lines;                 ///< of the rows in the file

  /// "file:line" of a row.
  [[nodiscard]] std::string where(std::size_t row) const { return name + ":" + std::to_string(lines[row]); }
};

/// Reads a CSV: separator comma, fields in double quotes if need be, a byte-order mark passed over, first line the
/// column names, lines that start with # and empty lines left out. The columns named must be there, in any order; those
/// of `optional` may; others are ignored. Returned in the order of `columns`, then of those optional ones that are
/// there.
[[nodiscard]] Table load_table(const std::filesystem::path& path, const std::vector<std::string>& columns,
                               const std::vector<std::string>& optional = {});
[[nodiscard]] Table parse_table(const std::string& text, const std::string& name,
                                const std::vector<std::string>& columns, const std::vector<std::string>& optional = {});
/// The same, but a cell may be empty or say nan where nothing was measured: it is then not a number.
[[nodiscard]] Table parse_table_with_gaps(const std::string& text, const std::string& name,
                                          const std::vector<std::string>& columns);

}  // namespace snug
