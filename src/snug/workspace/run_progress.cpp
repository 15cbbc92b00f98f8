// RunProgress: how far a run has come, by the log of events that `snug pack --log` writes while it goes on.
#include "snug/workspace/run_progress.hpp"

#include <algorithm>
#include <variant>

#include "snug/session/fold.hpp"

namespace snug::workspace {
namespace {

bool is_packed(session::ItemEnd end) { return end == session::ItemEnd::Placed || end == session::ItemEnd::Accepted; }

bool is_lost(session::ItemEnd end) { return end == session::ItemEnd::Left || end == session::ItemEnd::Gone; }

}  // namespace

RunProgress progress_of(const session::EventLog& log) {
  RunProgress progress;
  for (const session::SessionEvent& one : log.events) {
    if (const auto* started = std::get_if<session::event::SessionStarted>(&one)) {
      progress.sequence = started->sequence;
      progress.agent = started->agent;
      progress.plant = started->plant;
      progress.items = static_cast<int>(started->items.size());
    } else if (const auto* counted = std::get_if<session::event::Counted>(&one)) {
      progress.planned_percent = counted->planned_percent;
      progress.time = counted->time;
    } else if (const auto* ended = std::get_if<session::event::SessionEnded>(&one)) {
      progress.is_over = true;
      progress.time = ended->time;
      progress.failure = ended->text;
    }
  }
  const session::SessionResult result = session::fold(log.events);
  progress.done = static_cast<int>(result.items.size());
  const auto count = [&](auto holds) { return static_cast<int>(std::ranges::count_if(result.items, holds)); };
  progress.packed = count([](const session::ItemReport& item) { return is_packed(item.end); });
  progress.lost = count([](const session::ItemReport& item) { return is_lost(item.end); });
  return progress;
}

RunProgress read_progress(std::string_view text, const std::string& name) {
  return progress_of(session::parse_log(text, name));
}

}  // namespace snug::workspace
