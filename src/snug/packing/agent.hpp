// Agent: decides, item by item, where a box goes.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "snug/core/expected.hpp"
#include "snug/packing/container_state.hpp"
#include "snug/packing/placement.hpp"
#include "snug/packing/settings.hpp"

namespace snug::packing {

/// What an agent may expect of items to come: kinds and how often each comes.
struct FutureModel {
  std::vector<Item> kinds;
  std::vector<double> weights;  ///< > 0, as many as kinds
  /// Each kind is one box, which comes once at most: what has come does not come again.
  bool comes_once = false;
  bool operator==(const FutureModel&) const = default;
};

/// Every parcel of the scenario, equally likely and once at most, as in any sequence: types as frequent as the scenario
/// has them, sizes as measured.
[[nodiscard]] FutureModel make_future_model(const model::Scenario& scenario);
/// The boxes of the order alone, once each, in any order. Throws InputError for an unknown parcel.
[[nodiscard]] FutureModel make_order_future(const model::Scenario& scenario, const model::Sequence& order);
/// Every parcel of the scenario, equally likely, again and again: nothing is known of the order.
[[nodiscard]] FutureModel make_catalogue_future(const model::Scenario& scenario);
/// The same of some of its parcels.
[[nodiscard]] FutureModel make_future_model(const model::Scenario& scenario, std::span<const model::Parcel> parcels);

struct Decision {
  std::vector<Candidate> candidates;  ///< best first, never empty
  std::int64_t roll_outs = 0;
  double pressed = 0.0;  ///< m: planned with this interference, where there is no other place; 0: as always
  bool operator==(const Decision&) const = default;
};

/// What standing so costs beside the room that it takes, percent of the container: turning the box, for example.
/// Absent: nothing.
using PlaceCost = std::function<double(const Placement&)>;

/// Same state, item, costs and settings: same decision. Knows nothing of later items unless it was made with them.
class Agent {
 public:
  virtual ~Agent() = default;
  [[nodiscard]] virtual std::string_view name() const = 0;
  [[nodiscard]] virtual Expected<Decision, NoPlace> decide(const ContainerState& state, const Item& item) = 0;
  /// The same where places cost something, before candidates are cut to `max_candidates`. Agents that do not weigh
  /// costs decide without.
  [[nodiscard]] virtual Expected<Decision, NoPlace> decide_with_costs(const ContainerState& state, const Item& item,
                                                                      const PlaceCost& cost);
  /// Other places, planned with more interference than `pressed` (Decision::pressed), up to `last_interference`, where
  /// none of decide() can be had; for most agents there are none.
  [[nodiscard]] virtual Expected<Decision, NoPlace> decide_pressed(const ContainerState& state, const Item& item,
                                                                   const PlaceCost& cost, double pressed);
  /// Percent filled in the end, on average over what may come, when everything stays where it lies; nothing for agents
  /// that do not look ahead.
  [[nodiscard]] virtual std::optional<double> expected_percent(const ContainerState& state);
};

/// Sends a line of JSON to whoever decides elsewhere and returns his answer, a line of JSON.
using Ask = std::function<std::string(const std::string& line)>;

struct AgentInput {
  PackingSettings settings;
  FutureModel future;                                  ///< contact-aware
  std::vector<Item> sequence;                          ///< offline alone reads it
  std::function<bool(const Placement&)> is_reachable;  ///< absent: everywhere
  Ask ask = {};  ///< decides instead of a built-in agent (remote_agent.hpp); absent: the agent of that name does
  DecisionRun run = {};
};

enum class AgentKind {
  Margin,        ///< lowest place with a margin to everything
  ContactAware,  ///< places in contact, chosen by roll-outs over what may come
  Manual,        ///< re-arranges what it placed before, as a person with paper does
  Offline,       ///< knows the whole sequence
};
/// Of `pack --agent` and files.
[[nodiscard]] const char* name_of(AgentKind kind);
/// It plans all of a sequence before anything is done: its places are not decided on item by item.
[[nodiscard]] bool plans_whole_sequence(AgentKind kind);
/// The same by name; false for a name that is not known.
[[nodiscard]] bool plans_whole_sequence(std::string_view name);
/// Names that make_agent knows.
[[nodiscard]] std::vector<std::string> agent_names();
/// Throws InputError for an unknown name or for settings that cannot be.
[[nodiscard]] std::unique_ptr<Agent> make_agent(std::string_view name, AgentInput input);

}  // namespace snug::packing
