// Uncertainty: what nobody knows exactly about a cell, and scenarios drawn from it.
#pragma once

#include <numbers>

#include "snug/core/rng.hpp"
#include "snug/model/scenario.hpp"

namespace snug::task {

/// Half widths of uniform draws.
struct Uncertainty {
  double size = 1.0e-3;                         ///< m, each edge of each box
  double friction = 0.20;                       ///< share of each pair's coefficient
  double position = 3.0e-3;                     ///< m, of each box at the aligner, along Ax and Ay
  double yaw = 1.0 * std::numbers::pi / 180.0;  ///< rad, of each box at the aligner
  double com = 5.0e-3;                          ///< m, each coordinate of each centre of mass
  double cup = 0.10;                            ///< share of the cup's stiffness and damping
  double mass = 0.0;                            ///< share of each box's mass; cell::kMassSpread in executions
  bool operator==(const Uncertainty&) const = default;
};

/// The scenario with every change drawn from `rng`. The boxes of the sequence keep the quarter turn at the aligner that
/// they have in the scenario as it is: sizes that differ by a millimetre do not turn a square box.
[[nodiscard]] model::Scenario sample(const model::Scenario& scenario, const std::string& sequence,
                                     const Uncertainty& uncertainty, Rng rng);

/// How an item stands at the aligner when the tool comes for the middle of its upper face: X_WP.
[[nodiscard]] Pose arrival_pose(const model::Scenario& scenario, const model::Item& item);

}  // namespace snug::task
