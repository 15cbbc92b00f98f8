// ContainerState: extents of boxes as they stand, what they fill and what they carry.
#include "snug/packing/container_state.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace snug::packing {

namespace {

/// Faces this near each other in height touch, m: boxes stand by a millimetre or two beside the ideal, and tilt.
constexpr double kTouch = 0.004;

double overlap(const Extent& a, const Extent& b, int axis) {
  return std::max(0.0, std::min(a.high[axis], b.high[axis]) - std::max(a.low[axis], b.low[axis]));
}

/// Area on which `upper` rests on `lower`, m^2.
double contact_area(const Extent& upper, const Extent& lower) {
  if (std::abs(upper.low.z() - lower.high.z()) > kTouch) return 0.0;
  return overlap(upper, lower, 0) * overlap(upper, lower, 1);
}

}  // namespace

ContainerState make_container_state(const model::Container& container) {
  return {container.inner_size, {}, container.has_walls};
}

Extent bounding_extent(const PlacedBox& box) {
  const Vector3 half = 0.5 * (box.X_TP.R.cwiseAbs() * box.item.size);
  return {box.X_TP.p - half, box.X_TP.p + half};
}

Extent upright_extent(const PlacedBox& box) {
  const Vector3 half = 0.5 * extents(nearest_orientation(box.X_TP.R), box.item.size);
  return {box.X_TP.p - half, box.X_TP.p + half};
}

double tilt(const PlacedBox& box) { return angle_between(rotation(nearest_orientation(box.X_TP.R)), box.X_TP.R); }

double filling_percent(const ContainerState& state) {
  double volume = 0.0;
  for (const PlacedBox& box : state.boxes) volume += box.item.size.prod();
  return state.inner_size.prod() > 0.0 ? 100.0 * volume / state.inner_size.prod() : 0.0;
}

std::vector<double> compute_loads(const ContainerState& state) {
  const std::size_t count = state.boxes.size();
  std::vector<Extent> extent(count);
  for (std::size_t i = 0; i < count; ++i) extent[i] = upright_extent(state.boxes[i]);
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return extent[a].low.z() > extent[b].low.z(); });
  std::vector<double> load(count, 0.0);
  std::vector<double> area(count);
  for (const std::size_t i : order) {
    double total = 0.0;
    for (std::size_t j = 0; j < count; ++j) {
      area[j] = (j == i || extent[j].low.z() >= extent[i].low.z()) ? 0.0 : contact_area(extent[i], extent[j]);
      total += area[j];
    }
    if (total <= 0.0) continue;
    for (std::size_t j = 0; j < count; ++j) load[j] += (load[i] + state.boxes[i].item.mass) * area[j] / total;
  }
  return load;
}

}  // namespace snug::packing
