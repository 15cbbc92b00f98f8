// make_agent: agents by name.
#include "snug/packing/agent.hpp"

#include <cmath>

#include "snug/core/input_error.hpp"
#include "snug/packing/internal/agents.hpp"
#include "snug/packing/remote_agent.hpp"

namespace snug::packing {

namespace {

void require(bool holds, const char* key, double got, const char* expected) {
  if (!holds) throw InputError("packing settings", key, std::to_string(got), expected);
}

void check(const PackingSettings& s) {
  const auto within = [](double value, double low, double high) { return value >= low && value <= high; };
  require(within(s.decision_time, 0.0, 3600.0), "decision_time", s.decision_time, "0 .. 3600 s");
  require(within(s.threads, 1, 256), "threads", s.threads, "1 .. 256");
  require(within(s.max_candidates, 1, 1000), "max_candidates", s.max_candidates, "1 .. 1000");
  require(within(s.max_flips, 0, 2), "max_flips", s.max_flips, "0, 1 or 2");
  require(within(s.margin, 0.0, 1.0), "margin", s.margin, "0 .. 1 m");
  require(within(s.squeeze, 0.0, 0.010), "squeeze", s.squeeze, "0 .. 0.01 m");
  require(within(s.last_squeeze, 0.0, 0.010), "last_squeeze", s.last_squeeze, "0 .. 0.01 m");
  require(within(s.min_support, 0.0, 1.0), "min_support", s.min_support, "0 .. 1");
  require(within(s.com_margin, 0.0, 0.1), "com_margin", s.com_margin, "0 .. 0.1 m");
  require(within(s.level_slack, 0.0, 0.05), "level_slack", s.level_slack, "0 .. 0.05 m");
  require(within(s.min_slenderness, 0.0, 10.0), "min_slenderness", s.min_slenderness, "0 .. 10");
  require(within(s.max_item_mass, 0.0, 1.0e6), "max_item_mass", s.max_item_mass, "0 .. 1e6 kg");
  require(within(s.min_pick_face, 0.0, 10.0), "min_pick_face", s.min_pick_face, "0 .. 10 m");
}

}  // namespace

std::vector<std::string> agent_names() { return {"margin", "contact-aware", "manual", "offline"}; }

std::unique_ptr<Agent> make_agent(std::string_view name, AgentInput input) {
  check(input.settings);
  if (input.future.kinds.size() != input.future.weights.size()) {
    throw InputError("future model", "weights", std::to_string(input.future.weights.size()), "as many as kinds");
  }
  if (input.ask) return make_remote_agent(name, std::move(input));
  if (name == "margin") return internal::make_margin_agent(std::move(input));
  if (name == "contact-aware") return internal::make_contact_aware_agent(std::move(input));
  if (name == "manual") return internal::make_manual_agent(std::move(input));
  if (name == "offline") return internal::make_offline_agent(std::move(input));
  const std::vector<std::string> names = agent_names();
  std::string expected = "one of";
  for (const std::string& known : names) expected += " " + known;
  const std::string_view nearest = find_nearest(name, names);
  if (!nearest.empty()) expected += "; did you mean " + std::string(nearest) + "?";
  throw InputError("agent", "", std::string(name), expected);
}

}  // namespace snug::packing
