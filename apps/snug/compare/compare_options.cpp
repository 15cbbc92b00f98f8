// compare: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/compare/compare.hpp"

namespace snug::app {
namespace {

constexpr const char* kCompareExamples = R"(Examples:
  snug compare scenarios/box-demonstrator.yaml --agents contact-aware --plants 6 -o compare.html --runs runs
  snug compare scenarios/box-demonstrator.yaml --sequences 1,3 --agents margin,contact-aware --json
  snug compare scenarios/box-demonstrator.yaml --decision-time 0.2 --plants 3 --csv > rows.csv
  snug compare scenarios/box-demonstrator.yaml --random 50 --agents contact-aware --dir random
  snug compare scenarios/box-demonstrator.yaml --container 400x300x200 --agents contact-aware)";

}  // namespace

void add_compare(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("compare", "agents x sequences x plants: filling, items lost, recoveries");
  const auto options = std::make_shared<CompareOptions>();
  verb.add_option("scenario", options->pack.scenario,
                  "scenario file, or name of one that comes with snug (drop, box-demonstrator)")
      ->required()
      ->type_name("SCENARIO.yaml");
  verb.add_option("--sequences", options->sequences,
                  "all, or names separated by commas (default: all; with --random none but the random ones)")
      ->type_name("NAMES");
  CLI::Option* random = verb.add_option("--random", options->random,
                                        "so many more sequences, random-1, ...: every box of the scenario in random "
                                        "order; each is packed in plants of its own")
                            ->check(whole(1, 10000))
                            ->type_name("N");
  verb.add_option("--random-seed", options->random_seed, "seed of their order")
      ->check(whole(0))
      ->needs(random)
      ->type_name("N")
      ->capture_default_str();
  verb.add_option("--agents", options->agents,
                  "all built-in ones, or names separated by commas, module:Class of Python among them")
      ->type_name("NAMES")
      ->capture_default_str();
  verb.add_option("--plants", options->plants,
                  "plants that every agent packs with every sequence: the seed --plant-seed and those after it")
      ->check(whole(1, kMostRuns))
      ->type_name("N")
      ->capture_default_str();
  add_packing_options(verb, options->pack);
  CLI::Option* json = verb.add_flag("--json", options->json, "print rows as JSON");
  verb.add_flag("--csv", options->csv, "print rows as CSV")->excludes(json);
  verb.add_option(
          "-o,--output", options->page,
          "page: charts by agent, sequence and plant, each container from above, the words that repeat each run")
      ->type_name("FILE.html");
  verb.add_option("--runs", options->runs,
                  "leave a recording and its report page of every session in this folder; the page of -o links to them")
      ->type_name("DIR");
  verb.add_option("--dir", options->dir,
                  "keep every row in this folder: the same words go on after a kill; DIR/study.yaml is the comparison "
                  "as a study (snug study status|merge|report)")
      ->type_name("DIR");
  verb.footer(kCompareExamples);
  verb.callback([options, &action] { action = [options] { return run_compare(*options); }; });
}

}  // namespace snug::app
