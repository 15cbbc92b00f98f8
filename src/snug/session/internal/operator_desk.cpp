// OperatorDesk: which of the operator's orders are still to be followed, and at which item.
#include "snug/session/internal/operator_desk.hpp"

namespace snug::session::internal {

void OperatorDesk::read() {
  if (source_ && !orders_.is_over) orders_ = source_();
}

std::optional<OperatorOrder> OperatorDesk::use(const OperatorOrder* order, const std::string& item) {
  if (order == nullptr) return std::nullopt;
  used_.insert(order->line);
  OperatorOrder used = *order;
  used.at = item;
  return used;
}

const OperatorOrder* OperatorDesk::find_out(const std::string& item) const {
  bool has_earlier = false;  // for the next item, too: in their order
  for (const OperatorOrder& one : orders_.orders) {
    if (used_.contains(one.line)) continue;
    if (one.action != OperatorAction::TakeOut) {
      has_earlier = has_earlier || one.at.empty();
    } else if (one.at == item || (one.at.empty() && !has_earlier)) {
      return &one;
    }
  }
  return nullptr;
}

bool OperatorDesk::wants_out(const std::string& item) {
  read();
  return find_out(item) != nullptr;
}

std::optional<OperatorOrder> OperatorDesk::take_out_order(const std::string& item) {
  read();
  return use(find_out(item), item);
}

std::optional<OperatorOrder> OperatorDesk::take_order(const std::string& item) {
  read();
  for (const OperatorOrder& one : orders_.orders) {
    const bool is_for_later = one.action == OperatorAction::TakeOut && one.at.empty();
    if (used_.contains(one.line) || is_for_later || (!one.at.empty() && one.at != item)) continue;
    return use(&one, item);
  }
  return std::nullopt;
}

}  // namespace snug::session::internal
