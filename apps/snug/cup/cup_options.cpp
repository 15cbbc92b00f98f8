// cup: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

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
  verb.footer("`snug cup evaluate --help` and `snug cup settle --help` tell the keys of a line.");
}

}  // namespace snug::app
