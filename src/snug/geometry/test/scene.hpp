// Scene: one call of collide, and the few questions that tests ask of it.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <set>

#include "snug/geometry/manifold.hpp"

namespace snug::geometry::test {

inline constexpr double kRounding = 1e-15;  ///< sums of a few numbers below 1 m
inline const Shape kTable = Box{{0.2, 0.2, 0.05}};
inline const Vector3 kAlongX{0, std::numbers::pi / 2, 0};  ///< turns z to x

inline Manifold collide_once(const Shape& A, const Pose& X_WA, const Shape& B, const Pose& X_WB, double margin) {
  PairCache cache;
  Manifold out;
  collide(A, X_WA, B, X_WB, margin, cache, out);
  return out;
}

inline Pose at(double x, double y, double z, const Vector3& rotation = Vector3::Zero()) {
  return {exp_rotation(rotation), Vector3(x, y, z)};
}

/// The smallest gap, or +infinity without contact.
inline double least_phi(const Manifold& m) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < m.count; ++i) least = std::min(least, m.points[static_cast<std::size_t>(i)].phi);
  return least;
}

inline std::set<std::uint32_t> features(const Manifold& m) {
  std::set<std::uint32_t> names;
  for (int i = 0; i < m.count; ++i) names.insert(m.points[static_cast<std::size_t>(i)].feature);
  return names;
}

}  // namespace snug::geometry::test
