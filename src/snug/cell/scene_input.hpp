// Scene input: motions and forces that the scenario prescribes, for one step.
#pragma once

#include <vector>

#include "snug/cell/world_builder.hpp"

namespace snug::cell {

/// Adds where the kinematic bodies of the scenario that move are at `end` [s], the end of the step.
void add_body_targets(const model::Scenario& scenario, const CellWorld& world, double end,
                      std::vector<physics::KinematicTarget>& targets);

/// Adds the wrenches of the scenario that act in the step from the state, each by the share of the step in which it
/// acts.
void add_wrenches(const model::Scenario& scenario, const CellWorld& world, const physics::WorldState& state,
                  std::vector<physics::ExternalWrench>& wrenches);

}  // namespace snug::cell
