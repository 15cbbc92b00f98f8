// ItemsSheet: a table of boxes as people keep it (any order of columns, units, semicolons), made into a CSV of orders.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace snug::model {

/// What a sheet leaves open. Empty: not said.
struct SheetAnswers {
  std::string length;   ///< mm, cm, m or in
  std::string mass;     ///< kg, g or lb
  std::string decimal;  ///< point or comma
  bool operator==(const SheetAnswers&) const = default;
};

/// Something that a sheet leaves open, with what each answer would mean.
struct SheetQuestion {
  struct Choice {
    std::string answer;
    std::string meaning;  ///< for the first box that it matters to
    bool operator==(const Choice&) const = default;
  };
  std::string about;  ///< a member of SheetAnswers
  std::vector<Choice> choices;
  bool operator==(const SheetQuestion&) const = default;
};

/// A heading and what it was taken for; empty: passed over.
struct SheetColumn {
  std::string heading;
  std::string column;
  bool operator==(const SheetColumn&) const = default;
};

struct ItemsSheet {
  std::string orders;  ///< a CSV as parse_orders_csv() reads it, line by line as in the sheet; empty with questions
  std::vector<SheetColumn> columns;
  std::vector<SheetQuestion> questions;
  bool operator==(const ItemsSheet&) const = default;
};

/// Reads a table with a header: commas, semicolons or tabs between its columns, whichever the header has most of;
/// headings in English, German, Dutch or French; units in headings or behind numbers. Numbers that cannot be read stay
/// as they are: parse_orders_csv() says where they are. A text that has the columns of parse_orders_csv() stays as it
/// is. Throws InputError with "name:line" for answers that are none, and where edges or mass have no column or one has
/// two.
[[nodiscard]] ItemsSheet read_items_sheet(std::string_view text, const std::string& name, const SheetAnswers& answers);
/// The sheet's orders as CSV. Throws InputError for the first open question, with the options that answer it and what
/// each would mean, and where a number is none.
[[nodiscard]] std::string require_orders(const ItemsSheet& sheet, const std::string& name);

}  // namespace snug::model
