// Tracking of a program, and its robot: comments of its file say for which it was made.
#include "snug/motion/program_tracking.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <string>

#include "snug/core/csv_fields.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"

namespace snug::motion {
namespace {

const std::array<std::string, 2> kKeys{"tempo", "tracking"};
constexpr std::string_view kRobot = "robot";
constexpr double kLeast = 0.1;  ///< as FastTracking

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

std::string lower(std::string_view word) {
  std::string text(word);
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return text;
}

std::optional<double> parse_number(std::string_view text) {
  double value = 0.0;
  const auto [last, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || last != text.data() + text.size()) return std::nullopt;
  return value;
}

/// "WORD: VALUE" of a comment; blanks around both are left out.
struct Setting {
  std::string word;       ///< in small letters; empty: the comment is no setting
  char separator = '\0';  ///< ':', '=', or none
  std::string_view value;
};

Setting parse_comment(std::string_view comment) {
  const auto* const end = std::ranges::find_if_not(comment, is_letter);
  const auto length = static_cast<std::size_t>(end - comment.begin());
  Setting setting{lower(comment.substr(0, length)), '\0', trim(comment.substr(length))};
  if (setting.value.starts_with(':') || setting.value.starts_with('=')) {
    setting.separator = setting.value.front();
    setting.value = trim(setting.value.substr(1));
  }
  return setting;
}

/// Whether the tempo was meant, and is written as none: "tmepo: 1", "tempo = 1", "tempo 1".
bool is_misspelt(const Setting& setting) {
  if (!parse_number(setting.value)) return false;
  if (setting.word == kKeys[0]) return setting.separator != ':';
  if (setting.word == kKeys[1]) return false;  // refused as a value
  return setting.separator != '\0' && !find_nearest(setting.word, kKeys).empty();
}

/// Calls visit(what stands behind the '#', line from 1) for each comment.
template <class Visit>
void visit_comments(std::string_view text, const Visit& visit) {
  text = without_byte_order_mark(text);
  for (int line = 1; !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    const std::string_view row = trim(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (row.starts_with('#')) visit(trim(row.substr(1)), line);
  }
}

/// Of a comment that says tempo or tracking.
Tracking read_value(const Setting& setting, const std::string& place) {
  const auto fail = [&](const std::string& expected) {
    throw InputError(place, setting.word, fmt::format("'{}'", setting.value), expected);
  };
  if (setting.word == kKeys[0]) {
    const std::optional<double> tempo = parse_number(setting.value);
    if (!tempo || !(*tempo >= kLeast && *tempo <= 1.0)) fail(fmt::format("a number from {} to 1", kLeast));
    return FastTracking{*tempo};
  }
  const std::string word = lower(setting.value);
  if (word == name_of(ExactTracking{})) return ExactTracking{};
  if (word != name_of(LaggedTracking{})) fail("lagged or exact; fast is said by a tempo");
  return LaggedTracking{};
}

}  // namespace

std::string format_tracking(const Tracking& tracking) {
  if (is_fast(tracking)) return fmt::format("# {}: {}\n", kKeys[0], tempo_of(tracking));
  return is_exact(tracking) ? fmt::format("# {}: {}\n", kKeys[1], name_of(tracking)) : std::string();
}

Tracking find_tracking(std::string_view text, std::string_view name) {
  std::optional<Tracking> found;
  visit_comments(text, [&](std::string_view comment, int line) {
    const Setting setting = parse_comment(comment);
    const std::string place = fmt::format("{}:{}", name, line);
    if (is_misspelt(setting)) throw InputError(place, "", fmt::format("'# {}'", comment), "'# tempo: NUMBER'");
    if (setting.separator != ':' || (setting.word != kKeys[0] && setting.word != kKeys[1])) return;
    if (found) throw InputError(place, setting.word, fmt::format("'{}'", setting.value), "one tempo or tracking");
    found = read_value(setting, place);
  });
  return found.value_or(LaggedTracking{});
}

std::string format_robot(std::string_view robot) {
  return robot.empty() ? std::string() : fmt::format("# {}: {}\n", kRobot, robot);
}

std::string find_robot(std::string_view text, std::string_view name) {
  std::string found;
  visit_comments(text, [&](std::string_view comment, int line) {
    const Setting setting = parse_comment(comment);
    if (setting.separator != ':' || setting.word != kRobot || setting.value.empty()) return;
    if (setting.value.find_first_of(" \t") != std::string_view::npos) return;
    if (!found.empty())
      throw InputError(fmt::format("{}:{}", name, line), setting.word, fmt::format("'{}'", setting.value), "one robot");
    found = setting.value;
  });
  return found;
}

}  // namespace snug::motion
