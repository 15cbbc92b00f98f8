// Agenda: the items of a session in their order, and those that are under way now.
#include "snug/session/agenda.hpp"

#include <algorithm>

namespace snug::session {

bool Agenda::is_under_way(model::ItemIndex item) const {
  return std::ranges::find(under_way, item, &ItemTask::item) != under_way.end();
}

std::optional<model::ItemIndex> Agenda::follower_of(model::ItemIndex item) const {
  const auto found = std::ranges::find(order, item);
  if (under_way.size() > 1 || found == order.end() || found + 1 == order.end()) return std::nullopt;
  return *(found + 1);
}

}  // namespace snug::session
