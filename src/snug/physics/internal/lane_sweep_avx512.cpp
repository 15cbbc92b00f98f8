// Lane sweep by sixteen: compiled for processors with AVX-512 (CMakeLists.txt).
#include "snug/core/wide_vectors.hpp"
#if SNUG_HAS_WIDE_VECTORS
#include "snug/physics/internal/lane_kernel.hpp"

namespace snug::physics::internal {

void sweep_by_sixteen(const LaneSweep& sweep, LaneChange& change) noexcept { sweep_blocks<Lanes16>(sweep, change); }

}  // namespace snug::physics::internal
#endif
