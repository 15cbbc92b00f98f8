// Table: measured numbers from a CSV with a header.
#include "snug/core/table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>

#include "snug/core/csv_fields.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"

namespace snug {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

/// Where each wanted column stands in the header.
std::vector<std::size_t> find_columns(const std::vector<std::string>& header, const std::vector<std::string>& wanted,
                                      const std::string& where) {
  std::vector<std::size_t> places;
  for (const std::string& column : wanted) {
    const auto found = std::find(header.begin(), header.end(), column);
    if (found == header.end())
      throw InputError(where, "column '" + column + "'", "a header '" + joined(header) + "'",
                       "a header with " + joined(wanted));
    if (std::find(found + 1, header.end(), column) != header.end())
      throw InputError(where, "column '" + column + "'", "it twice", "each column once");
    places.push_back(static_cast<std::size_t>(found - header.begin()));
  }
  return places;
}

bool is_gap(const std::string& cell) {
  if (cell.find_first_not_of(" \t") == std::string::npos) return true;
  return cell == "nan" || cell == "NaN" || cell == "NAN" || cell == "-nan" || cell == "NA";
}

double read_number(const std::string& cell, const std::string& where, const std::string& column) {
  double value = 0.0;
  const char* begin = cell.data() + (cell.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(begin, cell.data() + cell.size(), value);
  if (cell.empty() || error != std::errc() || end != cell.data() + cell.size() || !(std::abs(value) < 1e9))
    throw InputError(where, column, "'" + cell + "'", "a finite number in SI units");
  return value;
}

Table parse(const std::string& text, const std::string& name, const std::vector<std::string>& columns,
            const std::vector<std::string>& optional, bool may_have_gaps) {
  check_utf8(text, name);
  Table table{name, columns, {}, {}};
  std::vector<std::size_t> places;
  std::size_t width = 0;
  std::istringstream lines{std::string(without_byte_order_mark(text))};
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos || line.front() == '#') continue;
    const std::string where = name + ":" + std::to_string(number);
    if (places.empty()) refuse_semicolons(line, where);
    const std::vector<std::string> cells = split_csv(line, where);
    if (places.empty()) {
      for (const std::string& column : optional)
        if (std::find(cells.begin(), cells.end(), column) != cells.end()) table.columns.push_back(column);
      places = find_columns(cells, table.columns, where);
      width = cells.size();
      continue;
    }
    if (cells.size() != width)
      throw InputError(where, "", std::to_string(cells.size()) + " cells",
                       std::to_string(width) + ", as in the header");
    std::vector<double>& row = table.rows.emplace_back();
    for (std::size_t i = 0; i < places.size(); ++i)
      row.push_back(may_have_gaps && is_gap(cells[places[i]]) ? std::numeric_limits<double>::quiet_NaN()
                                                              : read_number(cells[places[i]], where, table.columns[i]));
    table.lines.push_back(number);
  }
  if (places.empty()) throw InputError(name + ":1", "", "no header", joined(columns));
  return table;
}

}  // namespace

Table parse_table(const std::string& text, const std::string& name, const std::vector<std::string>& columns,
                  const std::vector<std::string>& optional) {
  return parse(text, name, columns, optional, false);
}

Table parse_table_with_gaps(const std::string& text, const std::string& name, const std::vector<std::string>& columns) {
  return parse(text, name, columns, {}, true);
}

Table load_table(const std::filesystem::path& path, const std::vector<std::string>& columns,
                 const std::vector<std::string>& optional) {
  return parse_table(read_file(path, "a table of measurements (CSV)"), path.string(), columns, optional);
}

}  // namespace snug
