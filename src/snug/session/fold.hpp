// fold: what became of a session, made of its events.
#pragma once

#include <span>
#include <vector>

#include "snug/session/event.hpp"

namespace snug::session {

/// Takes events one by one; the result so far can be read after each.
class ResultFold {
 public:
  void add(const SessionEvent& one);
  [[nodiscard]] const SessionResult& result() const { return result_; }

 private:
  /// Of the item on top; nullptr: it is not this one.
  [[nodiscard]] ItemReport* report_of(model::ItemIndex item);
  void leave_out_of_plan(const std::string& id);
  void take(const event::SessionStarted& one);
  void take(const event::DecidedBefore& one);
  void take(const event::ItemStarted& one);
  void take(const event::Planned& one);
  void take(const event::MotionStarted& one);
  void take(const event::MotionEnded& one);
  void take(const event::Sent& one);
  void take(const event::SendEnded& one);
  void take(const event::Assessed& one);
  void take(const event::Remedied& one);
  void take(const event::Operated& one);
  void take(const event::ItemEnded& one);
  void take(const event::ItemLost& one);
  void take(const event::SessionEnded& one);

  SessionResult result_;
  std::vector<std::string> ids_;  ///< by ItemIndex
  bool places_are_chosen_ = false;
  std::vector<ItemReport> open_;           ///< items under way; the last is on top
  std::vector<event::Repacked> repacked_;  ///< since the last item ended
  std::vector<double> decided_before_;     ///< s
  double dropped_wait_ = 0.0;              ///< s, for a plan of an item that is not yet begun
};

[[nodiscard]] SessionResult fold(std::span<const SessionEvent> events);

}  // namespace snug::session
