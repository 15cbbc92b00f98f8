// load: reads problems, loads each container, prints how full it is.
#include "apps/snug/load/load.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "apps/snug/command_line/outputs.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/packing/instances.hpp"

namespace snug::app {
namespace {

using nlohmann::ordered_json;

std::vector<packing::LoadProblem> problems_of(const LoadOptions& options) {
  if (std::filesystem::path(options.file).extension() == ".txt") return packing::load_instances(options.file);
  if (options.container_mm.empty()) {
    throw InputError("command line", "--container", "nothing", "length, width and height in mm, for orders");
  }
  auto lines = model::load_orders(options.file);
  int limited = 0;
  for (model::OrderLine& line : lines) {
    if (!line.handling.no_stack && !line.handling.max_load) continue;
    limited += line.count;
    line.handling.no_stack = false;
    line.handling.max_load.reset();
  }
  if (limited > 0) {
    std::fprintf(
        stderr,
        "snug: warning: %d boxes must not carry others, or not much: that is not looked at here (snug pack does)\n",
        limited);
  }
  return packing::problems_of(
      lines, 1e-3 * Vector3(options.container_mm[0], options.container_mm[1], options.container_mm[2]));
}

ordered_json as_json(const packing::LoadProblem& problem, const packing::LoadResult& result, int available) {
  ordered_json boxes = ordered_json::array();
  for (const packing::LoadedBox& box : result.boxes) {
    boxes.push_back(
        {{"type", problem.types[static_cast<std::size_t>(box.type)].name}, {"low", box.low}, {"size", box.size}});
  }
  return {{"name", problem.name},
          {"container", problem.container},
          {"loaded", result.boxes.size()},
          {"available", available},
          {"percent", result.percent},
          {"work", result.work},
          {"beam_width", result.beam_width},
          {"boxes", boxes}};
}

}  // namespace

int run_load(const LoadOptions& options) {
  std::optional<OutputFile> output = reserve({{"the input", options.file}}, options.output);
  std::vector<packing::LoadProblem> problems = problems_of(options);
  if (options.first > 0) problems.resize(std::min(problems.size(), static_cast<std::size_t>(options.first)));
  ordered_json all = ordered_json::array();
  std::string table = fmt::format("{:<24} {:>7} {:>9} {:>8}\n", "problem", "loaded", "available", "fill %");
  double sum = 0.0;
  for (const packing::LoadProblem& problem : problems) {
    const packing::LoadResult result = packing::load_container(problem, {options.time, options.threads});
    int available = 0;
    for (const packing::CargoType& type : problem.types) available += type.count;
    sum += result.percent;
    all.push_back(as_json(problem, result, available));
    table += fmt::format("{:<24} {:>7} {:>9} {:>8.2f}\n", problem.name, result.boxes.size(), available, result.percent);
  }
  const double mean = sum / static_cast<double>(problems.size());
  table += fmt::format("{:<24} {:>7} {:>9} {:>8.2f}\n", "mean", "", "", mean);
  const std::string text =
      options.json ? ordered_json{{"problems", all}, {"mean_percent", mean}, {"time", options.time}}.dump(1) + "\n"
                   : table;
  if (output) {
    write_file(std::move(*output), text);
  } else {
    print(text);
  }
  return kSuccess;
}

}  // namespace snug::app
