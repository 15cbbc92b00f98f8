// Checks of option values, with messages for people.
#include "snug/commands/checks.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <sstream>
#include <string_view>

#include "snug/core/input_error.hpp"

namespace snug::commands {
namespace {

/// The name that validators of `one_of` carry, before the words: how completion in shells and the manual find them.
constexpr std::string_view kOneOf = "one of ";

template <class Number>
bool reads_as(std::string_view text, Number& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

Check one_of(std::vector<std::string> words) { return one_of(std::move(words), ""); }

Check one_of(std::vector<std::string> words, const std::string& other) {
  std::string name(kOneOf);
  for (const std::string& word : words) name += (&word == &words.front() ? "" : ",") + word;
  return {[words = std::move(words), other](const std::string& text) {
            if (!other.empty() && text.find(':') != std::string::npos) return std::string();
            std::string list;
            for (const std::string& word : words) {
              if (word == text) return std::string();
              list += (list.empty() ? "" : ", ") + word;
            }
            const std::string_view nearest = find_nearest(text, words);
            const std::string hint = nearest.empty() ? "" : "; did you mean " + std::string(nearest) + "?";
            return "got '" + text + "'; expected one of " + list + (other.empty() ? "" : ", or " + other) + hint;
          },
          name};
}

std::vector<std::string> choices_in(const std::string& name) {
  std::vector<std::string> words;
  if (!name.starts_with(kOneOf)) return words;
  std::istringstream list(name.substr(kOneOf.size()));
  for (std::string word; std::getline(list, word, ',');) words.push_back(word);
  return words;
}

Check positive() {
  return {[](const std::string& text) {
            double value = 0.0;
            const bool fits = reads_as(text, value) && std::isfinite(value) && value > 0.0;
            return fits ? std::string() : "got '" + text + "'; expected a number above 0";
          },
          {}};
}

Check finite() {
  return {[](const std::string& text) {
            double value = 0.0;
            const std::string_view digits = std::string_view(text).substr(text.starts_with('+') ? 1 : 0);
            const bool fits = reads_as(digits, value) && std::isfinite(value);
            return fits ? std::string() : "got '" + text + "'; expected a finite number";
          },
          {}};
}

Check whole(std::uint64_t least) {
  return {[least](const std::string& text) {
            std::uint64_t value = 0;
            const bool fits = reads_as(text, value) && value >= least;
            return fits ? std::string()
                        : "got '" + text + "'; expected a whole number, " + std::to_string(least) +
                              " or more, below 2^64";
          },
          {}};
}

Check whole(std::uint64_t least, std::uint64_t most) {
  return {[least, most](const std::string& text) {
            std::uint64_t value = 0;
            const bool fits = reads_as(text, value) && value >= least && value <= most;
            return fits ? std::string()
                        : "got '" + text + "'; expected a whole number from " + std::to_string(least) + " to " +
                              std::to_string(most);
          },
          {}};
}

Check within(double low, double high) {
  return {[low, high](const std::string& text) {
            double value = 0.0;
            const bool fits = reads_as(text, value) && value >= low && value <= high;
            return fits ? std::string() : fmt::format("got '{}'; expected a number from {} to {}", text, low, high);
          },
          {}};
}

}  // namespace snug::commands
