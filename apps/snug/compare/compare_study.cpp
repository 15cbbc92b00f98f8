// A comparison as a study of `snug pack`: the words that repeat each session, and the file of --dir.
#include "apps/snug/compare/compare_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace snug::app {
namespace {

/// The words that all sessions have.
OptionWords common_words(const PackOptions& pack, std::uint64_t seed) {
  const PackOptions usual;
  OptionWords words = words_of(pack.changes);
  const auto add = [&](const char* option, const auto& value, const auto& otherwise) {
    if (value != otherwise) words.emplace_back(option, fmt::format("{}", value));
  };
  words.emplace_back("--seed", std::to_string(seed));
  for (const std::string& change : pack.plant_set) words.emplace_back("--plant-set", change);
  add("--perception", pack.perception, usual.perception);
  add("--samples", pack.samples, usual.samples);
  if (pack.skips) words.emplace_back("--skips", std::to_string(*pack.skips));
  add("--decision-time", pack.decision_time, usual.decision_time);
  add("--future", pack.future, usual.future);
  add("--fault", pack.fault, usual.fault);
  add("--controller", pack.controller, usual.controller);
  if (pack.tempo) words.emplace_back("--tempo", fmt::format("{}", *pack.tempo));
  if (pack.robot) words.emplace_back("--robot", *pack.robot);
  return words;
}

}  // namespace

std::string recording_path(const std::string& folder, std::size_t index, const study::SessionPoint& point) {
  std::string name = fmt::format("{:03}-{}-{}-plant-{}.h5", index + 1, point.agent, point.sequence, point.plant_seed);
  std::ranges::replace_if(
      name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.'; }, '-');
  return (std::filesystem::path(folder) / name).string();
}

study::Study make_compare_study(const CompareOptions& options, std::uint64_t seed,
                                const std::vector<study::SessionPoint>& points) {
  study::ListDesign design{"compare",
                           "pack",
                           options.pack.scenario,
                           common_words(options.pack, seed),
                           {"--agent", "--sequence", "--plant-seed"},
                           {},
                           study::session_outputs()};
  if (options.random > 0) design.factors.emplace_back("--random-seed");
  if (options.runs) design.factors.emplace_back("--record");
  for (const study::SessionPoint& point : points) {
    std::vector<std::string>& values =
        design.points.emplace_back(std::vector{point.agent, point.sequence, std::to_string(point.plant_seed)});
    if (options.random > 0) values.push_back(point.is_random ? std::to_string(options.random_seed) : "false");
    if (options.runs) values.push_back(point.recording);
  }
  return study::make_list_study(design);
}

}  // namespace snug::app
