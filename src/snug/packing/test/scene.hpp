// Scenes and checks that the tests of this module share.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "snug/core/rng.hpp"
#include "snug/packing/agent.hpp"

namespace snug::packing::test {

inline constexpr int kCell = 100;  ///< ticks; small layouts are of multiples of it, so that their maps are exact

inline model::Scenario demonstrator() {
  return model::load_scenario(SNUG_SOURCE_DIR "/scenarios/box-demonstrator.yaml");
}

inline Item make_box(const std::string& id, const Vector3& size, double mass = 1.0) {
  Item item;
  item.id = id;
  item.size = size;
  item.mass = mass;
  return item;
}

/// The boxes of the demonstrator in an order drawn from the seed.
inline std::vector<Item> shuffled_items(const model::Scenario& scenario, std::uint64_t seed) {
  Rng rng = Rng(seed).split("shuffled items");
  std::vector<Item> items = make_future_model(scenario).kinds;
  for (std::size_t i = items.size(); i > 1; --i) {
    std::swap(items[i - 1], items[static_cast<std::size_t>(rng.index(static_cast<int>(i)))]);
  }
  return items;
}

/// Places items until one is refused.
inline ContainerState pack_all(Agent& agent, ContainerState state, const std::vector<Item>& items) {
  for (const Item& item : items) {
    const auto decision = agent.decide(state, item);
    if (!decision) break;
    state = with_candidate(state, item, decision->candidates.front());
  }
  return state;
}

/// Part of a box's lower face that rests on the floor or on tops within `slack` below it, counted from the extents.
inline double support_of(const ContainerState& state, std::size_t index, double slack) {
  const Extent me = upright_extent(state.boxes[index]);
  if (me.low.z() < 1e-9) return 1.0;
  double held = 0.0;
  for (std::size_t j = 0; j < index; ++j) {
    const Extent other = upright_extent(state.boxes[j]);
    if (other.high.z() > me.low.z() + 1e-9 || other.high.z() < me.low.z() - slack - 1e-9) continue;
    const double x = std::min(me.high.x(), other.high.x()) - std::max(me.low.x(), other.low.x());
    const double y = std::min(me.high.y(), other.high.y()) - std::max(me.low.y(), other.low.y());
    held += std::max(0.0, x) * std::max(0.0, y);
  }
  return held / ((me.high.x() - me.low.x()) * (me.high.y() - me.low.y()));
}

/// Nothing outside, nothing overlapping, everything supported and lowered from above, up to `give` (two boxes give way
/// by it together) and rounding to a tenth of a millimetre.
inline void expect_sound(const ContainerState& state, double give, double min_support, double slack = 0.003) {
  const double tick = 2e-4;  // two roundings of 0.1 mm
  for (std::size_t i = 0; i < state.boxes.size(); ++i) {
    SCOPED_TRACE(i);
    const Extent a = upright_extent(state.boxes[i]);
    const Vector3 half(0.5 * state.inner_size.x(), 0.5 * state.inner_size.y(), 0.0);
    EXPECT_GE((a.low + half).head<2>().minCoeff(), -0.5 * give - tick);
    EXPECT_GE(a.low.z(), -1e-9);
    EXPECT_LE((a.high - half).x(), 0.5 * give + tick);
    EXPECT_LE((a.high - half).y(), 0.5 * give + tick);
    EXPECT_LE(a.high.z(), state.inner_size.z() + 1e-9);
    // Both faces are smaller by half the give: the ratio of areas differs by less than four times give / shortest
    // side.
    EXPECT_GE(support_of(state, i, slack), min_support - 4.0 * give / 0.06);
    for (std::size_t j = 0; j < i; ++j) {
      const Extent b = upright_extent(state.boxes[j]);
      const Vector3 shared = a.high.cwiseMin(b.high) - a.low.cwiseMax(b.low);
      const bool beside = shared.head<2>().minCoeff() <= give + tick;
      EXPECT_TRUE(beside || a.low.z() >= b.high.z() - 1e-9) << "box " << j << " is in the way from above";
    }
  }
}

}  // namespace snug::packing::test
