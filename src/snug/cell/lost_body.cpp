// LostBody: a body that left the cell, where it was last seen and how fast it went.
#include "snug/cell/lost_body.hpp"

#include <fmt/format.h>

namespace snug::cell {

LostBody take_lost(const CellWorld& world, physics::WorldState& state, physics::BodyId body) {
  const auto index = static_cast<std::size_t>(body.index);
  const LostBody lost{world.model.bodies[index].name, state.time(world.model), state.bodies[index].p_WBcm,
                      state.bodies[index].velocity};
  physics::set_lost(state, body);
  return lost;
}

record::Event event_of(const LostBody& lost) {
  return {lost.time,
          "out of cell",
          lost.name,
          fmt::format("more than 1 km from the origin, at {:.0f} m/s: the run continues without it", lost.v_W.norm()),
          {{"x_m", lost.p_W.x()}, {"y_m", lost.p_W.y()}, {"z_m", lost.p_W.z()}, {"speed_m_s", lost.v_W.norm()}}};
}

}  // namespace snug::cell
