// Lane sweep: by vectors that every processor has, and the choice of a kernel.
#include "snug/physics/internal/lane_sweep.hpp"

#include "snug/core/wide_vectors.hpp"
#include "snug/physics/internal/lane_kernel.hpp"

namespace snug::physics::internal {

void sweep_by_four(const LaneSweep& sweep, LaneChange& change) noexcept {
  sweep_blocks<Two<Two<Lanes4>>>(sweep, change);
}

LaneKernel choose_lane_kernel(int most_width) noexcept {
#if SNUG_HAS_WIDE_VECTORS
  const bool has_eight = __builtin_cpu_supports("avx2");
  const bool has_sixteen = __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
  if (has_sixteen && most_width >= 16) return sweep_by_sixteen;
  if (has_eight && most_width >= 8) return sweep_by_eight;
#else
  (void)most_width;
#endif
  return sweep_by_four;
}

}  // namespace snug::physics::internal
