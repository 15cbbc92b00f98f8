// ContainerState: extents of boxes as they stand, and what they fill.
#include "snug/packing/container_state.hpp"

#include <algorithm>
#include <cmath>

namespace snug::packing {

ContainerState make_container_state(const model::Container& container) {
  return {container.inner_size, {}, container.has_walls};
}

Extent bounding_extent(const PlacedBox& box) {
  const Vector3 half = 0.5 * (box.X_TP.R.cwiseAbs() * box.item.size);
  return {box.X_TP.p - half, box.X_TP.p + half};
}

double lean_of(const Matrix3& R) { return std::acos(std::min(1.0, R.row(2).cwiseAbs().maxCoeff())); }

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

}  // namespace snug::packing
