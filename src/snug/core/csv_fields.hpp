// Fields of a CSV that people or spreadsheets wrote.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace snug {

/// Fields of one line of a CSV; whole logs have some hundred. Each takes many times its own bytes while it is read.
inline constexpr std::size_t kMostCsvFields = 10'000;

/// Without the byte-order mark that spreadsheets put before UTF-8.
[[nodiscard]] std::string_view without_byte_order_mark(std::string_view text);

/// The fields of a line, with commas between and no blanks around. A field that begins with a double quote goes to the
/// next one: commas are part of it, and a quote that is written twice is one (RFC 4180). `where`: "file:line". Throws
/// InputError for more than kMostCsvFields fields, a quote that is not closed on the line, and text behind a closing
/// one.
[[nodiscard]] std::vector<std::string> split_csv(std::string_view line, const std::string& where);

/// Throws InputError for a header with semicolons and without commas, as spreadsheets of some languages write it.
void refuse_semicolons(std::string_view header, const std::string& where);

}  // namespace snug
