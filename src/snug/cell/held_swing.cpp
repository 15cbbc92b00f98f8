// held_swing_window: over how long motions with a box are averaged, so that no box is left swinging.
#include "snug/cell/held_swing.hpp"

#include <algorithm>
#include <cmath>

#include "snug/cup/swing.hpp"

namespace snug::cell {
namespace {

constexpr double kStep = 0.05;  ///< s
constexpr double kShortest = 0.1, kLongest = 0.6;

}  // namespace

std::optional<double> held_swing_window(const model::Scenario& scenario, const model::Sequence& sequence) {
  double slowest = 0.0;
  for (const model::Item& item : sequence.items) {
    const model::Parcel& parcel = *model::find_parcel(scenario, item.parcel);
    const Vector3 size = model::collision_size(scenario, parcel);
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {1.0, -1.0}) {
        slowest = std::max(slowest, cup::find_swing(scenario.cup, parcel.inertia, size, sign * Vector3::Unit(axis),
                                                    scenario.gravity.norm())
                                        .slow);
      }
    }
  }
  if (slowest == 0.0) return std::nullopt;
  return std::clamp(kStep * std::round(slowest / kStep), kShortest, kLongest);
}

}  // namespace snug::cell
