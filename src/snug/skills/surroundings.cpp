// Surroundings: what a box meets around the place it shall have: support, neighbours, walls.
#include "snug/skills/surroundings.hpp"

#include <algorithm>

namespace snug::skills {
namespace {

constexpr double kNothingBeside = 1.0;  ///< m, side gap of a box at the edge of a pallet

packing::Extent extent_of(const packing::PlacedBox& box, double shrink) {
  packing::Extent extent = packing::bounding_extent(box);
  extent.low += Vector3::Constant(0.5 * shrink);
  extent.high -= Vector3::Constant(0.5 * shrink);
  return extent;
}

bool overlap(const packing::Extent& a, const packing::Extent& b, int axis, double graze) {
  return std::min(a.high[axis], b.high[axis]) - std::max(a.low[axis], b.low[axis]) > graze;
}

void add_neighbour(const packing::Extent& other, const packing::Extent& box, const settings::InsertionParams& params,
                   packing::Candidate& candidate) {
  const double graze = params.graze;
  for (int axis = 0; axis < 2; ++axis) {
    if (!overlap(other, box, 1 - axis, graze) || other.high.z() - box.low.z() < graze || other.low.z() > box.high.z()) {
      continue;
    }
    const auto low = static_cast<std::size_t>(2 * axis), high = low + 1;
    const double height = other.high.z() - box.low.z();
    const double gap_low = box.low[axis] - other.high[axis], gap_high = other.low[axis] - box.high[axis];
    const auto note = [&](std::size_t side, double gap) {
      if (gap < -params.inside) return;
      if (gap < candidate.side_gap[side] - graze) {
        candidate.side_height[side] = height;
      } else if (gap < candidate.side_gap[side] + graze) {
        candidate.side_height[side] = std::max(candidate.side_height[side], height);
      }
      candidate.side_gap[side] = std::min(candidate.side_gap[side], gap);
    };
    if (gap_low > gap_high) note(low, gap_low);
    if (gap_high >= gap_low) note(high, gap_high);
  }
}

}  // namespace

packing::Candidate measured(const packing::ContainerState& state, packing::Candidate candidate, const Vector3& size,
                            double shrink, const settings::InsertionParams& params) {
  Pose& X_TP = candidate.placement.X_TP;
  const Vector3 half = 0.5 * (X_TP.R.cwiseAbs() * (size - Vector3::Constant(shrink)));
  packing::Extent box{X_TP.p - half, X_TP.p + half};
  double support = 0.0;
  for (const packing::PlacedBox& other : state.boxes) {
    const packing::Extent extent = extent_of(other, shrink);
    const bool is_below = extent.high.z() < X_TP.p.z();
    if (is_below && overlap(extent, box, 0, params.graze) && overlap(extent, box, 1, params.graze))
      support = std::max(support, extent.high.z());
  }
  X_TP.p.z() = support + half.z();
  box = {X_TP.p - half, X_TP.p + half};
  for (int axis = 0; axis < 2; ++axis) {
    const auto low = static_cast<std::size_t>(2 * axis), high = low + 1;
    candidate.side_gap[low] = 0.5 * state.inner_size[axis] + box.low[axis];
    candidate.side_gap[high] = 0.5 * state.inner_size[axis] - box.high[axis];
    candidate.side_height[low] = candidate.side_height[high] = state.inner_size.z() - box.low.z();
    if (state.has_walls) continue;
    candidate.side_gap[low] = candidate.side_gap[high] = kNothingBeside;
    candidate.side_height[low] = candidate.side_height[high] = 0.0;
  }
  for (const packing::PlacedBox& other : state.boxes) add_neighbour(extent_of(other, shrink), box, params, candidate);
  for (const packing::Extent& obstacle : state.obstacles) add_neighbour(obstacle, box, params, candidate);
  return candidate;
}

}  // namespace snug::skills
