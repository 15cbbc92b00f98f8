// Manifolds of near pairs, kept while the pair hardly moves, with impulses handed on by feature.
#pragma once

#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {

struct PairBodies {
  int a, b;
  const Geom& geom_a;
  const Geom& geom_b;
};

inline PairBodies bodies_of(const WorldModel& model, const PairState& pair) {
  const WorldModel::GeomRef& a = model.geoms[pair.geom_a];
  const WorldModel::GeomRef& b = model.geoms[pair.geom_b];
  return {a.body, b.body, model.bodies[static_cast<std::size_t>(a.body)].geoms[static_cast<std::size_t>(a.geom)],
          model.bodies[static_cast<std::size_t>(b.body)].geoms[static_cast<std::size_t>(b.geom)]};
}

/// A manifold that holds for the present poses. What a body loses that lies on fixed ones: Scratch::lost_impulses.
void refresh_manifold(const PairBodies& bodies, const WorldState& state, double reach, double margin, bool is_face,
                      std::uint32_t index, Scratch& work, PairState& pair);

}  // namespace snug::physics::internal
