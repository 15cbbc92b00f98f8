// The agents that make_agent chooses from.
#pragma once

#include <memory>

#include "snug/packing/agent.hpp"
#include "snug/packing/internal/convert.hpp"
#include "snug/packing/internal/policy.hpp"
#include "snug/packing/internal/roll_out.hpp"

namespace snug::packing::internal {

[[nodiscard]] std::unique_ptr<Agent> make_margin_agent(AgentInput input);
[[nodiscard]] std::unique_ptr<Agent> make_contact_aware_agent(AgentInput input);

[[nodiscard]] std::unique_ptr<Agent> make_manual_agent(AgentInput input);
[[nodiscard]] std::unique_ptr<Agent> make_offline_agent(AgentInput input);

/// Zero clearance, flips: how the agents that touch plan.
[[nodiscard]] Planning plan_for_contact(const ContainerState& state, const PackingSettings& settings);
/// A decision time in places to be looked at.
[[nodiscard]] std::int64_t work_for(double seconds);
/// What costs least comes first.
void order_by_cost(const Layout& layout, const Policy& policy, const Piece& piece, std::vector<CandidatePose>& poses);
/// Policy for these kinds of items in a container of this size.
[[nodiscard]] Policy make_policy(const Planning& planning, std::span<const Item> kinds);
/// Reason for an item for which find_poses had nothing.
[[nodiscard]] NoPlace reason_of(Refusal worst);

}  // namespace snug::packing::internal
