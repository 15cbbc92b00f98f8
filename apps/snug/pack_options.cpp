// pack: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "options.hpp"
#include "pack.hpp"
#include "ranges.hpp"
#include "snug/packing/agent.hpp"

namespace snug::app {
namespace {

constexpr const char* kPackExamples = R"(Examples:
  snug pack scenarios/box-demonstrator.yaml --sequence 1
  snug pack scenarios/box-demonstrator.yaml --sequence 3 --agent margin --json
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --agent my_agents:LowestFirst
  snug pack scenarios/box-demonstrator.yaml --sequence 2 --executions 20 --threads 2
  snug pack scenarios/box-demonstrator.yaml --items scenarios/orders-example.csv --sequence kitchen
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --container 400x300x200 -o run.h5
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --pallet 600x400x300 --program out.csv
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --robot ur10 --samples 0
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --program out.csv --plan out.json -o out.h5
  snug simulate scenarios/box-demonstrator.yaml --program out.csv --sequence 1 --cup phases
Programs of such a run need the same --items, --container and --pallet in simulate, check and export; recordings hold them.)";

}  // namespace

void add_packing_options(CLI::App& verb, PackOptions& options) {
  add_scenario_changes(verb, options.changes);
  verb.add_option("--seed", options.seed, "seed of roll-outs and samples (default: the scenario's)")
      ->check(whole(0))
      ->type_name("N");
  verb.add_option("--decision-time", options.decision_time, "for deciding where an item goes, on one core")
      ->check(within(0.0, 3600.0))
      ->type_name("SECONDS")
      ->capture_default_str();
  verb.add_option("--threads", options.threads, "threads; the result does not depend on it (default: all cores)")
      ->check(whole(1, kMostThreads))
      ->type_name("N");
  verb.add_option("--samples", options.samples,
                  "courses of events with uncertain sizes, friction, poses, centres of mass and cup in which every "
                  "motion is tried before it is done, at most 64; 0: none")
      ->check(whole(0, 64))
      ->type_name("N")
      ->capture_default_str();
  verb.add_option("--future", options.future,
                  "what an item is expected to be followed by: boxes of the files that the sequence's come from (own), "
                  "or all boxes of the scenario and of --items")
      ->check(one_of({"own", "all"}))
      ->type_name("WHICH")
      ->capture_default_str();
}

void add_pack(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("pack", "decide, item by item, where boxes go, and simulate the robot doing it");
  const auto options = std::make_shared<PackOptions>();
  verb.add_option("scenario", options->scenario, "scenario file")->required()->type_name("SCENARIO.yaml");
  verb.add_option("--sequence", options->sequence, "item sequence of the scenario")->required()->type_name("NAME");
  verb.add_option("--agent", options->agent,
                  "who decides: a built-in agent, or a class written in Python (docs/python.md)")
      ->check(one_of(packing::agent_names(), "module:Class"))
      ->type_name("NAME|MODULE:CLASS")
      ->capture_default_str();
  add_packing_options(verb, *options);
  verb.add_option("--look", options->look,
                  "what is known of packed boxes: exact poses, noisy poses (2 mm), or none (dead-reckoning)")
      ->check(one_of({"exact", "noisy", "dead-reckoning"}))
      ->type_name("HOW")
      ->capture_default_str();
  verb.add_option("--robot", options->robot,
                  "move the tool with the joints of the scenario's robot, such as ur10, in all that is simulated: a "
                  "protective stop is a failed attempt; absent: the tool moves by itself")
      ->type_name("NAME");
  verb.add_option("--executions", options->executions,
                  "repeat the finished program N times, open loop, under sampled uncertainty: that of the samples, and "
                  "masses")
      ->check(whole(1, kMostRuns))
      ->type_name("N");
  verb.add_option("--program", options->program, "write the waypoint program")->type_name("FILE.csv");
  verb.add_option("--plan", options->plan, "write the placements as JSON")->type_name("FILE.json");
  verb.add_option("-o,--record", options->record, "write a recording of the program's run")->type_name("FILE.h5");
  verb.add_flag("--json", options->json, "print the result as JSON");
  verb.footer(kPackExamples);
  verb.callback([options, &action] { action = [options] { return run_pack(*options); }; });
}

}  // namespace snug::app
