// RowName: which box a row of a program is for, by the row's name: written one way, read in ours and the
// demonstrator's.
#include "snug/motion/row_name.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "snug/core/check.hpp"

namespace snug::motion {
namespace {

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

bool is_period(double value) noexcept { return value >= 0.01 && value < 9.995; }

}  // namespace

std::string row_name(std::string_view kind, std::string_view box, std::string_view suffix) {
  return std::string(kind) + "(" + std::string(box) + ")" + std::string(suffix);
}

std::string with_swing(const std::string& row, const Swing& swing) {
  SNUG_CHECK(is_period(swing.slow) && is_period(swing.fast), "periods of a swing");
  return fmt::format("{}~{:.2f}+{:.2f}", row, swing.slow, swing.fast);
}

std::optional<Swing> swing_of(std::string_view row) noexcept {
  const std::size_t mark = row.rfind('~');
  if (mark == std::string_view::npos) return std::nullopt;
  const char* const end = row.data() + row.size();
  Swing swing;
  const auto slow = std::from_chars(row.data() + mark + 1, end, swing.slow);
  if (slow.ec != std::errc() || slow.ptr == end || *slow.ptr != '+') return std::nullopt;
  const auto fast = std::from_chars(slow.ptr + 1, end, swing.fast);
  const bool is_whole = fast.ec == std::errc() && (fast.ptr == end || *fast.ptr == '_');
  return is_whole && is_period(swing.slow) && is_period(swing.fast) ? std::optional<Swing>(swing) : std::nullopt;
}

std::size_t names_box(std::string_view row, std::string_view kind, std::string_view id) noexcept {
  if (!row.starts_with(kind)) return 0;
  const std::string_view rest = row.substr(kind.size());
  if (rest.starts_with('(')) {  // our suffixes have no brackets, ids may: the last one ends the id
    const std::size_t end = rest.rfind(')');
    const bool is_whole = end != std::string_view::npos && rest.substr(1, end - 1) == id;
    return is_whole ? 2 * rest.size() : 0;
  }
  if (const std::size_t whole = begins_with_word(rest, id)) return 2 * whole;
  const std::string_view number = number_of(id);
  std::string_view short_form = rest;
  if (short_form.starts_with("Box")) {
    short_form.remove_prefix(3);
  } else if (short_form.starts_with('_')) {
    short_form.remove_prefix(1);
  }
  const std::size_t digits = begins_with_word(short_form, number);
  return digits > 0 ? 2 * digits - 1 : 0;
}

}  // namespace snug::motion
