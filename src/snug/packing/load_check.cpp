// check_finished_load: whether a finished load is one: every box level, inside, supported, and carrying what it may.
#include "snug/packing/load_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "snug/core/check.hpp"

namespace snug::packing {
namespace {

constexpr double kGravity = 9.81;  ///< m/s^2

double shared(double low_a, double high_a, double low_b, double high_b) {
  return std::max(0.0, std::min(high_a, high_b) - std::max(low_a, low_b));
}

/// m^2, in plan view.
double shared_area(const Extent& a, const Extent& b) {
  return shared(a.low.x(), a.high.x(), b.low.x(), b.high.x()) * shared(a.low.y(), a.high.y(), b.low.y(), b.high.y());
}

double face_of(const Extent& box) { return (box.high - box.low).head<2>().prod(); }

/// `sink`: m, that the upper box may have pressed itself in beyond the slack.
bool carries(const Extent& lower, const Extent& upper, double slack, double sink) {
  const double gap = upper.low.z() - lower.high.z();
  return lower.high.z() < 0.5 * (upper.low.z() + upper.high.z()) && gap <= slack && gap >= -slack - sink &&
         shared_area(lower, upper) > 0.0;
}

/// m, of the edge of a face that bears unevenly.
double sink_of(const Give& give, double face, double mass) {
  const double part = give.full_area > 0.0 ? std::clamp(face / give.full_area, 0.01, 1.0) : 1.0;
  return 2.0 * kGravity * mass * give.per_force / part;
}

std::vector<Extent> extents_of(const ContainerState& state) {
  std::vector<Extent> extents;
  for (const PlacedBox& box : state.boxes) extents.push_back(upright_extent(box));
  return extents;
}

/// What rests on each box, and how far each may have sunk.
struct Bearing {
  std::vector<double> loads;                 ///< kg
  std::vector<double> sink_floor, sink_box;  ///< m, beyond the slack
};

bool is_on_floor(const Extent& box, double slack, double sink) {
  return box.low.z() <= slack && box.low.z() >= -slack - sink;
}

/// From the top down: what a box carries is known before it is asked what carries it.
Bearing bear(const ContainerState& state, const std::vector<Extent>& all, const LoadLimits& limits) {
  const double slack = limits.support_slack;
  std::vector<std::size_t> highest_first(all.size());
  std::iota(highest_first.begin(), highest_first.end(), std::size_t{0});
  std::ranges::stable_sort(highest_first,
                           [&](std::size_t a, std::size_t b) { return all[a].low.z() > all[b].low.z(); });
  Bearing bearing;
  bearing.loads.assign(all.size(), 0.0);
  bearing.sink_floor.assign(all.size(), 0.0);
  bearing.sink_box.assign(all.size(), 0.0);
  for (const std::size_t upper : highest_first) {
    const double weight = state.boxes[upper].item.mass + bearing.loads[upper];
    bearing.sink_floor[upper] = sink_of(limits.on_floor, face_of(all[upper]), weight);
    const double sink = bearing.sink_box[upper] = sink_of(limits.on_box, face_of(all[upper]), weight);
    if (is_on_floor(all[upper], slack, bearing.sink_floor[upper])) continue;
    double area = 0.0;
    for (const Extent& lower : all)
      area += carries(lower, all[upper], slack, sink) ? shared_area(lower, all[upper]) : 0.0;
    if (area <= 0.0) continue;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i != upper && carries(all[i], all[upper], slack, sink)) {
        bearing.loads[i] += weight * shared_area(all[i], all[upper]) / area;
      }
    }
  }
  return bearing;
}

double support_of(const std::vector<Extent>& all, const Bearing& bearing, std::size_t own, double slack) {
  const Extent& me = all[own];
  if (is_on_floor(me, slack, bearing.sink_floor[own])) return 1.0;
  double held = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i != own && carries(all[i], me, slack, bearing.sink_box[own])) held += shared_area(all[i], me);
  }
  return std::min(1.0, held / face_of(me));
}

/// m, that a box lies beyond a wall, over the rim, and under the floor.
std::array<double, 3> outside_of(const ContainerState& state, const PlacedBox& box) {
  const Extent around = bounding_extent(box);
  double beyond = 0.0;
  for (int axis = 0; axis < 2; ++axis) {
    const double half = 0.5 * state.inner_size[axis];
    beyond = std::max({beyond, around.high[axis] - half, -half - around.low[axis]});
  }
  return {beyond, around.high.z() - state.inner_size.z(), -around.low.z()};
}

}  // namespace

