// Session: packs a plant, item after item: perceive, decide, rehearse, send, perceive, recover.
#include "snug/session/session.hpp"

#include <algorithm>
#include <utility>

#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/session/fold.hpp"
#include "snug/session/internal/decide_before.hpp"
#include "snug/session/internal/run.hpp"

namespace snug::session {
namespace {

using internal::OperatorDesk;
using internal::Run;

planning::AgentSettings agent_of(const model::Scenario& scenario, const model::Sequence& order,
                                 const SessionOptions& options) {
  planning::AgentSettings agent;
  agent.name = options.agent;
  agent.is_asked = static_cast<bool>(options.ask);
  agent.seed = options.decision.seed;
  agent.tries_places = !internal::decides_before(options);  // what is planned before has no other place to try
  agent.future = options.future ? *options.future : packing::make_order_future(scenario, order);
  return agent;
}

void expect_same(const event::SessionStarted& before, const event::SessionStarted& now) {
  const auto expect = [](const char* key, const std::string& was, const std::string& is) {
    if (was != is) throw InputError("--resume", key, "'" + is + "'", "'" + was + "', as the log says");
  };
  expect("sequence", before.sequence, now.sequence);
  expect("agent", before.agent, now.agent);
  expect("plant", before.plant, now.plant);
  if (before.items != now.items) throw InputError("--resume", "items", "others", "the items of the log");
}

/// The cell and the agenda as they were when the last item was done with; the log has everything up to then.
void go_on(Run& run, const ResumePoint& point) {
  perception::Observation seen;
  for (const event::Standing& box : point.boxes) {
    perception::PoseEstimate& one = seen.seen.emplace_back();
    one.item = run.belief.now().items[box.item.slot()].id;
    one.X_WP = box.X_WP;
    one.size = box.size - Vector3::Constant(run.belief.now().scenario.parcel_clearance);
  }
  run.belief.see(seen);
  int under_way = 0;
  for (const SessionEvent& one : point.events) {
    if (std::holds_alternative<event::ItemStarted>(one)) ++under_way;
    if (const auto* sent = std::get_if<event::Sent>(&one)) {
      auto& all = run.belief.edit().sent;
      if (std::ranges::find(all, sent->item) == all.end()) all.push_back(sent->item);
    }
    if (const auto* operated = std::get_if<event::Operated>(&one)) run.desk.mark_used(operated->line);
    const auto* ended = std::get_if<event::ItemEnded>(&one);
    if (ended != nullptr && --under_way == 0) {
      internal::account_for(run, ended->item, ended->end);
      std::erase(run.agenda.order, ended->item);
    }
    if (const auto* lost = std::get_if<event::ItemLost>(&one)) std::erase(run.agenda.packed, lost->item);
    run.log(one);
  }
}

/// Who decides in which order: at once, or item by item as they come. `order` is the sequence, all boxes of it.
void prepare(Run& run, const model::Sequence& order, const std::string& plant) {
  planning::BeliefSnapshot& belief = run.belief.edit();
  belief.agent = agent_of(belief.scenario, order, run.options);
  belief.skips_left = run.options.skips.value_or(belief.scenario.recovery.skips);
  event::SessionStarted started{belief.sequence, belief.agent.name, plant, {}, false, belief.simulation.tracking};
  for (const packing::Item& item : belief.items) started.items.emplace_back(item.id);
  started.places_are_chosen = internal::decides_before(run.options);
  if (started.places_are_chosen) {
    run.log(started);
    internal::decide_before(run);
  } else {
    for (std::size_t i = 0; i < belief.items.size(); ++i) run.agenda.order.emplace_back(i);
    if (run.options.resume) {
      expect_same(run.options.resume->started(), started);
      go_on(run, *run.options.resume);
    } else {
      run.log(started);
    }
  }
  run.decisions.prepare(belief);
}

/// The state table, from its first state to its last.
void execute(Run& run) {
  for (State state = State::NextItem; state != State::Done;) {
    const model::ItemIndex item = run.agenda.under_way.empty() ? model::ItemIndex() : run.agenda.top().item;
    const Signal signal = internal::act(state, run);
    const std::optional<State> next = next_state(state, signal);
    SNUG_CHECK(next.has_value(), "the state table has this transition");
    run.log(event::Stepped{run.executor.time(), item, state, signal, *next});
    state = *next;
  }
}

}  // namespace

SessionResult pack(const model::Scenario& scenario, const std::string& sequence, const SessionOptions& options,
                   plant::Plant& plant, const Progress& progress) {
  planning::CellPlan cell = planning::make_cell_plan(scenario, options.simulation.tracking);
  const model::Sequence& order = cell::require_sequence(scenario, sequence);
  ResultFold result;
  int begun = 0, told = 0, total = 0;  // items
  const EventSink log = [&](const SessionEvent& one) {
    result.add(one);
    if (options.log) options.log(one);
    if (const auto* session = std::get_if<event::SessionStarted>(&one)) total = static_cast<int>(session->items.size());
    const auto* started = std::get_if<event::ItemStarted>(&one);
    if (started != nullptr && !started->because_of) ++begun;
    if (!std::holds_alternative<event::Counted>(one) || told == begun) return;
    told = begun;
    if (progress) progress(result.result(), told, total);
  };
  Run run{options,
          log,
          std::move(cell),
          Belief(scenario, sequence, {options.samples, options.decision.seed, options.simulation}),
          Executor(plant, scenario, log),
          {},
          Decisions({options.decision.time, options.threads}, options.ask, options.save_beliefs),
          OperatorDesk(options.operator_orders),
          std::nullopt};
  prepare(run, order, plant.describe().name);
  if (!run.options.resume) total = static_cast<int>(run.agenda.order.size());
  if (run.options.resume && run.options.takes_over) internal::take_over(run);
  execute(run);
  return result.result();
}

}  // namespace snug::session
