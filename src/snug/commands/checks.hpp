// Checks of option values, with messages for people.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace snug::commands {

/// Of one word: empty, or what is wrong with it.
struct Check {
  std::function<std::string(const std::string&)> find_fault;
  std::string name;  ///< has the words of one_of(): choices_in()
  std::string operator()(const std::string& word) const { return find_fault(word); }
};

/// The word must be one of these; the message lists them and names the nearest.
[[nodiscard]] Check one_of(std::vector<std::string> words);
/// The same, or any word with a colon; `other` says in messages what that is.
[[nodiscard]] Check one_of(std::vector<std::string> words, const std::string& other);
/// The words of a check that one_of() made, by its name; else none.
[[nodiscard]] std::vector<std::string> choices_in(const std::string& name);
/// A finite number above zero.
[[nodiscard]] Check positive();
/// A number that is none of inf and nan, such as an instant.
[[nodiscard]] Check finite();
/// A whole number that fits into 64 bits, `least` or more.
[[nodiscard]] Check whole(std::uint64_t least);
/// A whole number from `least` to `most`.
[[nodiscard]] Check whole(std::uint64_t least, std::uint64_t most);
/// A number from `low` to `high`.
[[nodiscard]] Check within(double low, double high);

}  // namespace snug::commands
