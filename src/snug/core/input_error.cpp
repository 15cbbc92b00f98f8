// InputError: what a person wrote that we cannot use, where it is, and what would do.
#include "snug/core/input_error.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "snug/core/text.hpp"

namespace snug {
namespace {

constexpr std::size_t kLongestWord = 200;  // a longer one is no slip of the keyboard, and would take its time

std::string compose(const std::string& where, const std::string& key, const std::string& got,
                    const std::string& expected) {
  std::string text = where;
  if (!key.empty()) text += ": " + key;
  if (!got.empty()) text += ": got " + got;
  if (!expected.empty()) text += (got.empty() ? ": " : "; ") + std::string("expected ") + expected;
  return text;
}

/// What stood there may be as long as a file: shortened first. The end of a path says most.
std::string compose_printable(const std::string& where, const std::string& key, const std::string& got,
                              const std::string& expected) {
  constexpr std::size_t kLongestPart = 80;
  const auto part = [](const std::string& text) { return printable(text, kLongestMessage + 1); };
  std::string text = compose(printable_end(where, kLongestMessage + 1), part(key), part(got), part(expected));
  if (text.size() > kLongestMessage && !got.empty()) {
    text = compose(printable_end(where, kLongestPart), printable(key, kLongestPart), printable(got, kLongestPart),
                   part(expected));
  }
  return printable(text, kLongestMessage);
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row[b.size()];
}

}  // namespace

InputError::InputError(std::string where_, std::string key_, std::string got_, std::string expected_)
    : std::runtime_error(compose_printable(where_, key_, got_, expected_)),
      where(std::move(where_)),
      key(std::move(key_)),
      got(std::move(got_)),
      expected(std::move(expected_)) {}

void require_number(bool holds, const char* where, const char* key, double got, const char* expected) {
  if (!holds) throw InputError(where, key, std::to_string(got), expected);
}

std::string_view find_nearest(std::string_view word, std::span<const std::string> candidates) {
  std::string_view best;
  if (word.size() > kLongestWord) return best;
  std::size_t best_distance = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

}  // namespace snug
