// Design: which values a row has, from its index alone.
#include "snug/study/design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "snug/core/hash.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/study/sobol.hpp"

namespace snug::study {
namespace {

/// The value at `u`, 0 .. 1 (excluded), of what the factor may be.
std::string value_at(const Factor& factor, double u) {
  if (!factor.values.empty()) {
    const auto count = static_cast<double>(factor.values.size());
    return factor.values[std::min(factor.values.size() - 1, static_cast<std::size_t>(u * count))];
  }
  double value = 0.0;
  if (factor.is_whole) {
    value = std::floor(factor.from + u * (factor.to - factor.from + 1.0));
  } else if (factor.is_log) {
    value = std::exp(std::log(factor.from) + u * (std::log(factor.to) - std::log(factor.from)));
  } else {
    value = factor.from + u * (factor.to - factor.from);
  }
  return fmt::format("{}", value);
}

std::uint32_t shift_of(const Study& study, const Factor& factor) {
  return static_cast<std::uint32_t>(Rng(study.seed).split("sobol " + factor.name).next() >> 32U);
}

std::vector<std::string> values_of(const Study& study, std::uint64_t point) {
  std::vector<std::string> values(study.factors.size());
  if (study.design == Design::List) return study.points[point];
  if (study.design == Design::Grid) {
    for (std::size_t i = study.factors.size(); i-- > 0;) {
      const std::vector<std::string>& levels = study.factors[i].values;
      values[i] = levels[point % levels.size()];
      point /= levels.size();
    }
    return values;
  }
  for (std::size_t i = 0; i < study.factors.size(); ++i) {
    const Factor& factor = study.factors[i];
    const double u =
        study.design == Design::Sobol
            ? sobol(static_cast<std::uint32_t>(point), static_cast<int>(i), shift_of(study, factor))
            : Rng(study.seed).split("factor " + factor.name).split("point " + std::to_string(point)).uniform();
    values[i] = value_at(factor, u);
  }
  return values;
}

}  // namespace

Row row_of(const Study& study, std::uint64_t index) {
  Row row;
  row.index = index;
  row.point = index / static_cast<std::uint64_t>(study.repeat);
  row.repeat = static_cast<int>(index % static_cast<std::uint64_t>(study.repeat));
  const std::string who =
      study.seed_by == SeedBy::Row ? "row " + std::to_string(index) : "repeat " + std::to_string(row.repeat);
  // 53 bits: whatever reads it as a number that JSON has reads it exactly.
  row.seed = Rng(study.seed).split("seed of " + who).next() >> 11U;
  row.values = values_of(study, row.point);
  return row;
}

std::vector<std::string> words_of(const Study& study, const Row& row) {
  std::vector<std::string> words = {study.verb};
  if (!study.scenario.empty()) words.push_back(study.scenario);
  words.insert(words.end(), study.options.begin(), study.options.end());
  for (std::size_t i = 0; i < study.factors.size(); ++i) {
    const Factor& factor = study.factors[i];
    if (factor.option.empty()) {
      words.insert(words.end(), {"--set", factor.key + "=" + row.values[i]});
    } else if (row.values[i] == "true") {  // a flag
      words.push_back(factor.option);
    } else if (row.values[i] != "false") {
      words.insert(words.end(), {factor.option, row.values[i]});
    }
  }
  if (!study.seed_option.empty()) words.insert(words.end(), {study.seed_option, std::to_string(row.seed)});
  return words;
}

std::string quoted(const std::string& word) {
  const bool is_plain = !word.empty() && std::ranges::all_of(word, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("-_=./,:+%@").find(c) != std::string_view::npos;
  });
  if (is_plain) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

std::string command_of(const Study& study, const Row& row) {
  std::string line = "snug";
  for (const std::string& word : words_of(study, row)) line += " " + quoted(word);
  return line;
}

std::pair<std::uint64_t, std::uint64_t> parse_chunks(const std::string& words, const Study& study) {
  const char* const end = words.data() + words.size();
  std::uint64_t first = 0, last = 0;
  auto [at, error] = std::from_chars(words.data(), end, first);
  last = first;
  if (error == std::errc{} && at != end && *at == '-') {
    const auto rest = std::from_chars(at + 1, end, last);
    at = rest.ptr;
    error = rest.ec;
  }
  if (error != std::errc{} || at != end || first > last || last >= study.chunks())
    throw InputError("command line", "--chunks", "'" + words + "'",
                     fmt::format("A or A-B, from 0 to {}", study.chunks() - 1));
  return {first, last};
}

}  // namespace snug::study
