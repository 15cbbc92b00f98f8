// Plan report: a decision for people and programs: what was tried and why it lost.
#pragma once

#include <string>

#include "snug/planning/belief_json.hpp"
#include "snug/planning/plan.hpp"

namespace snug::planning {

/// What is decided, and a line for each candidate and insertion, in the order in which they were tried.
[[nodiscard]] std::string format_plan_table(const PlanRequest& request, const Plan& plan);
/// The same as JSON; docs/formats.md has its keys. Numbers to the last bit.
[[nodiscard]] std::string format_plan_json(const PlanRequest& request, const Plan& plan);

}  // namespace snug::planning
