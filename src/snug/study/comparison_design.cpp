// comparison_design: what a comparison runs: agents x sequences x plants, and the study of `snug pack` that says the
// same.
#include "snug/study/comparison_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "snug/core/input_error.hpp"
#include "snug/packing/agent.hpp"
#include "snug/packing/python_agent.hpp"
#include "snug/packing/representatives.hpp"

namespace snug::study {
namespace {

/// "all" or a list, each checked against what there is.
std::vector<std::string> choose(const std::string& words, const std::vector<std::string>& known, const char* key,
                                bool may_be_python = false) {
  if (words == "all") return known;
  std::vector<std::string> chosen;
  std::stringstream text(words);
  for (std::string word; std::getline(text, word, ',');) {
    if (std::ranges::find(known, word) == known.end() && !(may_be_python && packing::is_python_agent(word))) {
      throw InputError("command line", key, "'" + word + "'", fmt::format("all, or of {}", fmt::join(known, ", ")));
    }
    chosen.push_back(word);
  }
  if (chosen.empty()) throw InputError("command line", key, "nothing", "all, or names separated by commas");
  return chosen;
}

std::vector<std::string> choose_sequences(const ComparisonChoice& choice, model::Scenario& scenario) {
  std::vector<std::string> known;
  for (const model::Sequence& sequence : scenario.sequences) known.push_back(sequence.name);
  std::vector<std::string> chosen;
  if (choice.sequences || choice.random == 0) chosen = choose(choice.sequences.value_or("all"), known, "--sequences");
  for (int i = 1; i <= choice.random; ++i) {
    chosen.push_back("random-" + std::to_string(i));
    scenario.sequences.push_back(packing::draw_order(scenario, chosen.back(), choice.random_seed));
  }
  return chosen;
}

}  // namespace

ComparisonDesign design_comparison(const ComparisonChoice& choice, model::Scenario& scenario) {
  ComparisonDesign design;
  design.sequences = choose_sequences(choice, scenario);
  design.agents = choose(choice.agents, packing::agent_names(), "--agents", true);
  const std::size_t plants = static_cast<std::size_t>(choice.plants);
  const std::size_t given = design.sequences.size() - static_cast<std::size_t>(choice.random);
  const std::size_t count = design.agents.size() * design.sequences.size() * plants;
  if (count > kMostSessions) {
    throw InputError("command line", "sessions", std::to_string(count),
                     fmt::format("at most {}; `snug study` runs more (docs/studies.md)", kMostSessions));
  }
  for (const std::string& agent : design.agents) {
    for (std::size_t i = 0; i < design.sequences.size(); ++i) {
      const std::size_t first = i > given ? (i - given) * plants : 0;
      for (std::size_t plant = 0; plant < plants; ++plant) {
        design.points.push_back({agent, design.sequences[i], choice.plant_seed + first + plant, i >= given, {}});
        SessionPoint& point = design.points.back();
        if (choice.recordings) point.recording = recording_path(*choice.recordings, design.points.size() - 1, point);
      }
    }
  }
  return design;
}

std::string recording_path(const std::string& folder, std::size_t index, const SessionPoint& point) {
  std::string name = fmt::format("{:03}-{}-{}-plant-{}.h5", index + 1, point.agent, point.sequence, point.plant_seed);
  std::ranges::replace_if(
      name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '.'; }, '-');
  return (std::filesystem::path(folder) / name).string();
}

Study make_comparison_study(const ComparisonChoice& choice, const std::string& scenario_file,
                            const std::vector<std::pair<std::string, std::string>>& options,
                            const std::vector<SessionPoint>& points) {
  ListDesign design{"compare", "pack",           scenario_file, options, {"--agent", "--sequence", "--plant-seed"},
                    {},        session_outputs()};
  if (choice.random > 0) design.factors.emplace_back("--random-seed");
  if (choice.recordings) design.factors.emplace_back("--record");
  for (const SessionPoint& point : points) {
    std::vector<std::string>& values =
        design.points.emplace_back(std::vector{point.agent, point.sequence, std::to_string(point.plant_seed)});
    if (choice.random > 0) values.push_back(point.is_random ? std::to_string(choice.random_seed) : "false");
    if (choice.recordings) values.push_back(point.recording);
  }
  return make_list_study(design);
}

}  // namespace snug::study
