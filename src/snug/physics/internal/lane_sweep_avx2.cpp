// Lane sweep by eight: compiled for processors with AVX2 (CMakeLists.txt).
#include "snug/core/wide_vectors.hpp"
#if SNUG_HAS_WIDE_VECTORS
#include "snug/physics/internal/lane_kernel.hpp"

namespace snug::physics::internal {

void sweep_by_eight(const LaneSweep& sweep, LaneChange& change) noexcept { sweep_blocks<Two<Lanes8>>(sweep, change); }

}  // namespace snug::physics::internal
#endif
