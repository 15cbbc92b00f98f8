// Spin: how fast bodies may turn at the start, for the step of the time that follows them.
#pragma once

#include "snug/model/scenario.hpp"

namespace snug::model {

/// The first dynamic body that turns by half a turn or more in a time step, or null. A step cannot tell such a spin
/// from the one that turns back, and its gyroscopic moment throws the body out of the scene.
[[nodiscard]] const Body* find_too_fast_spin(const Scenario& scenario);
/// Throws InputError for such a body: for who changes the time step of a scenario that was read.
void check_spins(const Scenario& scenario);

}  // namespace snug::model
