// Checks of option values, with messages for people.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <string>
#include <vector>

namespace snug::app {

/// The word must be one of these; the message lists them and names the nearest.
[[nodiscard]] CLI::Validator one_of(std::vector<std::string> words);
/// The same, or any word with a colon; `other` says in messages what that is.
[[nodiscard]] CLI::Validator one_of(std::vector<std::string> words, const std::string& other);
/// The words of an option that was checked with `one_of`; else none.
[[nodiscard]] std::vector<std::string> choices_of(CLI::Option& option);
/// A finite number above zero.
[[nodiscard]] CLI::Validator positive();
/// A number that is none of inf and nan, such as an instant.
[[nodiscard]] CLI::Validator finite();
/// A whole number that fits into 64 bits, `least` or more.
[[nodiscard]] CLI::Validator whole(std::uint64_t least);
/// A whole number from `least` to `most`.
[[nodiscard]] CLI::Validator whole(std::uint64_t least, std::uint64_t most);

}  // namespace snug::app
