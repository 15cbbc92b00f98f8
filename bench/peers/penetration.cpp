// Penetration: separating-axis test of two boxes, and the worst of a scene.
#include "peers/penetration.hpp"

#include <algorithm>
#include <limits>

namespace snug::peers {

namespace {

/// Half width of a box along a unit direction of W.
double reach(const Vector3& half, const Pose& X_WB, const Vector3& axis_W) {
  return (X_WB.R.transpose() * axis_W).cwiseAbs().dot(half);
}

}  // namespace

double box_box_depth(const Vector3& half_a, const Pose& X_WA, const Vector3& half_b, const Pose& X_WB) {
  const Vector3 p_AB_W = X_WB.p - X_WA.p;
  double depth = std::numeric_limits<double>::max();
  const auto try_axis = [&](const Vector3& axis_W) {
    depth = std::min(depth, reach(half_a, X_WA, axis_W) + reach(half_b, X_WB, axis_W) - std::abs(axis_W.dot(p_AB_W)));
  };
  for (int i = 0; i < 3; ++i) {
    try_axis(X_WA.R.col(i));
    try_axis(X_WB.R.col(i));
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const Vector3 axis = X_WA.R.col(i).cross(X_WB.R.col(j));
      const double length = axis.norm();
      if (length > 1e-6) try_axis(axis / length);  // nearly parallel edges: the face axes decide
    }
  }
  return depth;
}

double lowest_corner(const Vector3& half, const Pose& X_WB) { return X_WB.p.z() - reach(half, X_WB, Vector3::UnitZ()); }

double worst_depth(const Scene& scene, const std::vector<Pose>& poses, const std::vector<bool>& present) {
  double worst = 0.0;
  for (std::size_t a = 0; a < scene.bodies.size(); ++a) {
    const BoxBody& box_a = scene.bodies[a];
    if (!present[a] || !(box_a.mass > 0)) continue;
    if (scene.has_plane) worst = std::max(worst, scene.plane_height - lowest_corner(box_a.half, poses[a]));
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      const BoxBody& box_b = scene.bodies[b];
      const bool is_counted = box_b.mass > 0 && b <= a;  // pairs of free boxes once
      if (!present[b] || is_counted) continue;
      if ((poses[a].p - poses[b].p).norm() > box_a.half.norm() + box_b.half.norm()) continue;
      worst = std::max(worst, box_box_depth(box_a.half, poses[a], box_b.half, poses[b]));
    }
  }
  return worst;
}

}  // namespace snug::peers
