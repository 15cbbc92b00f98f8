// plan: one decision of a session once more, from the belief that it was made on.
#include "apps/snug/plan/plan.hpp"

#include <algorithm>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/packing/python_agent.hpp"
#include "snug/planning/plan_report.hpp"

namespace snug::app {
namespace {

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

}  // namespace

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

}  // namespace snug::app
