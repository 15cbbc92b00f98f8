// Fields of a CSV that people or spreadsheets wrote.
#include "snug/core/csv_fields.hpp"

#include <algorithm>

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"

namespace snug {
namespace {

/// Takes a field in quotes, with both of them, off the line.
std::string take_quoted(std::string_view& rest, const std::string& where) {
  std::string field;
  const std::string_view begin = rest;
  for (rest.remove_prefix(1); !rest.empty(); rest.remove_prefix(1)) {
    if (rest.front() != '"') {
      field += rest.front();
    } else if (rest.starts_with("\"\"")) {
      field += '"';
      rest.remove_prefix(1);
    } else {
      rest.remove_prefix(1);
      return field;
    }
  }
  throw InputError(where, "", "a quote that is not closed: " + printable(begin, 40), "a quote at the field's end, too");
}

}  // namespace

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

std::vector<std::string> split_csv(std::string_view line, const std::string& where) {
  std::vector<std::string> fields;
  while (true) {
    if (fields.size() == kMostCsvFields)
      throw InputError(where, "", "more than " + std::to_string(kMostCsvFields) + " fields",
                       std::to_string(kMostCsvFields) + " fields or fewer");
    line.remove_prefix(std::min(line.find_first_not_of(" \t\r"), line.size()));
    const bool is_quoted = line.starts_with('"');
    if (is_quoted) fields.push_back(take_quoted(line, where));
    const std::size_t comma = std::min(line.find(','), line.size());
    const std::string_view plain = trim(line.substr(0, comma));
    if (!is_quoted) fields.emplace_back(plain);
    if (is_quoted && !plain.empty())
      throw InputError(where, "", "'" + printable(plain, 40) + "' behind a closing quote",
                       "a comma, or \"\" for a quote");
    if (comma == line.size()) return fields;
    line.remove_prefix(comma + 1);
  }
}

void refuse_semicolons(std::string_view header, const std::string& where) {
  if (header.find(';') == std::string_view::npos || header.find(',') != std::string_view::npos) return;
  throw InputError(where, "", "semicolons between columns", "commas between columns, and numbers with a point: 1.5");
}

}  // namespace snug
