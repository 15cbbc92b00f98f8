// Text from outside: is it UTF-8, and how is it shown in a message.
#include "snug/core/text.hpp"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "snug/core/input_error.hpp"

namespace snug {
namespace {

constexpr std::string_view kDots = "...";

/// Bytes of the well-formed character at `at`; 0 when there is none. Table 3-7 of the Unicode standard.
std::size_t character_bytes(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[at + i]); };
  const auto is_within = [&](std::size_t i, unsigned low, unsigned high) {
    return at + i < text.size() && byte(i) >= low && byte(i) <= high;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first <= 0xdf) return is_within(1, 0x80, 0xbf) ? 2 : 0;
  if (first >= 0xe0 && first <= 0xef) {
    const bool is_good = is_within(1, first == 0xe0 ? 0xa0 : 0x80, first == 0xed ? 0x9f : 0xbf);
    return is_good && is_within(2, 0x80, 0xbf) ? 3 : 0;
  }
  if (first >= 0xf0 && first <= 0xf4) {
    const bool is_good = is_within(1, first == 0xf0 ? 0x90 : 0x80, first == 0xf4 ? 0x8f : 0xbf);
    return is_good && is_within(2, 0x80, 0xbf) && is_within(3, 0x80, 0xbf) ? 4 : 0;
  }
  return 0;
}

/// Number of a well-formed character of two or three bytes (none of those to be hidden has four).
unsigned number_of(std::string_view character) {
  const auto low = [&](std::size_t i) { return static_cast<unsigned char>(character[i]) & 0x3fU; };
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 2) return (first & 0x1fU) << 6U | low(1);
  return (first & 0x0fU) << 12U | low(1) << 6U | low(2);
}

/// C1 controls, line separators, and marks that make a terminal show text in another order than it has.
bool is_hidden(unsigned number) {
  return (number >= 0x80 && number < 0xa0) || number == 0x2028 || number == 0x2029 ||
         (number >= 0x200e && number <= 0x200f) || (number >= 0x202a && number <= 0x202e) ||
         (number >= 0x2066 && number <= 0x2069);
}

/// Of one well-formed character.
bool needs_escape(std::string_view character) {
  const auto first = static_cast<unsigned char>(character[0]);
  if (character.size() == 1) return first < 0x20 || first == 0x7f;
  return character.size() < 4 && is_hidden(number_of(character));
}

std::string escaped(const char* format, unsigned number) {
  char text[16];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

/// One character or escape each. No longer than asked for, so that a message about a huge text costs little.
std::vector<std::string> shown(std::string_view text, std::size_t most) {
  std::vector<std::string> all;
  for (std::size_t at = 0; at < text.size() && all.size() < most;) {
    const std::size_t bytes = character_bytes(text, at);
    const auto first = static_cast<unsigned char>(text[at]);
    const std::string_view character = text.substr(at, std::max<std::size_t>(1, bytes));
    if (first == '\n' || first == '\t' || first == '\r') {
      all.emplace_back(first == '\n' ? "\\n" : first == '\t' ? "\\t" : "\\r");
    } else if (bytes > 0 && !needs_escape(character)) {
      all.emplace_back(character);
    } else {
      all.push_back(bytes < 2 ? escaped("\\x%02x", first) : escaped("\\u%04x", number_of(character)));
    }
    at += character.size();
  }
  return all;
}

template <class Iterator>
std::string joined(Iterator begin, Iterator end) {
  std::string text;
  for (; begin != end; ++begin) text += *begin;
  return text;
}

}  // namespace

std::size_t find_not_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t bytes = character_bytes(text, at);
    if (bytes == 0) return at;
    at += bytes;
  }
  return std::string_view::npos;
}

void check_utf8(std::string_view text, std::string_view name) {
  const std::size_t at = find_not_utf8(text);
  if (at == std::string_view::npos) return;
  if (text.starts_with("\x89HDF\r\n\x1a\n"))
    throw InputError(std::string(name), "", "an HDF5 file, such as a recording", "text in UTF-8");
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  throw InputError(std::string(name) + ":" + std::to_string(line), "",
                   "the byte " + escaped("0x%02x", static_cast<unsigned char>(text[at])), "text in UTF-8");
}

std::string printable(std::string_view text, std::size_t most) {
  const std::vector<std::string> all = shown(text, most + 1);
  if (all.size() <= most) return joined(all.begin(), all.end());
  const std::size_t kept = most - std::min(most, kDots.size());
  return joined(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(kept)) + std::string(kDots);
}

std::string printable_end(std::string_view text, std::size_t most) {
  // A character has at most four bytes: what lies farther from the end is not shown.
  if (text.size() > 4 * (most + 1)) text.remove_prefix(text.size() - 4 * (most + 1));
  const std::vector<std::string> all = shown(text, text.size());
  if (all.size() <= most) return joined(all.begin(), all.end());
  const std::size_t kept = most - std::min(most, kDots.size());
  return std::string(kDots) + joined(all.end() - static_cast<std::ptrdiff_t>(kept), all.end());
}

bool is_printable(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t bytes = character_bytes(text, at);
    if (bytes == 0 || needs_escape(text.substr(at, bytes))) return false;
    at += bytes;
  }
  return true;
}

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

}  // namespace snug
