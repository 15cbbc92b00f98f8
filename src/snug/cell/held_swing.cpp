// held_swing_window: over how long motions with a box are averaged, so that no box is left swinging.
#include "snug/cell/held_swing.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "snug/cup/swing.hpp"
#include "snug/motion/row_name.hpp"

namespace snug::cell {
namespace {

constexpr double kStep = 0.05;  ///< s
constexpr double kShortest = 0.1, kLongest = 0.6;

/// s, the slowest swing of the box, whichever of its faces is up.
double slowest_swing(const model::Scenario& scenario, const model::Parcel& parcel) {
  const Vector3 size = model::collision_size(scenario, parcel);
  double slowest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {1.0, -1.0}) {
      slowest = std::max(slowest, cup::longest_swing(scenario.cup, parcel.inertia, size, sign * Vector3::Unit(axis),
                                                     scenario.gravity.norm()));
    }
  }
  return slowest;
}

double window_of(double period) { return std::clamp(kStep * std::round(period / kStep), kShortest, kLongest); }

}  // namespace

std::optional<double> held_swing_window(const model::Scenario& scenario, const model::Sequence& sequence) {
  double slowest = 0.0;
  for (const model::Item& item : sequence.items) {
    slowest = std::max(slowest, slowest_swing(scenario, *model::find_parcel(scenario, item.parcel)));
  }
  return slowest > 0.0 ? std::optional<double>(window_of(slowest)) : std::nullopt;
}

std::vector<double> held_windows(const model::Scenario& scenario, const model::Sequence& sequence,
                                 const motion::Program& program) {
  std::map<std::string_view, double> known;
  std::vector<double> windows;
  for (const motion::Waypoint& row : program.waypoints) {
    const std::string_view id = motion::box_of(row.name);
    const auto [entry, is_new] = known.try_emplace(id, 0.0);
    if (is_new) {
      const model::Parcel* parcel = model::find_parcel(scenario, id);
      entry->second = parcel != nullptr ? window_of(slowest_swing(scenario, *parcel))
                                        : held_swing_window(scenario, sequence).value_or(kShortest);
    }
    windows.push_back(entry->second);
  }
  return windows;
}

}  // namespace snug::cell
