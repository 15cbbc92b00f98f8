// Plane hull: the convex hull of points in a plane.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace snug {

/// Indices of the corners, counter-clockwise from the lowest x (then y); of equal points one, none within a side
/// (Andrew's chains).
[[nodiscard]] std::vector<std::size_t> plane_hull(std::span<const Eigen::Vector2d> points);

}  // namespace snug
