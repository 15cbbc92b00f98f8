// Waypoint names: what a waypoint is for, as files say it: written one way, read in ours and the demonstrator's.
#include "snug/motion/waypoint_name.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include "snug/core/check.hpp"

namespace snug::motion {
namespace {

constexpr std::array kWords = {std::pair{MotionClass::Home, "home"},
                               std::pair{MotionClass::PrePick, "PrePick"},
                               std::pair{MotionClass::Pick, "Box"},
                               std::pair{MotionClass::PostPick, "PostPick"},
                               std::pair{MotionClass::PreRePick, "PreRePick"},
                               std::pair{MotionClass::RePick, "RePick"},
                               std::pair{MotionClass::PostRePick, "PostRePick"},
                               std::pair{MotionClass::PreTwist, "PreTwist"},
                               std::pair{MotionClass::Twist, "Twist"},
                               std::pair{MotionClass::TwistDrag, "TwistDrag"},
                               std::pair{MotionClass::PrePlace, "PrePlace"},
                               std::pair{MotionClass::Place, "Place"},
                               std::pair{MotionClass::PlaceSlow, "PlaceSlow"},
                               std::pair{MotionClass::PostPlace, "PostPlace"}};

/// The class whose word is the longest that the name begins with.
MotionClass class_of(std::string_view name) noexcept {
  MotionClass best = MotionClass::Other;
  for (const auto& [motion_class, word] : kWords) {
    if (name.starts_with(word) && std::string_view(word).size() > name_of(best).size()) best = motion_class;
  }
  return best;
}

bool is_period(double value) noexcept { return value >= 0.01 && value < 9.995; }

bool is_pace(double value) noexcept { return value >= 0.01 && value <= 1.0; }

double rounded(double exact, int decimals) {
  const std::string text = fmt::format("{:.{}f}", exact, decimals);
  double value = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

std::string text_of(const Swing& swing) {
  const std::string pace = swing.pace < 1.0 ? fmt::format("*{:.2f}", swing.pace) : "";
  return fmt::format("~{:.2f}+{:.2f}{}", swing.slow, swing.fast, pace);
}

std::string text_of(double not_before) { return fmt::format("@{:.3f}", not_before); }

/// What stands behind class and item.
struct Tail {
  std::string variant;
  std::optional<Swing> swing;
};

/// The number behind the last '@' of a text, if that is all that stands there.
std::optional<double> number_behind_at(std::string_view text) {
  const std::size_t mark = text.rfind('@');
  if (mark == std::string_view::npos) return std::nullopt;
  double value = 0.0;
  const auto last = std::from_chars(text.data() + mark + 1, text.data() + text.size(), value);
  if (last.ec == std::errc::invalid_argument || last.ptr != text.data() + text.size()) return std::nullopt;
  return last.ec == std::errc() ? value : kLatestDeparture * 2.0;  // what no number can hold is too late
}

/// Takes an instant from the text's end.
std::optional<double> take_instant(std::string_view& text) {
  const std::optional<double> number = number_behind_at(text);
  if (!number || !(*number >= 0.0 && *number <= kLatestDeparture)) return std::nullopt;
  text = text.substr(0, text.rfind('@'));
  return as_named(*number);
}

Tail parse_tail(std::string_view text) {
  Tail tail{std::string(text), std::nullopt};
  const std::size_t mark = text.rfind('~');
  if (mark == std::string_view::npos) return tail;
  const char* const end = text.data() + text.size();
  Swing swing;
  const auto slow = std::from_chars(text.data() + mark + 1, end, swing.slow);
  if (slow.ec != std::errc() || slow.ptr == end || *slow.ptr != '+') return tail;
  auto last = std::from_chars(slow.ptr + 1, end, swing.fast);
  if (last.ec == std::errc() && last.ptr != end && *last.ptr == '*') {
    last = std::from_chars(last.ptr + 1, end, swing.pace);
  }
  const bool is_whole = last.ec == std::errc() && (last.ptr == end || *last.ptr == '_');
  if (!is_whole || !is_period(swing.slow) || !is_period(swing.fast) || !is_pace(swing.pace)) return tail;
  return {std::string(text.substr(0, mark)) + std::string(last.ptr, end), as_named(swing)};
}

/// Whether what stands behind a '~' is meant as a swing: a number, or two parts with a '+' between them.
bool is_like_swing(std::string_view text) {
  text = text.substr(0, text.find('_'));
  double value = 0.0;
  const auto number = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = number.ec != std::errc::invalid_argument && number.ptr == text.data() + text.size();
  return is_number || text.find('+') != std::string_view::npos;
}

/// Digits of an id of the demonstrator's form, or nothing.
std::string_view number_of(std::string_view id) noexcept {
  if (!id.starts_with("BOX") && !id.starts_with("Box")) return {};
  id.remove_prefix(3);
  const bool is_number = std::ranges::all_of(id, [](char c) { return c >= '0' && c <= '9'; });
  return is_number ? id : std::string_view{};
}

/// Length of `word` when the text begins with it and goes on with a suffix or not at all.
std::size_t begins_with_word(std::string_view text, std::string_view word) noexcept {
  if (word.empty() || !text.starts_with(word)) return 0;
  return text.size() == word.size() || text[word.size()] == '_' ? word.size() : 0;
}

}  // namespace

std::string_view name_of(MotionClass motion_class) noexcept {
  const auto* found = std::ranges::find(kWords, motion_class, [](const auto& entry) { return entry.first; });
  return found != kWords.end() ? found->second : "";
}

bool is_contact(MotionClass motion_class) noexcept {
  switch (motion_class) {
    case MotionClass::Pick:
    case MotionClass::RePick:
    case MotionClass::Twist:
    case MotionClass::TwistDrag:
    case MotionClass::Place:
    case MotionClass::PlaceSlow:
      return true;
    default:
      return false;
  }
}

std::string name_of(const Waypoint& waypoint) {
  const bool has_id = waypoint.item_is_id && !waypoint.item.empty();
  return fmt::format("{}{}{}{}{}{}{}", name_of(waypoint.motion_class), has_id ? "(" : "", waypoint.item,
                     has_id ? ")" : "", waypoint.variant, waypoint.swing ? text_of(*waypoint.swing) : "",
                     waypoint.not_before ? text_of(*waypoint.not_before) : "");
}

Waypoint parse_waypoint_name(std::string_view name) {
  Waypoint waypoint;
  waypoint.not_before = take_instant(name);
  waypoint.motion_class = class_of(name);
  std::string_view rest = name.substr(name_of(waypoint.motion_class).size());
  const bool is_for_item = waypoint.motion_class != MotionClass::Other && waypoint.motion_class != MotionClass::Home;
  const std::size_t bracket = is_for_item && rest.starts_with('(') ? rest.rfind(')') : std::string_view::npos;
  const bool has_id = bracket != std::string_view::npos && bracket > 1;
  if (has_id) {
    waypoint.item = rest.substr(1, bracket - 1);
    rest.remove_prefix(bracket + 1);
  }
  Tail tail = parse_tail(rest);
  waypoint.swing = tail.swing;
  waypoint.item_is_id = !is_for_item || has_id;
  (waypoint.item_is_id ? waypoint.variant : waypoint.item) = std::move(tail.variant);
  return waypoint;
}

bool has_malformed_swing(const Waypoint& waypoint) {
  const std::string_view tail = waypoint.item_is_id ? waypoint.variant : waypoint.item;  // without a swing
  for (std::size_t mark = tail.find('~'); mark != std::string_view::npos; mark = tail.find('~', mark + 1)) {
    if (is_like_swing(tail.substr(mark + 1))) return true;
  }
  return false;
}

bool has_malformed_instant(const Waypoint& waypoint) {
  return number_behind_at(waypoint.item_is_id ? waypoint.variant : waypoint.item).has_value();
}

Waypoint named_waypoint(std::string_view name, const Pose& X_WE, const IO& io) {
  Waypoint waypoint = parse_waypoint_name(name);
  waypoint.X_WE = X_WE;
  waypoint.io = io;
  return waypoint;
}

Swing as_named(const Swing& swing) {
  SNUG_CHECK(is_period(swing.slow) && is_period(swing.fast), "periods of a swing");
  SNUG_CHECK(is_pace(swing.pace), "pace of a swing");
  return {rounded(swing.slow, 2), rounded(swing.fast, 2), rounded(swing.pace, 2)};
}

std::optional<double> as_named(double time) {
  SNUG_CHECK(time >= 0.0 && time <= kLatestDeparture, "an instant of a program");
  const double whole = rounded(time, 3);
  return whole > 0.0 ? std::optional(whole) : std::nullopt;
}

std::size_t fit_of(const Waypoint& waypoint, std::string_view id) noexcept {
  const std::string_view item = waypoint.item;
  if (waypoint.item_is_id) return !item.empty() && item == id ? 2 * item.size() : 0;
  if (const std::size_t whole = begins_with_word(item, id)) return 2 * whole;
  const std::string_view number = number_of(id);
  std::string_view short_form = item;
  if (short_form.starts_with("Box")) {
    short_form.remove_prefix(3);
  } else if (short_form.starts_with('_')) {
    short_form.remove_prefix(1);
  }
  const std::size_t digits = begins_with_word(short_form, number);
  return digits > 0 ? 2 * digits - 1 : 0;
}

}  // namespace snug::motion
