// OperatorDesk: which of the operator's orders are still to be followed, and at which item.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "snug/session/operator.hpp"

namespace snug::session::internal {

/// An order is used once: an order of an item at that item, one of the next item where the session asks first.
class OperatorDesk {
 public:
  /// An empty source: nobody is there.
  explicit OperatorDesk(OperatorSource source) : source_(std::move(source)) {}

  [[nodiscard]] bool is_manned() const { return static_cast<bool>(source_); }
  /// Of a session that is gone on with.
  void mark_used(int line) { used_.insert(line); }
  /// A box is to be taken out before this item comes, and nobody did so yet.
  [[nodiscard]] bool wants_out(const std::string& item);
  /// The next order for an item that stands at the aligner; orders to take a box out before the next item comes are for
  /// the one after it. None: nothing is to be done now. It is used then.
  [[nodiscard]] std::optional<OperatorOrder> take_order(const std::string& item);
  /// The next order to take a box out before the item comes.
  [[nodiscard]] std::optional<OperatorOrder> take_out_order(const std::string& item);
  /// No more will come.
  [[nodiscard]] bool is_over() const { return orders_.is_over; }

 private:
  void read();
  [[nodiscard]] const OperatorOrder* find_out(const std::string& item) const;
  std::optional<OperatorOrder> use(const OperatorOrder* order, const std::string& item);

  OperatorSource source_;
  OperatorOrders orders_;
  std::set<int> used_;  ///< lines
};

}  // namespace snug::session::internal
