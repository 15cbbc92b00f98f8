// make_list_study: a study that a program lists, and the file that says the same.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "snug/core/check.hpp"
#include "snug/study/design.hpp"

namespace snug::study {
namespace {

using Json = nlohmann::ordered_json;

/// As the reader of studies names a factor: its option without dashes.
std::string plain(const std::string& option) { return option.substr(option.find_first_not_of('-')); }

Json options_as_json(const ListDesign& design) {
  Json options = Json::object();
  for (const auto& [option, value] : design.options) options[option].push_back(value);
  return options;
}

/// JSON, which is YAML too; a line for each key and each point.
std::string text_of(const ListDesign& design) {
  Json factors = Json::array(), outputs = Json::array();
  for (const std::string& option : design.factors) factors.push_back({{"option", option}});
  for (const Output& output : design.outputs) outputs.push_back(output.name);
  const std::pair<const char*, Json> keys[] = {
      {"name", design.name}, {"verb", design.verb}, {"scenario", design.scenario}, {"options", options_as_json(design)},
      {"design", "list"},    {"factors", factors},  {"outputs", outputs}};
  std::string text = "{\n";
  for (const auto& [key, value] : keys) text += Json(key).dump() + ": " + value.dump() + ",\n";
  text += "\"points\": [";
  for (std::size_t i = 0; i < design.points.size(); ++i) {
    Json point = Json::object();
    for (std::size_t k = 0; k < design.factors.size(); ++k) point[plain(design.factors[k])] = design.points[i][k];
    text += (i == 0 ? "\n" : ",\n") + point.dump();
  }
  return text + "\n]}\n";
}

}  // namespace

Study make_list_study(const ListDesign& design) {
  SNUG_CHECK(!design.points.empty(), "a study has points");
  Study study;
  study.name = study.source = design.name;
  study.text = text_of(design);
  study.verb = design.verb;
  study.scenario = design.scenario;
  for (const auto& [option, value] : design.options) {
    study.options.insert(study.options.end(), {option, value});
    if (option == study.seed_option) study.seed_option.clear();
  }
  study.design = Design::List;
  for (const std::string& option : design.factors) {
    study.factors.push_back({.name = plain(option), .option = option, .key = {}, .values = {}});
  }
  study.points = design.points;
  study.point_count = design.points.size();
  study.outputs = design.outputs;
  study.chunk = default_chunk(study.rows());
  return study;
}

int default_chunk(std::uint64_t rows) {
  return static_cast<int>(
      std::clamp<std::uint64_t>((rows + 63) / 64, 1, std::max<std::uint64_t>(100, (rows + 999) / 1000)));
}

}  // namespace snug::study
