// Table: rows of cells under a head, as every page has them.
#pragma once

#include <string>
#include <vector>

#include "snug/report/markup.hpp"

namespace snug::report {

struct Column {
  std::string title;
  bool is_text = false;  ///< read from the left; numbers stand on the right
};

struct Table {
  std::vector<Column> columns;
  std::vector<std::vector<Markup>> rows;  ///< the last cell of a short row spans what is left; not more than columns
  std::vector<Markup> foot;               ///< means, sums; or empty
};

/// Scrolls by itself where the screen is narrower. A table without columns is nothing.
[[nodiscard]] Markup as_markup(const Table& table);

}  // namespace snug::report
