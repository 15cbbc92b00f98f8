// make_agent: agents by name.
#include "snug/packing/agent.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/packing/internal/agents.hpp"
#include "snug/packing/remote_agent.hpp"

namespace snug::packing {

namespace {

void check(const PackingSettings& s, const DecisionRun& run) {
  const auto within = [](double value, double low, double high) { return value >= low && value <= high; };
  require_number(within(run.time, 0.0, 3600.0), "packing settings", "decision_time", run.time, "0 .. 3600 s");
  require_number(within(run.threads, 1, 256), "packing settings", "threads", run.threads, "1 .. 256");
  require_number(within(s.max_candidates, 1, 1000), "packing settings", "max_candidates", s.max_candidates,
                 "1 .. 1000");
  require_number(within(s.max_flips, 0, 2), "packing settings", "max_flips", s.max_flips, "0, 1 or 2");
  require_number(within(s.margin, 0.0, 1.0), "packing settings", "margin", s.margin, "0 .. 1 m");
  require_number(within(s.planned_interference, 0.0, 0.010), "packing settings", "planned_interference",
                 s.planned_interference, "0 .. 0.01 m");
  require_number(within(s.last_interference, 0.0, 0.010), "packing settings", "last_interference", s.last_interference,
                 "0 .. 0.01 m");
  require_number(within(s.min_support, 0.0, 1.0), "packing settings", "min_support", s.min_support, "0 .. 1");
  require_number(within(s.com_margin, 0.0, 0.1), "packing settings", "com_margin", s.com_margin, "0 .. 0.1 m");
  require_number(within(s.level_slack, 0.0, 0.05), "packing settings", "level_slack", s.level_slack, "0 .. 0.05 m");
  require_number(within(s.min_slenderness, 0.0, 10.0), "packing settings", "min_slenderness", s.min_slenderness,
                 "0 .. 10");
  require_number(within(s.max_item_mass, 0.0, 1.0e6), "packing settings", "max_item_mass", s.max_item_mass,
                 "0 .. 1e6 kg");
  require_number(within(s.min_pick_face, 0.0, 10.0), "packing settings", "min_pick_face", s.min_pick_face, "0 .. 10 m");
}

/// All agents; a new one is a line here.
struct Entry {
  AgentKind kind;
  const char* name;
  bool plans_whole_sequence;
  std::unique_ptr<Agent> (*make)(AgentInput input);
};
constexpr std::array kAgents{
    Entry{AgentKind::Margin, "margin", false, internal::make_margin_agent},
    Entry{AgentKind::ContactAware, "contact-aware", false, internal::make_contact_aware_agent},
    Entry{AgentKind::Manual, "manual", true, internal::make_manual_agent},
    Entry{AgentKind::Offline, "offline", true, internal::make_offline_agent},
};

}  // namespace

const char* name_of(AgentKind kind) { return std::ranges::find(kAgents, kind, &Entry::kind)->name; }

bool plans_whole_sequence(AgentKind kind) {
  return std::ranges::find(kAgents, kind, &Entry::kind)->plans_whole_sequence;
}

bool plans_whole_sequence(std::string_view name) {
  return std::ranges::any_of(kAgents, [&](const Entry& one) { return one.name == name && one.plans_whole_sequence; });
}

std::vector<std::string> agent_names() {
  std::vector<std::string> names;
  for (const Entry& one : kAgents) names.emplace_back(one.name);
  return names;
}

Expected<Decision, NoPlace> Agent::decide_with_costs(const ContainerState& state, const Item& item,
                                                     const PlaceCost& /*cost*/) {
  return decide(state, item);
}

Expected<Decision, NoPlace> Agent::decide_pressed(const ContainerState& /*state*/, const Item& /*item*/,
                                                  const PlaceCost& /*cost*/, double /*pressed*/) {
  return tl::unexpected(NoPlace::NoSpace);
}

std::optional<double> Agent::expected_percent(const ContainerState& /*state*/) { return std::nullopt; }

std::unique_ptr<Agent> make_agent(std::string_view name, AgentInput input) {
  check(input.settings, input.run);
  // Places in which a box presses deeper are for those who try them before they count.
  if (!input.run.tries_places) input.settings.last_interference = 0.0;
  if (input.future.kinds.size() != input.future.weights.size()) {
    throw InputError("future model", "weights", std::to_string(input.future.weights.size()), "as many as kinds");
  }
  if (input.ask) return make_remote_agent(name, std::move(input));
  const auto found = std::ranges::find(kAgents, name, &Entry::name);
  if (found != kAgents.end()) return found->make(std::move(input));
  const std::vector<std::string> names = agent_names();
  std::string expected = "one of";
  for (const std::string& known : names) expected += " " + known;
  const std::string_view nearest = find_nearest(name, names);
  if (!nearest.empty()) expected += "; did you mean " + std::string(nearest) + "?";
  throw InputError("agent", "", std::string(name), expected);
}

}  // namespace snug::packing
