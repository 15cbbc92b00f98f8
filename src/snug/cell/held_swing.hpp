// What held boxes ask of motions: over how long these are averaged, so that no box is left swinging, and how gently
// they turn.
#pragma once

#include <optional>

#include "snug/model/scenario.hpp"

namespace snug::cell {

/// s, the period of the slowest swing of the sequence's boxes under the scenario's cup, whichever of their faces is
/// up, in whole steps of 0.05 s: what is known of a cup is no better. At least 0.1, at most 0.6 s. None without boxes.
[[nodiscard]] std::optional<double> held_swing_window(const model::Scenario& scenario, const model::Sequence& sequence);

/// Whether turning some box of the sequence as fast as FastSettings::held asks the cup for so much torque that it holds
/// noticeably less: 0.3 N m and more.
[[nodiscard]] bool turns_gently(const model::Scenario& scenario, const model::Sequence& sequence);

}  // namespace snug::cell
