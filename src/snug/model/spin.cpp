// Spin: how fast bodies may turn at the start, for the step of the time that follows them.
#include "snug/model/spin.hpp"

#include <algorithm>
#include <numbers>

#include "snug/core/input_error.hpp"
#include "snug/model/internal/value.hpp"

namespace snug::model {

const Body* find_too_fast_spin(const Scenario& scenario) {
  const auto found = std::ranges::find_if(scenario.bodies, [&](const Body& body) {
    return body.kind == BodyKind::Dynamic && !(body.V_WB.angular.norm() * scenario.time_step < std::numbers::pi);
  });
  return found == scenario.bodies.end() ? nullptr : &*found;
}

void check_spins(const Scenario& scenario) {
  const Body* const body = find_too_fast_spin(scenario);
  if (body == nullptr) return;
  throw InputError(scenario.source_name, "body '" + body->name + "'",
                   "a spin of " + internal::to_text(body->V_WB.angular.norm()) + " rad/s with a time step of " +
                       internal::to_text(scenario.time_step) + " s",
                   "less than half a turn in a time step");
}

}  // namespace snug::model
