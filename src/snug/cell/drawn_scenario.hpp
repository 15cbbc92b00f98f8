// DrawnScenario: a cell that could be the one a scenario describes, drawn from the scenario's own uncertainty.
#pragma once

#include <string>

#include "snug/core/rng.hpp"
#include "snug/model/scenario.hpp"

namespace snug::cell {

/// How an item stands at the aligner: X_WP. Where the sequence leaves the quarter turn to the aligner's rule, as for a
/// tool that comes for the middle of its upper face.
[[nodiscard]] Pose arrival_pose(const model::Scenario& scenario, const model::Item& item);

/// The same scenario in which every item of the sequence has a quarter turn of its own: how boxes arrive is then a fact
/// of the cell, and no program changes it.
[[nodiscard]] model::Scenario with_fixed_arrivals(model::Scenario scenario, const std::string& sequence);

/// With everything that `scenario.uncertainty` names drawn from `rng`. Where arrivals are fixed before, sizes that
/// differ by a millimetre do not turn a square box. Without an aligner nothing is drawn of it.
[[nodiscard]] model::Scenario draw_scenario(const model::Scenario& scenario, const std::string& sequence, Rng rng);

/// The cell of run `draw`, from 1, of the repeated runs of the scenario's seed.
[[nodiscard]] model::Scenario draw_run(const model::Scenario& scenario, const std::string& sequence, int draw);

/// Scales the stiffness of every compliant contact.
void stiffen(model::Scenario& scenario, double factor);

}  // namespace snug::cell
