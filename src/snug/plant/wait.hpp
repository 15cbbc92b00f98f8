// Waiting for one thing of a plant that does nothing else meanwhile: for tests and for programs without a plan ahead.
#pragma once

#include "snug/plant/event.hpp"

namespace snug::plant {

/// Starts the motion and advances until it has ended. Events on the way are dropped.
Feedback run(Plant& plant, const Motion& motion);
/// Advances until the item has arrived; the robot stands. False: it does not come.
[[nodiscard]] bool bring_and_wait(Plant& plant, const model::ParcelId& item);
/// Perceives; the robot stands.
[[nodiscard]] perception::Observation observe(Plant& plant, std::span<const perception::Expectation> expected);

}  // namespace snug::plant
