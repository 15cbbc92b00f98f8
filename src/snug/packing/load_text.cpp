// Loads as text: a table for people, JSON for programs.
#include "snug/packing/load_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace snug::packing {
namespace {

using nlohmann::ordered_json;

int count_available(const LoadProblem& problem) {
  int available = 0;
  for (const CargoType& type : problem.types) available += type.count;
  return available;
}

double mean_percent(const std::vector<SolvedLoad>& loads) {
  double sum = 0.0;
  for (const SolvedLoad& load : loads) sum += load.result.percent;
  return sum / static_cast<double>(loads.size());
}

ordered_json describe_load(const LoadProblem& problem, const LoadResult& result) {
  ordered_json boxes = ordered_json::array();
  for (const LoadedBox& box : result.boxes) {
    boxes.push_back(
        {{"type", problem.types[static_cast<std::size_t>(box.type)].name}, {"low", box.low}, {"size", box.size}});
  }
  return {{"name", problem.name},
          {"container", problem.container},
          {"loaded", result.boxes.size()},
          {"available", count_available(problem)},
          {"percent", result.percent},
          {"work", result.work},
          {"beam_width", result.beam_width},
          {"boxes", boxes}};
}

}  // namespace

std::string format_load_table(const std::vector<SolvedLoad>& loads) {
  std::string table = fmt::format("{:<24} {:>7} {:>9} {:>8}\n", "problem", "loaded", "available", "fill %");
  for (const auto& [problem, result] : loads) {
    table += fmt::format("{:<24} {:>7} {:>9} {:>8.2f}\n", problem.name, result.boxes.size(), count_available(problem),
                         result.percent);
  }
  return table + fmt::format("{:<24} {:>7} {:>9} {:>8.2f}\n", "mean", "", "", mean_percent(loads));
}

std::string format_load_json(const std::vector<SolvedLoad>& loads, double time) {
  ordered_json all = ordered_json::array();
  for (const auto& [problem, result] : loads) all.push_back(describe_load(problem, result));
  return ordered_json{{"problems", all}, {"mean_percent", mean_percent(loads)}, {"time", time}}.dump(1) + "\n";
}

}  // namespace snug::packing
