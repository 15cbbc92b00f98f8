// What held boxes ask of motions.
#include "snug/cell/held_swing.hpp"

#include <algorithm>
#include <cmath>

#include "snug/cup/swing.hpp"
#include "snug/motion/fast_settings.hpp"

namespace snug::cell {
namespace {

constexpr double kStep = 0.05;  ///< s
constexpr double kShortest = 0.1, kLongest = 0.6;
/// N m, chosen: a box of 250 x 180 mm and 2.5 kg takes 0.24, under one cup, and is held as before; a carton of 600 x
/// 400 mm and 8 kg takes 4.2, and four cups hold it 2.15 times, not 2.6.
constexpr double kTorque = 0.3;

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

bool turns_gently(const model::Scenario& scenario, const model::Sequence& sequence) {
  const double acceleration = motion::FastSettings{}.held.max_turn_acceleration;
  return std::ranges::any_of(sequence.items, [&](const model::Item& item) {
    const Matrix3& I_P = model::find_parcel(scenario, item.parcel)->inertia.inertia;
    return I_P.diagonal().maxCoeff() * acceleration > kTorque;
  });
}

}  // namespace snug::cell
