// csv_cell: a name as a cell of a table, such that it stays one cell and no spreadsheet runs it.
#pragma once

#include <string>
#include <string_view>

namespace snug {

/// `;`, `,`, `"` and control characters anywhere, and in the first place also space and what begins a formula (= + - @
/// and their full-width forms), become `_`. Numbers are no names: they need no such care.
[[nodiscard]] std::string csv_cell(std::string_view name);

}  // namespace snug
