// load: fills a container from a list of boxes known in advance, by geometry alone.
#include "apps/snug/command_line/verbs.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/command_line/verb.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/packing/instances.hpp"

namespace snug::app {
namespace {

struct LoadOptions {
  std::string file;
  std::vector<double> container_mm;  ///< length, width, height; for orders
  double time = 30.0;                ///< s for each problem
  std::optional<int> first;          ///< only so many problems
  int threads = 1;
  bool json = false;
  std::optional<std::string> output;
};

using nlohmann::ordered_json;

std::vector<packing::LoadProblem> problems_of(const LoadOptions& options) {
  const std::string file = find_shipped(options.file);
  if (std::filesystem::path(file).extension() == ".txt") return packing::load_instances(file);
  if (options.container_mm.empty()) {
    throw InputError("command line", "--container", "nothing", "length, width and height in mm, for orders");
  }
  auto lines = model::load_orders(file);
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
        "snug: warning: %d boxes must not carry others, or not much: that is not checked here (snug pack does)\n",
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

int run_load(const LoadOptions& options) {
  std::optional<OutputFile> output = reserve({{"the input", find_shipped(options.file)}}, options.output);
  std::vector<packing::LoadProblem> problems = problems_of(options);
  if (options.first) problems.resize(std::min(problems.size(), static_cast<std::size_t>(*options.first)));
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

constexpr const char* kLoadHelp =
    R"(Boxes may stand on each other in any way that does not overlap: no support, weight or order of loading is asked for.
FILE is one of
  .txt   instances of Bischoff and Ratcliff in the OR-Library's form (thpack): containers and boxes
  .csv   orders with a header, .json orders in the BED-BPP form: one problem for each order, with --container
The time is turned into a fixed amount of work: the same input gives the same load, on any machine and any number of threads.
Examples:
  snug load scenarios/examples/containers.txt --time 2
  snug load scenarios/orders-example.csv --container 600x400x300 --time 2
  snug load scenarios/examples/orders.json --container 1200x800x1450 --json -o loads.json)";

}  // namespace

void add_load(CLI::App& app, Action& action) {
  const Verb verb(app, action, "load", "fill a container from a list of boxes, by geometry alone", kLoadHelp);
  LoadOptions& options = verb.runs(run_load);
  verb.option("file", options.file, "FILE", "instances or orders").required();
  verb.option("--container", options.container_mm, "MM",
              "inner length, width and height of the container of orders, as 600x400x300 or 600 400 300",
              within(1.0, 1e5))
      .delimiter('x')
      .expected(3)
      .one_each();
  verb.option("--time", options.time, "S", "seconds on one core of 2.5 GHz for each problem", within(0.0, 86400.0));
  verb.option("--first", options.first, "N", "only the first N problems", whole(1, kMostThings));
  verb.option("--threads", options.threads, "N", "threads; the load does not depend on it", whole(1, kMostThreads));
  add_json(verb, options.json);
  verb.option("-o,--output", options.output, "FILE", "file to write instead of stdout");
}

}  // namespace snug::app
