// plan: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/plan/plan.hpp"

namespace snug::app {
namespace {

constexpr const char* kPlanExamples = R"(Examples:
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --plant-seed 7 --save-belief beliefs
  snug plan beliefs/0001-BOX027.json
  snug plan beliefs/0001-BOX027.json --json
  snug plan beliefs/0001-BOX027.json --decision-time 2
The same belief, item and decision time come to the same plan, to the last digit.)";

}  // namespace

void add_plan(CLI::App& app, Action& action) {
  CLI::App& verb =
      *app.add_subcommand("plan", "repeat one decision of a session and say what was tried and why it lost");
  const auto options = std::make_shared<PlanOptions>();
  verb.add_option("belief", options->belief, "what was believed then: a file of `snug pack --save-belief`")
      ->required()
      ->type_name("BELIEF.json");
  verb.add_option("--item", options->item, "another item that is in the cell (default: the one that was decided on)")
      ->type_name("ID");
  verb.add_option("--decision-time", options->decision_time,
                  "for deciding where the item goes, on one core (default: as then)")
      ->check(within(0.0, 3600.0))
      ->type_name("SECONDS");
  verb.add_option("--threads", options->threads, "threads; the result does not depend on it (default: all cores)")
      ->check(whole(1, kMostThreads))
      ->type_name("N");
  verb.add_flag("--json", options->json, "print the decision as JSON");
  verb.footer(kPlanExamples);
  verb.callback([options, &action] { action = [options] { return run_plan(*options); }; });
}

}  // namespace snug::app
