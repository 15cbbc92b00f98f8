// OperatorOrder: what a person decides in the place of the session, as lines of words, and the file that has them.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "snug/core/descriptor.hpp"

namespace snug::session {

enum class OperatorAction {
  Hold,       ///< the motion that is planned is not sent before a line says what to do
  Go,         ///< it is sent
  Skip,       ///< the item is not packed
  Place,      ///< it goes to a candidate of its decision, by number
  Elsewhere,  ///< it goes to the best candidate but the one that is planned
  TakeOut,    ///< a packed box is taken out and put to the aligner, before the item comes
};
[[nodiscard]] const char* name_of(OperatorAction action);

/// One line.
struct OperatorOrder {
  int line = 0;    ///< from 1
  std::string at;  ///< id of the item that is to be decided on; empty: the next one ("next")
  OperatorAction action = OperatorAction::Hold;
  int candidate = 0;  ///< of Place: of event::Planned::tried, from 1
  std::string box;    ///< id, of TakeOut
  bool operator==(const OperatorOrder&) const = default;
};

/// `AT ACTION`: AT an item's id or `next`; ACTION `hold`, `go`, `skip`, `place NUMBER`, `elsewhere` or `take-out ITEM`.
/// An id with blanks stands in double quotes, with `\` before `"` and `\`. None: an empty line, or a comment (`#`).
/// Throws InputError with `where` for anything else.
[[nodiscard]] std::optional<OperatorOrder> parse_operator_order(std::string_view text, const std::string& where,
                                                                int line);
/// As parse_operator_order() reads it.
[[nodiscard]] std::string format_operator_order(const OperatorOrder& order);

/// All orders so far, in their order.
struct OperatorOrders {
  std::vector<OperatorOrder> orders;
  bool is_over = false;  ///< no more will come
};
using OperatorSource = std::function<OperatorOrders()>;

/// Reads a file that may grow, or a stream.
class OperatorFile {
 public:
  /// "-": standard input. What is there already is read: throws InputError with file and line for what is no order, and
  /// for items that are not of `items`. `warn` is told of later lines that are none; they are left out.
  OperatorFile(const std::filesystem::path& path, std::vector<std::string> items,
               std::function<void(const std::string&)> warn);
  /// Reads what has come since; does not wait.
  [[nodiscard]] OperatorOrders read();

 private:
  void take(bool is_strict);
  void expect_known(const OperatorOrder& order) const;

  std::string name_;
  std::vector<std::string> items_;
  std::function<void(const std::string&)> warn_;
  Descriptor file_;
  bool is_stream_ = false;
  std::string rest_;  ///< of a line without its end
  int lines_ = 0;
  OperatorOrders said_;
};

}  // namespace snug::session
