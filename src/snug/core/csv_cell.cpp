// csv_cell: a name as a cell of a table, such that it stays one cell and no spreadsheet runs it.
#include "snug/core/csv_cell.hpp"

#include <array>

namespace snug {

std::string csv_cell(std::string_view name) {
  // U+FF1D, U+FF0B, U+FF0D, U+FF20: some spreadsheets take the full-width forms for the others.
  constexpr std::array<std::string_view, 9> kBeginnings = {"=",      "+",      "-",      "@",     " ",
                                                           "\uFF1D", "\uFF0B", "\uFF0D", "\uFF20"};
  std::string cell(name);
  for (char& c : cell) {
    const bool is_control = static_cast<unsigned char>(c) < 0x20U || c == '\x7f';
    if (is_control || c == ';' || c == ',' || c == '"') c = '_';
  }
  for (const std::string_view beginning : kBeginnings) {
    if (cell.starts_with(beginning)) cell.replace(0, beginning.size(), "_");
  }
  return cell;
}

}  // namespace snug
