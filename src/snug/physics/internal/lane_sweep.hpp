// Lane sweep: a sweep of Gauss-Seidel over blocks of rows, those of sixteen pairs of bodies side by side.
#pragma once

#include <cstdint>

namespace snug::physics::internal {

inline constexpr int kLanes = 16;
using Lanes = float[kLanes];

/// One row of each of sixteen patches.
struct alignas(64) LanePoints {
  Lanes turning[3][6];  ///< J of the angular velocities of body A, then of B
  Lanes V[6];           ///< minus the inverse of the Delassus block
  Lanes W[3];           ///< nn, n1, n2
  Lanes W_inverse;      ///< minus 1 / nn
  Lanes mobility[2];    ///< 11, 22
  Lanes step_t;         ///< minus the tangential step
  Lanes mu, gamma;
  Lanes start[3];              ///< relative velocity without the changes; of the normal beyond its target
  Lanes lambda[3], before[3];  ///< impulse, and that before the last sweep
};
/// J of their linear velocities, where these are not the same for all rows of a patch.
struct alignas(64) LaneLinear {
  Lanes j[3][6];
};
/// Rows of sixteen patches that share no body.
struct alignas(64) LaneBlock {
  Lanes axes[3][3] = {};                        ///< n, t1, t2: J of the linear velocities is a scale times these
  Lanes scale_a = {}, scale_b = {};             ///< of bodies A and B
  Lanes mobility = {}, mass = {};               ///< along each axis, without turning; 0 in lanes not in use
  std::int32_t a[kLanes] = {}, b[kLanes] = {};  ///< first numbers of the bodies, or of one that does not move
  std::int32_t first = 0, count = 0;            ///< points
  std::int32_t linear = -1;                     ///< the first of LaneLinear; -1: `axes` serve all rows
};

/// What a sweep changes, by lanes.
struct LaneChange {
  Lanes largest = {};   ///< correction, m/s
  Lanes uphill = {};    ///< positive where the sweep goes back on what momentum adds
  Lanes error = {};     ///< sum of W d^2, d what visits correct
  Lanes unsolved = {};  ///< number of rows that were corrected by more than is wanted
};

struct LaneSweep {
  const LaneBlock* first;
  const LaneBlock* end;
  LanePoints* points;
  const LaneLinear* linear;
  float* velocities;  ///< eight numbers of each body, the last two none
  float momentum;
  float wanted;  ///< m/s
};

/// The same bytes by each: vectors of as many numbers.
using LaneKernel = void (*)(const LaneSweep&, LaneChange&) noexcept;
void sweep_by_four(const LaneSweep& sweep, LaneChange& change) noexcept;
void sweep_by_eight(const LaneSweep& sweep, LaneChange& change) noexcept;
void sweep_by_sixteen(const LaneSweep& sweep, LaneChange& change) noexcept;
/// `most_width`: lanes of the vectors to be used, where the processor has such.
[[nodiscard]] LaneKernel choose_lane_kernel(int most_width) noexcept;

}  // namespace snug::physics::internal
