// ResumePoint: where a session that ended early can be gone on with, by its log of events.
#pragma once

#include <string>
#include <vector>

#include "snug/session/event_log.hpp"

namespace snug::session {

/// A session up to the last item that was done with. What was under way after it comes anew.
struct ResumePoint {
  std::vector<SessionEvent> events;  ///< the first is SessionStarted
  std::vector<event::Standing> boxes;
  double time = 0.0;                    ///< s, of the plant
  std::vector<model::ItemIndex> to_do;  ///< items that came and are not done with, in the order in which they came

  [[nodiscard]] const event::SessionStarted& started() const { return std::get<event::SessionStarted>(events.front()); }
  /// How many items are done with.
  [[nodiscard]] int item_count() const;
};

/// Throws InputError, with `name` of the log, where it does not begin with the start of a session, where the session
/// came to its end, or where its agent chose all places before (such a session is planned anew).
[[nodiscard]] ResumePoint find_resume_point(const EventLog& log, const std::string& name);

}  // namespace snug::session
