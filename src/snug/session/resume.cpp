// ResumePoint: where a session that ended early can be gone on with, by its log of events.
#include "snug/session/resume.hpp"

#include <algorithm>
#include <type_traits>

#include "snug/core/input_error.hpp"

namespace snug::session {
namespace {

template <class Kind>
bool is_a(const SessionEvent& one) {
  return std::holds_alternative<Kind>(one);
}

/// Items are of the session, and none ends that was not begun: what reads the events relies on it.
void check(const std::vector<SessionEvent>& events, const std::string& name) {
  const std::size_t count = std::get<event::SessionStarted>(events.front()).items.size();
  int under_way = 0;
  const auto expect = [&](bool is_right, std::size_t line) {
    if (is_right) return;
    throw InputError(name + ":" + std::to_string(line + 1), "item", "one that is not of the session, or not begun",
                     "the events of one session in their order");
  };
  for (std::size_t i = 0; i < events.size(); ++i) {
    under_way += is_a<event::ItemStarted>(events[i]) ? 1 : is_a<event::ItemEnded>(events[i]) ? -1 : 0;
    expect(under_way >= 0 && (i == 0 || !is_a<event::SessionStarted>(events[i])), i);
    std::visit(
        [&]<class Kind>(const Kind& one) {
          if constexpr (requires { one.item; }) {
            constexpr bool kMayBeNone = std::is_same_v<Kind, event::MotionStarted> ||
                                        std::is_same_v<Kind, event::MotionEnded> ||
                                        std::is_same_v<Kind, event::Stepped>;
            expect(one.item.is_valid() ? one.item.slot() < count : kMayBeNone, i);
          }
          if constexpr (std::is_same_v<Kind, event::Counted>) {
            for (const event::Standing& box : one.boxes) expect(box.item.is_valid() && box.item.slot() < count, i);
          }
        },
        events[i]);
  }
}

}  // namespace

int ResumePoint::item_count() const {
  int under_way = 0, done = 0;
  for (const SessionEvent& one : events) {
    if (is_a<event::ItemStarted>(one)) ++under_way;
    if (is_a<event::ItemEnded>(one) && --under_way == 0) ++done;
  }
  return done;
}

ResumePoint find_resume_point(const EventLog& log, const std::string& name) {
  const auto& all = log.events;
  if (all.empty() || !is_a<event::SessionStarted>(all.front())) {
    throw InputError(name, "", "no start of a session", "a log of `snug pack --log`");
  }
  if (std::get<event::SessionStarted>(all.front()).places_are_chosen) {
    throw InputError(name, "agent", "'" + std::get<event::SessionStarted>(all.front()).agent + "'",
                     "an agent that decides item by item: this one plans the whole sequence before it begins");
  }
  check(all, name);
  const auto stopped = std::ranges::find_if(all, is_a<event::Stopped>);
  if (stopped != all.end()) {
    const auto& why = std::get<event::Stopped>(*stopped);
    const bool may_go_on = why.reason == StopReason::Interrupted || why.reason == StopReason::PlantFault ||
                           why.reason == StopReason::NoFrame;
    if (!may_go_on) throw InputError(name, "", "a session that came to its end: " + why.text, "one that ended early");
  }
  ResumePoint point;
  auto end = all.begin() + 1;
  for (auto one = all.begin(); one != stopped; ++one) {
    const auto* counted = std::get_if<event::Counted>(&*one);
    if (counted == nullptr) continue;
    point.boxes = counted->boxes;
    point.time = counted->time;
    end = one + 1;
  }
  point.events.assign(all.begin(), end);
  for (const SessionEvent& one : all) {
    const auto* brought = std::get_if<event::ItemBrought>(&one);
    if (brought != nullptr && std::ranges::find(point.to_do, brought->item) == point.to_do.end())
      point.to_do.push_back(brought->item);
  }
  for (const SessionEvent& one : point.events) {
    if (const auto* ended = std::get_if<event::ItemEnded>(&one)) std::erase(point.to_do, ended->item);
  }
  return point;
}

}  // namespace snug::session
