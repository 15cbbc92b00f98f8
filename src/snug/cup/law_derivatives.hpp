// Parts of the law's derivatives, for identification: how the deformation and its pull-back change with the pose.
#pragma once

#include "snug/spatial/pose.hpp"

namespace snug::cup {

/// J(H): de = J nu, nu = [v; w] the body twist of S1 in S2 (docs/theory/cup.md, eq. b).
[[nodiscard]] Matrix6 deformation_jacobian(const Pose& H);

/// G(H, y): d(J^T y) = G nu with y held (docs/theory/cup.md, eq. d).
[[nodiscard]] Matrix6 pullback_derivative(const Pose& H, const Vector6& y);

}  // namespace snug::cup