const char* name_of(LoadFault fault) {
  switch (fault) {
    case LoadFault::Leans:
      return "leans";
    case LoadFault::Outside:
      return "outside";
    case LoadFault::Unsupported:
      return "unsupported";
    case LoadFault::Overloaded:
      return "overloaded";
  }
  return "";
}

std::string describe(const LoadFinding& finding) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  switch (finding.fault) {
    case LoadFault::Leans:
      return fmt::format("leans by {:.1f} degrees ({:.1f} are allowed)", kDegrees * finding.value,
                         kDegrees * finding.limit);
    case LoadFault::Outside:
      return fmt::format("sticks out by {:.0f} mm ({:.0f} are allowed)", 1e3 * finding.value, 1e3 * finding.limit);
    case LoadFault::Unsupported:
      return fmt::format("{:.0f} % of its lower face are supported ({:.0f} are needed)", 100.0 * finding.value,
                         100.0 * finding.limit);
    case LoadFault::Overloaded:
      return fmt::format("carries {:.2f} kg ({:.2f} are allowed)", finding.value, finding.limit);
  }
  return "";
}

std::vector<double> loads_on(const ContainerState& state, double support_slack) {
  LoadLimits limits;
  limits.support_slack = support_slack;
  return bear(state, extents_of(state), limits).loads;
}

std::vector<LoadFinding> check_finished_load(const ContainerState& state, const LoadLimits& limits,
                                             std::span<const PoseDoubt> doubts) {
  SNUG_CHECK(doubts.empty() || doubts.size() == state.boxes.size(), "a doubt of every box, or none");
  const std::vector<Extent> all = extents_of(state);
  const Bearing bearing = bear(state, all, limits);
  std::vector<LoadFinding> findings;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const PlacedBox& box = state.boxes[i];
    const double lean = lean_of(box.X_TP.R), support = support_of(all, bearing, i, limits.support_slack);
    const auto [beyond, above, below] = outside_of(state, box);
    const PoseDoubt doubt = doubts.empty() ? PoseDoubt{} : doubts[i];
    const std::optional<double> most = box.item.no_stack ? std::optional(0.0) : box.item.max_load;
    const double allowed = most ? *most * (1.0 + limits.load_slack) : std::numeric_limits<double>::infinity();
    if (lean - doubt.angle > limits.tilt) {
      findings.push_back({box.item.id, LoadFault::Leans, lean, limits.tilt});
    } else if (beyond - doubt.position > limits.outside) {
      findings.push_back({box.item.id, LoadFault::Outside, beyond, limits.outside});
    } else if (above - doubt.position > limits.above) {
      findings.push_back({box.item.id, LoadFault::Outside, above, limits.above});
    } else if (below - doubt.position > limits.support_slack + bearing.sink_floor[i]) {
      findings.push_back({box.item.id, LoadFault::Outside, below, limits.support_slack + bearing.sink_floor[i]});
    } else if (support < limits.min_support) {
      findings.push_back({box.item.id, LoadFault::Unsupported, support, limits.min_support});
    } else if (bearing.loads[i] > allowed + 1e-9) {
      findings.push_back({box.item.id, LoadFault::Overloaded, bearing.loads[i], most.value_or(0.0)});
    }
  }
  return findings;
}

double least_level_acceleration(const ContainerState& state, double friction, double gap) {
  const std::vector<Extent> all = extents_of(state);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Extent& me = all[i];
    const Vector3 p_Tcm = state.boxes[i].X_TP * state.boxes[i].item.com;
    for (int axis = 0; axis < 2; ++axis) {
      const int across = 1 - axis;
      for (const double direction : {1.0, -1.0}) {
        const auto edge = [&](const Extent& box) { return direction > 0.0 ? box.high[axis] : -box.low[axis]; };
        const auto far_edge = [&](const Extent& box) { return direction > 0.0 ? box.low[axis] : -box.high[axis]; };
        const bool at_wall =
            state.has_walls && 0.5 * state.inner_size[axis] - edge(me) <= gap && state.inner_size.z() >= p_Tcm.z();
        const bool at_box = std::ranges::any_of(all, [&](const Extent& other) {
          const double free = far_edge(other) - edge(me);
          return &other != &me && free >= -gap && free <= gap && other.high.z() >= p_Tcm.z() &&
                 other.low.z() <= p_Tcm.z() &&
                 shared(me.low[across], me.high[across], other.low[across], other.high[across]) > 0.0;
        });
        if (at_wall || at_box) continue;  // what it leans on is judged by itself
        const double lever = edge(me) - direction * p_Tcm[axis], height = std::max(1e-6, p_Tcm.z() - me.low.z());
        least = std::min(least, kGravity * std::min(friction, std::max(0.0, lever / height)));
      }
    }
  }
  return least;
}

}  // namespace snug::packing
