// Event logs: the events of a session as lines of JSON, written while it goes on, and read back.
#include "snug/session/event_log.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/output_file.hpp"
#include "snug/core/read_file.hpp"
#include "snug/session/internal/event_forms.hpp"

namespace snug::session {
namespace {

constexpr std::size_t kLargestLog = std::size_t{1} << 30U;

/// In the order of the alternatives of SessionEvent.
constexpr std::array<const char*, std::variant_size_v<SessionEvent>> kKinds{
    "session started", "decided before", "stepped",      "item started",   "item brought", "perceived",
    "planned",         "plan dropped",   "sent",         "motion started", "motion ended", "send ended",
    "assessed",        "remedied",       "operated",     "item ended",     "repacked",     "item lost",
    "counted",         "stopped",        "session ended"};

template <std::size_t kIndex = 0>
SessionEvent read_alternative(std::size_t index, const JsonReader& reader) {
  if constexpr (kIndex < std::variant_size_v<SessionEvent>) {
    if (index != kIndex) return read_alternative<kIndex + 1>(index, reader);
    return reader.as<std::variant_alternative_t<kIndex, SessionEvent>>();
  } else {
    reader.fail("an event");
  }
}

void expect_in_order(bool holds, const std::string& place, const std::string& expected) {
  if (!holds) throw InputError(place, "event", "out of order", expected);
}

}  // namespace

template <class Event>
void EventOrder::check(const Event& event, const std::string& place) const {
  using std::is_same_v;
  constexpr bool is_start = is_same_v<Event, event::SessionStarted>;
  expect_in_order(is_start == (items_ < 0), place,
                  is_start ? "one start of a session" : "the start of a session first");
  constexpr bool is_of_top =
      is_same_v<Event, event::Sent> || is_same_v<Event, event::SendEnded> || is_same_v<Event, event::ItemEnded>;
  constexpr bool may_be_none = is_same_v<Event, event::Stepped> || is_same_v<Event, event::MotionStarted> ||
                               is_same_v<Event, event::MotionEnded>;
  if constexpr (requires { event.item; }) {
    const bool is_item = event.item.is_valid() && event.item.value < items_;
    expect_in_order(is_item || (may_be_none && !event.item.is_valid()), place, "an item of the session");
  }
  if constexpr (is_of_top) {
    expect_in_order(!under_way_.empty() && under_way_.back().item == event.item, place, "the item that is under way");
  }
  bool needs_send = is_same_v<Event, event::SendEnded>;
  if constexpr (is_same_v<Event, event::Sent>) needs_send = event.replaces_last;
  expect_in_order(!needs_send || under_way_.back().sends > 0, place, "a motion that was sent before");
}

void EventOrder::add(const SessionEvent& one, const std::string& place) {
  std::visit([&](const auto& event) { check(event, place); }, one);
  const auto* started = std::get_if<event::SessionStarted>(&one);
  if (started != nullptr) items_ = static_cast<int>(started->items.size());
  if (const auto* item = std::get_if<event::ItemStarted>(&one)) under_way_.push_back({item->item, 0});
  if (std::holds_alternative<event::ItemEnded>(one)) under_way_.pop_back();
  if (const auto* sent = std::get_if<event::Sent>(&one); sent != nullptr && !sent->replaces_last) {
    ++under_way_.back().sends;
  }
}

const char* kind_of(const SessionEvent& one) { return kKinds[one.index()]; }

std::string format_event(const SessionEvent& one) {
  const JsonValue body = std::visit([](const auto& event) { return write_json(event); }, one);
  JsonValue::Object line{{"event", {std::string(kind_of(one))}}};
  for (const auto& part : std::get<JsonValue::Object>(body.value)) line.push_back(part);
  return format_json({std::move(line)});
}

SessionEvent parse_event(std::string_view text, const std::string& where, int line) {
  JsonValue value = parse_json(text, where, line);
  const std::string place = where + ":" + std::to_string(line);
  const JsonReader reader(value, place);
  const JsonValue* kind = value.find("event");
  if (kind == nullptr) throw InputError(place, "event", "nothing", "this key");
  const auto name = reader.at(*kind, "event").as<std::string>();
  std::vector<std::string> names(kKinds.begin(), kKinds.end());
  for (std::size_t i = 0; i < kKinds.size(); ++i) {
    if (name != kKinds[i]) continue;
    std::erase_if(std::get<JsonValue::Object>(value.value), [](const auto& part) { return part.key == "event"; });
    return read_alternative(i, reader);
  }
  const std::string nearest(find_nearest(name, names));
  throw InputError(place, "event", "'" + name + "'", nearest.empty() ? "a kind of event" : "'" + nearest + "'");
}

EventLog parse_log(std::string_view text, const std::string& name) {
  EventLog log;
  EventOrder order;
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    log.is_whole = end != std::string_view::npos;
    if (!log.is_whole) break;
    log.events.push_back(parse_event(text.substr(0, end), name, line));
    order.add(log.events.back(), name + ":" + std::to_string(line));
    text.remove_prefix(end + 1);
  }
  return log;
}

EventLog load_log(const std::filesystem::path& path) {
  return parse_log(read_file(path, "an event log (JSON lines, snug pack --log)", kLargestLog), path.string());
}

LogFile::LogFile(const std::filesystem::path& path)
    : path_(path.string()), file_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
  if (!file_.is_open()) throw InputError(path_, "", std::strerror(errno), "a place for the event log");
}

void LogFile::write(const SessionEvent& one) {
  const std::string line = format_event(one) + "\n";
  for (std::string_view rest = line; !rest.empty();) {
    const ssize_t written = ::write(file_.get(), rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) throw OutputError(path_, std::strerror(errno));
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace snug::session
