// BoxAxes: the fifteen separating axes of two boxes.
#pragma once

#include "snug/geometry/internal/features.hpp"

namespace snug::geometry::internal {

/// Two boxes seen from A.
struct BoxPair {
  Vector3 half_A;
  Vector3 half_B;
  Matrix3 R_AB;
  Vector3 p_AB;

  /// Fills R_AB and p_AB.
  void place(const Pose& X_WA, const Pose& X_WB) noexcept;
};

/// One axis with its direction.
struct BoxAxis {
  Axis axis;
  double separation = 0.0;         ///< m
  Vector3 n_A = Vector3::UnitZ();  ///< unit, from A to B, in A
};

/// What the fifteen axes say.
struct BoxAxes {
  std::array<double, 6> face{};     ///< separation along the faces of A (0-2) and B (3-5), m
  std::array<int, 6> face_index{};  ///< the face of that axis which looks at the other box
  BoxAxis best_face;
  BoxAxis best_edge;  ///< kind None when no edge axis separates by more than the best face
};

/// Separation along one remembered axis; -infinity when the axis means nothing for the pair.
[[nodiscard]] BoxAxis evaluate(const BoxPair& pair, const Axis& axis) noexcept;

/// Separation of two boxes along a remembered axis, straight from the poses: the early way out.
[[nodiscard]] double quick_separation(const Vector3& half_A, const Pose& X_WA, const Vector3& half_B, const Pose& X_WB,
                                      const Axis& axis) noexcept;

/// Evaluates all axes. Returns false, with the axis in best_face, as soon as one separates by more than the margin.
[[nodiscard]] bool find_axes(const BoxPair& pair, double margin, BoxAxes& out) noexcept;

/// Unit normal in A of one of the six face axes, from A to B.
[[nodiscard]] Vector3 face_normal(const BoxPair& pair, const BoxAxes& axes, int which) noexcept;

}  // namespace snug::geometry::internal
