// RunProgress: how far a run has come, by the log of events that `snug pack --log` writes while it goes on.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "snug/session/event_log.hpp"
#include "snug/session/fold.hpp"
#include "snug/workspace/folder.hpp"

namespace snug::workspace {

/// An item that came to an end.
struct BoxProgress {
  std::string id;
  std::string end;     ///< as session::name_of() says it
  std::string reason;  ///< for people, where it is not placed
  bool is_packed = false;
  bool operator==(const BoxProgress&) const = default;
};

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
  std::string now;      ///< id of the item that is under way; empty: none
  std::string held;     ///< id of the item at which who operates is waited for; empty: none
  std::string stopped;  ///< why no more items came, for people
  std::string failure;  ///< of a session that is over; empty: none
  std::vector<BoxProgress> boxes;
  bool operator==(const RunProgress&) const = default;
};

/// Takes events one by one; the progress so far can be read after each.
class ProgressFold {
 public:
  void add(const session::SessionEvent& one);
  [[nodiscard]] RunProgress progress() const;

 private:
  std::vector<std::string> ids_;  ///< by ItemIndex
  RunProgress said_;              ///< without what the result counts
  session::ResultFold fold_;
};

/// A log that grows: reads only what is new. Lines of events that say nothing of the progress (motions, plans with all
/// that was tried: nine tenths of a log) are passed over by their kind, unread.
class LogReader {
 public:
  /// Throws InputError for whole lines that are no events.
  void read(const Folder& folder, const std::string& name);
  [[nodiscard]] std::uintmax_t offset() const { return offset_; }
  [[nodiscard]] const RunProgress& progress() const { return progress_; }

 private:
  std::uintmax_t offset_ = 0;  ///< behind the last whole line
  int lines_ = 0;
  session::EventOrder order_;
  ProgressFold fold_;
  RunProgress progress_;  ///< that of the fold
};

[[nodiscard]] RunProgress progress_of(const session::EventLog& log);
/// Of a text of lines; a last one that is broken off is left out. Throws InputError with `name:line` for others that
/// are no events.
[[nodiscard]] RunProgress read_progress(std::string_view text, const std::string& name);

}  // namespace snug::workspace
