// RandomPair: pairs of shapes that contact code gets wrong, made at random.
#pragma once

#include <vector>

#include "snug/core/rng.hpp"
#include "snug/geometry/manifold.hpp"

namespace snug::geometry::test {

enum class Family {
  General,        ///< any size, any rotation, near touching
  Aligned,        ///< parallel faces, equal sizes, flush sides, shared edges
  AlmostAligned,  ///< the same, turned by 1e-3 .. 1e-12
  Sliver,         ///< edges 1000 : 1
  Diamond,        ///< turned by 45 or 90 degrees about edges, and almost
  Deep,           ///< coincident, contained, far inside
  Capsules,       ///< capsule against box, hull and capsule
  Hulls           ///< hull against hull and box
};
inline constexpr int kFamilies = 8;

struct RandomPair {
  Family family = Family::General;
  Shape A;
  Shape B;
  Pose X_WA;
  Pose X_WB;
  double margin = 0.0;
};

/// Draws pairs. Hulls come from a stock, because making one takes longer than colliding it.
class PairMaker {
 public:
  explicit PairMaker(std::uint64_t seed, int hulls = 1000);
  [[nodiscard]] RandomPair make(Family family, Rng& rng) const;

 private:
  std::vector<ConvexHull> stock_;
};

/// Uniform over all rotations.
[[nodiscard]] Matrix3 random_rotation(Rng& rng);

/// A small hull: random points, a wedge, a prism or a cut box.
[[nodiscard]] ConvexHull random_hull(Rng& rng);

}  // namespace snug::geometry::test
