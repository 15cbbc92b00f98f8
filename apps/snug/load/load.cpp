// load: fills a container from a list of boxes known in advance, by geometry alone.
#include "apps/snug/command_line/verbs.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "snug/core/input_error.hpp"
#include "snug/packing/instances.hpp"
#include "snug/packing/load_text.hpp"

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

std::vector<packing::LoadProblem> problems_of(const LoadOptions& options) {
  const std::string file = find_shipped(options.file);
  if (std::filesystem::path(file).extension() == ".txt") return packing::load_instances(file);
  if (options.container_mm.empty()) {
    throw InputError("command line", "--container", "nothing", "length, width and height in mm, for orders");
  }
  auto lines = model::load_orders(file);
  if (const int limited = packing::drop_load_limits(lines); limited > 0) {
    std::fprintf(
        stderr,
        "snug: warning: %d boxes must not carry others, or not much: that is not checked here (snug pack does)\n",
        limited);
  }
  return packing::problems_of(
      lines, 1e-3 * Vector3(options.container_mm[0], options.container_mm[1], options.container_mm[2]));
}

int run_load(const LoadOptions& options) {
  std::optional<OutputFile> output = reserve({{"the input", find_shipped(options.file)}}, options.output);
  std::vector<packing::LoadProblem> problems = problems_of(options);
  if (options.first) problems.resize(std::min(problems.size(), static_cast<std::size_t>(*options.first)));
  std::vector<packing::SolvedLoad> loads;
  for (const packing::LoadProblem& problem : problems)
    loads.push_back({problem, packing::load_container(problem, {options.time, options.threads})});
  print_or_write(options.json ? packing::format_load_json(loads, options.time) : packing::format_load_table(loads),
                 std::move(output));
  return kSuccess;
}

constexpr const char* kLoadHelp =
    R"(Boxes may stand on each other in any way that does not overlap: load ignores support, weight and order of loading.
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
              "inner length, width and height of the container, as 600x400x300 or 600 400 300", within(1.0, 1e5))
      .delimiter('x')
      .expected(3)
      .one_each();
  verb.option("--time", options.time, "S", "search time for each problem, on one core of 2.5 GHz",
              within(0.0, 86400.0));
  verb.option("--first", options.first, "N", "only the first N problems", whole(1, kMostThings));
  verb.option("--threads", options.threads, "N", "threads; they do not change the load", whole(1, kMostThreads));
  add_json(verb, options.json);
  verb.option("-o,--output", options.output, "FILE", "file to write instead of stdout");
}

}  // namespace snug::app
