// RunProgress: how far a run has come, by the log of events that `snug pack --log` writes while it goes on.
#pragma once

#include <string>
#include <string_view>

#include "snug/session/event_log.hpp"

namespace snug::workspace {

struct RunProgress {
  std::string sequence, agent, plant;
  int items = 0;                 ///< of the order
  int done = 0;                  ///< of these, with whatever end
  int packed = 0;                ///< of those done: placed or accepted, as far as is believed
  int lost = 0;                  ///< of those done: not seen any more, or out of reach
  double planned_percent = 0.0;  ///< of the container, after the last item
  double time = 0.0;             ///< s, of the plant
  /// The session said its end. False: it goes on, or was killed (`snug pack --resume` goes on with it).
  bool is_over = false;
  std::string failure;  ///< of a session that is over; empty: none
  bool operator==(const RunProgress&) const = default;
};

[[nodiscard]] RunProgress progress_of(const session::EventLog& log);
/// Of a text of lines; a last one that is broken off is left out. Throws InputError with `name:line` for others that
/// are no events.
[[nodiscard]] RunProgress read_progress(std::string_view text, const std::string& name);

}  // namespace snug::workspace
