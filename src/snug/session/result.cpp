// SessionResult: words for how items and sessions end.
#include "snug/session/result.hpp"

#include <fmt/format.h>

namespace snug::session {

const char* name_of(ItemEnd end) {
  switch (end) {
    case ItemEnd::Placed:
      return "placed";
    case ItemEnd::Accepted:
      return "accepted";
    case ItemEnd::NoPlace:
      return "no place";
    case ItemEnd::Infeasible:
      return "infeasible";
    case ItemEnd::NotHeld:
      return "not held";
    case ItemEnd::Returned:
      return "returned";
    case ItemEnd::Left:
      return "left";
    case ItemEnd::Gone:
      return "gone";
    case ItemEnd::WrongItem:
      return "wrong item";
    case ItemEnd::NotBrought:
      return "not brought";
    case ItemEnd::Rejected:
      return "rejected";
    case ItemEnd::Skipped:
      return "skipped";
    case ItemEnd::TakenOut:
      return "taken out";
  }
  return "";
}

std::string describe(const ItemReport& item) {
  const std::string end = name_of(item.end);
  return item.reason.empty() || item.reason == end ? end : end + ": " + item.reason;
}

std::string describe_room(const ItemReport& item) {
  std::string text;
  for (const packing::Placement& one : item.made_room) {
    const Vector3 p = 1e3 * one.X_TP.p;
    text += fmt::format("{}{} moved to ({:.0f}, {:.0f}, {:.0f}) mm", text.empty() ? "" : ", ", one.item, p.x(), p.y(),
                        p.z());
  }
  return text + " to make room";
}

std::string describe(const OperatorStep& step) {
  std::string text = step.order;
  if (!step.was_followed) text += ", not followed";
  if (!step.text.empty()) text += ": " + step.text;
  return text;
}

const char* name_of(StopReason reason) {
  switch (reason) {
    case StopReason::AllPacked:
      return "all packed";
    case StopReason::NoMoreItems:
      return "no more items";
    case StopReason::NoItems:
      return "no items";
    case StopReason::NoPlace:
      return "no place";
    case StopReason::RobotStops:
      return "robot stops";
    case StopReason::ViewBlocked:
      return "view blocked";
    case StopReason::NoFrame:
      return "no frame";
    case StopReason::PlantFault:
      return "plant fault";
    case StopReason::Interrupted:
      return "interrupted";
  }
  return "";
}

const char* name_of(SessionFailureKind kind) {
  switch (kind) {
    case SessionFailureKind::None:
      return "none";
    case SessionFailureKind::NotHome:
      return "not home";
    case SessionFailureKind::PlantLost:
      return "plant lost";
  }
  return "";
}

std::vector<std::string> rejected_items(const SessionResult& result) {
  std::vector<std::string> rejected;
  for (const ItemReport& item : result.items) {
    if (item.end == ItemEnd::Rejected) rejected.push_back(item.id + " " + item.reason);
  }
  return rejected;
}

int recovery_count(const SessionResult& result) {
  int count = 0;
  for (const ItemReport& item : result.items) count += static_cast<int>(item.recoveries.size());
  return count;
}

}  // namespace snug::session
