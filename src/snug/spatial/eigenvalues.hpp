// symmetric_eigenvalues: of 6 x 6 matrices, compiled once for all who need it.
#pragma once

#include "snug/spatial/pose.hpp"

namespace snug {

/// Ascending; of M, symmetric, the lower half is read.
[[nodiscard]] Vector6 symmetric_eigenvalues(const Matrix6& M) noexcept;

}  // namespace snug
