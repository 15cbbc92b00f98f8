// load: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/load/load.hpp"

namespace snug::app {
namespace {

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
  CLI::App& verb = *app.add_subcommand("load", "fill a container from a list of boxes, by geometry alone");
  const auto options = std::make_shared<LoadOptions>();
  verb.add_option("file", options->file, "instances or orders")->required()->type_name("FILE");
  verb.add_option("--container", options->container_mm,
                  "inner length, width and height of the container of orders, as 600x400x300 or 600 400 300")
      ->delimiter('x')
      ->expected(3)
      ->allow_extra_args(false)
      ->check(within(1.0, 1e5))
      ->type_name("MM");
  verb.add_option("--time", options->time, "seconds on one core of 2.5 GHz for each problem")
      ->capture_default_str()
      ->check(within(0.0, 86400.0))
      ->type_name("S");
  verb.add_option("--first", options->first, "only the first N problems")->check(whole(1, kMostThings))->type_name("N");
  verb.add_option("--threads", options->threads, "threads; the load does not depend on it")
      ->capture_default_str()
      ->check(whole(1, kMostThreads))
      ->type_name("N");
  verb.add_flag("--json", options->json, "print JSON: every box, where it lies");
  verb.add_option("-o,--output", options->output, "file to write instead of stdout")->type_name("FILE");
  verb.footer(kLoadHelp);
  verb.callback([options, &action] {
    action = [options] {
      options->file = find_shipped(options->file);
      return run_load(*options);
    };
  });
}

}  // namespace snug::app
