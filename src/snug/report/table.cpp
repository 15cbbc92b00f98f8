// Table: rows of cells under a head, as every page has them.
#include "snug/report/table.hpp"

#include <fmt/format.h>

#include "snug/core/check.hpp"
#include "snug/report/internal/raw.hpp"

namespace snug::report {
namespace {

using internal::element;
using internal::Raw;

Markup row_of(const Table& table, const std::vector<Markup>& cells) {
  SNUG_CHECK(cells.size() <= table.columns.size(), "a cell for each column");
  Markup row;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::size_t left = table.columns.size() - i;
    const bool spans = i + 1 == cells.size() && left > 1;
    std::string attributes = table.columns[i].is_text || spans ? "class=\"text\"" : "";
    if (spans) attributes += fmt::format(" colspan=\"{}\"", left);
    row += element("td", attributes, cells[i]);
  }
  return element("tr", "", row) + Raw::of("\n");
}

}  // namespace

Markup as_markup(const Table& table) {
  if (table.columns.empty()) return {};
  Markup head, body;
  for (const Column& column : table.columns) {
    head += element("th", column.is_text ? "class=\"text\" scope=\"col\"" : "scope=\"col\"", column.title);
  }
  for (const std::vector<Markup>& cells : table.rows) body += row_of(table, cells);
  Markup all = element("thead", "", element("tr", "", head)) + element("tbody", "", body);
  if (!table.foot.empty()) all += element("tfoot", "", row_of(table, table.foot));
  return element("div", "class=\"scroll\"", element("table", "", all)) + Raw::of("\n");
}

}  // namespace snug::report
