// Belief files: a belief, the item that is to be decided on and the budget, as JSON: a decision that can be repeated.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "snug/planning/workspace.hpp"

namespace snug::planning {

/// A decision that is to be made.
struct PlanRequest {
  BeliefSnapshot belief;
  model::ItemIndex item;
  Budget budget;  ///< `threads` is no part of a file: the decision does not depend on it
};

/// The belief alone; every number to the last bit.
[[nodiscard]] std::string format_belief(const BeliefSnapshot& belief);
/// A file; docs/formats.md has its keys.
[[nodiscard]] std::string format_request(const PlanRequest& request);
/// Throws InputError with the path of the key for anything that it does not understand, and where the scenario's text
/// no longer gives the belief that was written (a side file that changed).
[[nodiscard]] PlanRequest parse_request(std::string_view text, const std::string& name);
[[nodiscard]] PlanRequest load_request(const std::filesystem::path& path);

/// Throws InputError where a file of this belief would read back as another: a scenario without text, say.
void expect_can_be_saved(const BeliefSnapshot& belief);

}  // namespace snug::planning
