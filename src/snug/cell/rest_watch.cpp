// RestWatch: whether boxes have come to rest: a moment at which all are slow is none, one that rocks turns back there.
#include "snug/cell/rest_watch.hpp"

#include <algorithm>

namespace snug::cell {
namespace {

/// m/s: slower, a box is not on its way. Soft boxes that sink into each other are slower, boxes that tip are not.
constexpr double kStill = 0.02;
constexpr double kQuiet = 0.1;  ///< s, of which all of them have been slow: longer than a box rocks slowly

}  // namespace

RestWatch::RestWatch(double now) : last_motion_(now - kQuiet) {}

void RestWatch::follow(const Simulation& simulation, const CellState& state) {
  const bool moves = std::ranges::any_of(simulation.world().parcels, [&](const physics::BodyId& parcel) {
    const physics::BodyState& body = state.world.bodies[static_cast<std::size_t>(parcel.index)];
    return body.is_present && body.velocity.norm() > kStill;
  });
  if (moves) last_motion_ = simulation.time(state);
}

bool RestWatch::is_at_rest(double now) const { return now >= last_motion_ + kQuiet; }

}  // namespace snug::cell
