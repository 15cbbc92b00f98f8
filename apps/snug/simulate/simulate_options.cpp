// simulate: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/simulate/simulate.hpp"

namespace snug::app {
namespace {

constexpr const char* kSimulateExamples = R"(Examples:
  snug simulate scenarios/box-demonstrator.yaml --program program.csv --sequence 1 -o run.h5
  snug simulate scenarios/box-demonstrator.yaml --program program.csv --sequence 1 --corrections seq1 --json
  snug simulate scenarios/box-demonstrator.yaml --program program.csv --sequence 1 --monte-carlo 20 --seed 7
  snug simulate scenarios/box-demonstrator.yaml --program program.csv --sequence 1 --seed 7 --draw 13 -o worst.h5
  snug simulate scenarios/box-demonstrator.yaml --program program.csv --sequence 1 --robot ur10 --csv joints.csv
  snug pack scenarios/box-demonstrator.yaml --container 400x300x200 --sequence 1 --samples 0 --program small.csv
  snug simulate scenarios/box-demonstrator.yaml --container 400x300x200 --program small.csv --sequence 1
  snug simulate scenarios/slide.yaml --until 5 --csv slide.csv)";

}  // namespace

void add_program_options(CLI::App& verb, SimulateOptions& options) {
  add_scenario_changes(verb, options.changes);
  verb.add_option("--program", options.program, "waypoint file (13 columns) to run; needs --sequence")
      ->type_name("FILE.csv");
  verb.add_option("--sequence", options.sequence, "item sequence of the scenario that the program packs")
      ->type_name("NAME");
  add_motion_words(verb, options.motion);
  verb.add_option(
          "--robot", options.robot,
          "move the tool with the joints of the scenario's robot, such as ur10; absent: the tool moves by itself")
      ->type_name("NAME");
  verb.add_option("--corrections", options.corrections,
                  "site corrections: a layer of the scenario such as seq1 or seq2-5, or none")
      ->type_name("LAYER")
      ->capture_default_str();
}

void add_physics_options(CLI::App& verb, SimulateOptions& options) {
  verb.add_option("--until", options.until, "stop at this simulated time; default: the program's end")
      ->check(within(1e-6, 1e6))
      ->type_name("SECONDS");
  verb.add_option("--dt", options.dt, "time step, instead of the scenario's")
      ->check(within(1e-6, 0.1))
      ->type_name("SECONDS");
  verb.add_option(
          "--cup", options.cup,
          "phases: pressure builds up and decays, holds can fail; holding: attached and released at once (default: "
          "phases, with --corrections the cup that they were made for)")
      ->check(one_of({"holding", "phases"}))
      ->type_name("MODEL");
  verb.add_option("--seed", options.seed, "seed of everything random, instead of the scenario's")
      ->check(whole(0))
      ->type_name("N");
  verb.add_option("--threads", options.threads,
                  "threads of repeated runs or of a scene of many bodies; the result does not depend on it (default: "
                  "all cores)")
      ->check(whole(1, kMostThreads))
      ->type_name("N");
}

void add_simulate(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("simulate", "run a scenario and say what became of every box");
  const auto options = std::make_shared<SimulateOptions>();
  verb.add_option("scenario", options->scenario,
                  "scenario file, or name of one that comes with snug (drop, box-demonstrator)")
      ->required()
      ->type_name("SCENARIO.yaml");
  add_program_options(verb, *options);
  add_physics_options(verb, *options);
  CLI::Option* repeated = verb.add_option("--monte-carlo", options->monte_carlo,
                                          "run the program N times in cells drawn from the scenario's `uncertainty`")
                              ->check(whole(1, kMostRuns))
                              ->type_name("N");
  verb.add_option("--draw", options->draw, "the N-th of these runs by itself, such as the worst, to record it")
      ->check(whole(1, kMostRuns))
      ->type_name("N")
      ->excludes(repeated);
  verb.add_option("-o,--record", options->record, "write a recording")->type_name("FILE.h5");
  verb.add_option("--record-period", options->record_period,
                  "time between frames, instead of the scenario's or 0.008; whole steps, with a program whole ticks")
      ->check(positive())
      ->type_name("SECONDS");
  verb.add_option("--resume", options->resume,
                  "go on from a recording of the same bodies, from its last frame or --resume-at; not with --program")
      ->type_name("FILE.h5");
  verb.add_option("--resume-at", options->resume_at, "instant of the recording to go on from")
      ->check(positive())
      ->type_name("SECONDS");
  verb.add_option("--csv", options->csv, "write one table, a row per recorded instant")->type_name("FILE.csv");
  verb.add_flag("--json", options->json, "print the result as JSON");
  verb.footer(kSimulateExamples);
  verb.callback([options, &action] { action = [options] { return run_simulate(*options); }; });
}

}  // namespace snug::app
