// The states there are; each is a file of its own.
#pragma once

#include <memory>

#include "snug/control/state_machine.hpp"

namespace snug::control {

/// Passes on at once: Ok.
[[nodiscard]] std::unique_ptr<State> make_initial_state();
/// Runs the program. Ok when its last row is reached, Stuck when a row is not reached in time.
[[nodiscard]] std::unique_ptr<State> make_operation_state();
/// Stands still, for good.
[[nodiscard]] std::unique_ptr<State> make_hold_state();

}  // namespace snug::control
