// InputError: what a person wrote that we cannot use, where it is, and what would do.
#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace snug {

/// Thrown only while loading files or arguments; the program catches it once and exits with 2.
class InputError : public std::runtime_error {
 public:
  /// `where`: "file:line", a file or an option; `key`: the offending key (may be empty); `got`: what stood there
  /// (may be empty); `expected`: what would have been right, with the nearest valid name where there is one.
  InputError(std::string where, std::string key, std::string got, std::string expected);

  std::string where;
  std::string key;
  std::string got;
  std::string expected;
};

/// Throws InputError of settings `where` unless the number `got` at `key` `holds` what is expected.
void require_number(bool holds, const char* where, const char* key, double got, const char* expected);

/// The candidate with the smallest edit distance to `word`, or an empty view when none is near
/// (more than 2 edits and more than a third of the word).
[[nodiscard]] std::string_view find_nearest(std::string_view word, std::span<const std::string> candidates);

}  // namespace snug
