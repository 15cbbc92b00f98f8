// shake: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/shake/shake.hpp"

namespace snug::app {
namespace {

constexpr const char* kShakeExamples = R"(Profiles:
  conveyor    a belt at 0.5 m/s: starts and stops with 2 m/s2, an emergency stop with 5, along each axis
  truck       0.8 g forward (the longer side), 0.5 g to the rear and to either side, a second each (EN 12195-1)
  eumos40509  --level g to all four sides, for 0.3 s with ramps of 50 ms; usual levels are 0.3, 0.5 and 0.8
  tilt        slowly by the angle whose tangent is --level, to all four sides
  FILE.csv    a head of time_s and any of ax, ay, az (m/s2, of the container along its axes), roll_deg, pitch_deg; then rows
Every motion begins with the load at rest, once with the scenario's friction and once with each draw of its uncertainty;
the worst counts. Holds: film draws each box back to where it stood by 2 N a millimetre, by 150 N at most; straps press the
boxes that carry no other down by 600 N together. The container itself stands fast on what carries it.
Exit code 0: the load holds; 1: a box shifts, tips or falls; 2: the input cannot be used.
Examples:
  snug shake scenarios/demo-placements.yaml --scenario scenarios/box-demonstrator.yaml --profile conveyor
  snug shake scenarios/demo-placements.yaml --scenario scenarios/box-demonstrator.yaml --profile eumos40509 --level 0.3 --page shake.html
  snug shake run.h5 --profile truck --json)";

}  // namespace

void add_shake(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("shake", "drive a packed container: say which boxes shift, tip or fall");
  const auto options = std::make_shared<ShakeOptions>();
  verb.add_option("load", options->load, "recording of a packed container (its last frame), or a list of placements")
      ->required()
      ->type_name("RUN.h5|LOAD");
  verb.add_option("--scenario", options->scenario, "scenario of the placements; a recording has its own")
      ->type_name("SCENARIO.yaml");
  add_scenario_changes(verb, options->changes);
  verb.add_option("--profile", options->profile, "how it is driven, see below")->required()->type_name("NAME|FILE.csv");
  verb.add_option("--level", options->level, "of eumos40509 and tilt, in g")
      ->check(within(0.01, 2.0))
      ->type_name("G")
      ->capture_default_str();
  verb.add_option("--hold", options->hold, "what holds the load beside walls and friction")
      ->check(one_of({"none", "film", "straps"}))
      ->type_name("WHAT")
      ->capture_default_str();
  verb.add_option("--draws", options->draws, "of friction, from the scenario's uncertainty, beside its own")
      ->check(whole(0, 1000))
      ->type_name("N")
      ->capture_default_str();
  verb.add_option("--seed", options->seed, "of the draws")->check(whole(0))->type_name("N")->capture_default_str();
  verb.add_option("--max-shift", options->shift, "that a box may move, at any time")
      ->check(within(0.1, 10000.0))
      ->type_name("MM")
      ->capture_default_str();
  verb.add_option("--max-tilt", options->tilt, "that a box may tip, at any time")
      ->check(within(0.1, 180.0))
      ->type_name("DEGREES")
      ->capture_default_str();
  verb.add_option("--time-step", options->time_step, "of the simulation (default: that of the scenario's rehearsals)")
      ->check(within(1e-5, 0.02))
      ->type_name("SECONDS");
  verb.add_option("--threads", options->threads, "threads; the result does not depend on it (default: all cores)")
      ->check(whole(1, kMostThreads))
      ->type_name("N");
  verb.add_option("--page", options->page, "write a page with the worst moment")->type_name("FILE.html");
  verb.add_flag("--json", options->json, "print the result as JSON");
  verb.footer(kShakeExamples);
  verb.callback([options, &action] { action = [options] { return run_shake(*options); }; });
}

}  // namespace snug::app
