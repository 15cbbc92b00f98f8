// held_swing_window: over how long motions with a box are averaged, so that no box is left swinging.
#pragma once

#include <optional>

#include "snug/model/scenario.hpp"

namespace snug::cell {

/// s, the period of the slowest swing of the sequence's boxes under the scenario's cup, whichever of their faces is
/// up, in whole steps of 0.05 s: what is known of a cup is no better. At least 0.1, at most 0.6 s. None without boxes.
[[nodiscard]] std::optional<double> held_swing_window(const model::Scenario& scenario, const model::Sequence& sequence);

}  // namespace snug::cell
