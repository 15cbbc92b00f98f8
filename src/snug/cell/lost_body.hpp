// LostBody: a body that left the cell, where it was last seen and how fast it went.
#pragma once

#include <string>

#include "snug/cell/world_builder.hpp"
#include "snug/record/recording.hpp"

namespace snug::cell {

struct LostBody {
  std::string name;
  double time = 0.0;              ///< s
  Vector3 p_W = Vector3::Zero();  ///< m, of its centre of mass
  Vector3 v_W = Vector3::Zero();  ///< m/s
};

/// Takes the body that a step lost (StepStatus::LostBody) out of the world.
[[nodiscard]] LostBody take_lost(const CellWorld& world, physics::WorldState& state, physics::BodyId body);
/// "out of cell"
[[nodiscard]] record::Event event_of(const LostBody& lost);

}  // namespace snug::cell
