// cup: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/cup/cup.hpp"

namespace snug::app {
namespace {

constexpr const char* kEvaluateHelp =
    R"(Each line: {"R": 3x3, "o": [3], "K": 6x6, "S_R_S1": 3x3, "S_o_S1": [3]}; matrices as rows, SI units, linear part first.
The answer has the wrench on the package in S and in S1, and the stored energy V.
Example:
  snug cup evaluate scenarios/examples/deformations.jsonl)";

constexpr const char* kSettleHelp =
    R"(Each line: {"W_R_E": 3x3, "mass": kg, "com_S": [3], "K": 6x6, "E_H_S2": {"R", "o"}, "S_H_S1": {"R", "o"}}.
The answer has the pose of the lip, E_R_S and E_o_S, and whether the load stays there: stable.
Example:
  snug cup settle scenarios/examples/loads.jsonl)";

constexpr const char* kEstimateHelp =
    R"(Prints `cup` and `uncertainty` of a scenario, with the range of each number and where it comes from: an estimate to start
with. What holds and how the box tilts depends on it, filling hardly. Measure first what `snug identify` says is unknown.
Example:
  snug cup estimate --diameter 40 --bellows 1.5 --material silicone --lip foam --vacuum -60kPa --mass-max 5)";

void add_estimate(CLI::App& verb, Action& action) {
  CLI::App& part = *verb.add_subcommand("estimate", "a starting cup from a data sheet");
  const auto options = std::make_shared<CupEstimateOptions>();
  part.add_option("--diameter", options->diameter_mm, "of the lip")->required()->check(positive())->type_name("MM");
  part.add_option("--bellows", options->bellows, "folds: 0 (flat), 1.5 or 2.5")->capture_default_str();
  part.add_option("--material", options->material, "of the cup")
      ->check(one_of({"silicone", "nitrile", "polyurethane", "natural-rubber"}))
      ->capture_default_str();
  part.add_option("--lip", options->lip, "what seals")->check(one_of({"plain", "foam"}))->capture_default_str();
  part.add_option("--vacuum", options->vacuum, "gauge pressure of the hold, with its unit: kPa, mbar, bar or Pa")
      ->type_name("PRESSURE")
      ->capture_default_str();
  part.add_option("--stroke", options->stroke_mm, "free length less length under vacuum")
      ->check(finite())
      ->type_name("MM");
  part.add_option("--mass-max", options->mass_max, "of the heaviest box: is it held?")
      ->check(positive())
      ->type_name("KG");
  part.add_option("-o,--output", options->output, "also write the block here")->type_name("FILE.yaml");
  part.add_flag("--json", options->json, "print JSON");
  part.footer(kEstimateHelp);
  part.callback([options, &action] { action = [options] { return run_cup_estimate(*options); }; });
}

void add_catalogue(CLI::App& verb, Action& action) {
  CLI::App& part = *verb.add_subcommand("catalogue", "generic cups by size, at -60 kPa");
  const auto json = std::make_shared<bool>(false);
  part.add_flag("--json", *json, "print JSON");
  part.callback([json, &action] { action = [json] { return run_cup_catalogue(*json); }; });
}

void add_part(CLI::App& verb, const char* name, const char* about, const char* help, int (*run)(const CupOptions&),
              Action& action) {
  CLI::App& part = *verb.add_subcommand(name, about);
  const auto options = std::make_shared<CupOptions>();
  part.add_option("input", options->input, "file of JSON lines, - for stdin")->type_name("FILE")->capture_default_str();
  part.footer(help);
  part.callback([options, run, &action] {
    action = [options, run] {
      options->input = find_shipped(options->input);
      return run(*options);
    };
  });
}

}  // namespace

void add_cup(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("cup", "ask the model of the suction cup");
  verb.require_subcommand(1);
  add_part(verb, "evaluate", "the wrench that a deformation gives", kEvaluateHelp, run_cup_evaluate, action);
  add_part(verb, "settle", "where a held box hangs at rest", kSettleHelp, run_cup_settle, action);
  add_estimate(verb, action);
  add_catalogue(verb, action);
  verb.footer("`snug cup evaluate --help` and `snug cup settle --help` tell the keys of a line.");
}

}  // namespace snug::app
