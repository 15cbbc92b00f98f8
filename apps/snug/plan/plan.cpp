// plan: one decision of a session once more, from the belief that it was made on.
#include "apps/snug/command_line/verbs.hpp"

#include <optional>
#include <string>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/packing/python_agent.hpp"
#include "snug/planning/plan_report.hpp"

namespace snug::app {
namespace {

struct PlanOptions {
  std::string belief;
  std::optional<std::string> item;  ///< absent: the one that was decided on
  std::optional<double> decision_time;
  std::optional<int> threads;  ///< absent: all cores
  bool json = false;
};

/// Items that are in the cell can be planned.
model::ItemIndex find_item(const planning::BeliefSnapshot& belief, const std::string& id) {
  std::vector<std::string> there;
  for (std::size_t i = 0; i < belief.items.size(); ++i) {
    if (!belief.boxes[i]) continue;
    if (belief.items[i].id == id) return model::ItemIndex(i);
    there.push_back(belief.items[i].id);
  }
  std::string expected = "an item that is in the cell:";
  for (const std::string& one : there) expected += " " + one;
  throw InputError("command line", "--item", "'" + id + "'", expected);
}

int run_plan(const PlanOptions& options) {
  planning::PlanRequest request = planning::load_request(options.belief);
  request.item = find_item(request.belief, options.item.value_or(request.belief.items[request.item.slot()].id));
  request.budget.threads = options.threads.value_or(core_count());
  request.budget.decision_time = options.decision_time.value_or(request.budget.decision_time);
  const std::string& agent = request.belief.agent.name;
  const bool is_python = request.belief.agent.is_asked && packing::is_python_agent(agent);
  planning::PlanningWorkspace work(is_python ? packing::start_python_agent(agent, agent_script()) : packing::Ask{});
  const planning::Plan plan = planning::plan(request.belief, request.item, request.budget, work);
  print(options.json ? planning::format_plan_json(request, plan) : planning::format_plan_table(request, plan));
  return kSuccess;
}

constexpr const char* kPlanExamples = R"(Examples:
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --plant-seed 7 --save-belief beliefs
  snug plan beliefs/0001-BOX027.json
  snug plan beliefs/0001-BOX027.json --json
  snug plan beliefs/0001-BOX027.json --decision-time 2
The same belief, item and decision time give the same plan, to the last digit.)";

}  // namespace

void add_plan(CLI::App& app, Action& action) {
  const Verb verb(app, action, "plan", "repeat one decision of a session and show what was tried and why it lost",
                  kPlanExamples);
  PlanOptions& options = verb.runs(run_plan);
  verb.option("belief", options.belief, "BELIEF.json", "belief at the decision: a file of `snug pack --save-belief`")
      .required();
  verb.option("--item", options.item, "ID", "another item in the cell (default: that of the decision)");
  verb.option("--decision-time", options.decision_time, "SECONDS",
              "time to decide where the item goes, on one core (default: that of the decision)", within(0.0, 3600.0));
  add_threads(verb, options.threads);
  add_json(verb, options.json);
}

}  // namespace snug::app
