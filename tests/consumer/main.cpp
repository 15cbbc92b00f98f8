// consumer: two boxes that overlap by 10 mm. Prints how far they are apart, m.
#include <cstdio>

#include "snug/geometry/manifold.hpp"

int main() {
  const snug::geometry::Shape box = snug::geometry::Box{{0.1, 0.1, 0.1}};
  snug::Pose X_WB;
  X_WB.p = snug::Vector3(0.0, 0.0, 0.19);
  snug::geometry::PairCache cache;
  snug::geometry::Manifold manifold;
  snug::geometry::collide(box, snug::Pose{}, box, X_WB, 0.0, cache, manifold);
  if (manifold.count == 0) return 1;
  std::printf("%.3f\n", manifold.points[0].phi);
  return 0;
}
