// Shared supports: a face that lies on several fixed geoms in one plane bears on the rim of them all.
#pragma once

#include <cstddef>
#include <vector>

#include "snug/physics/internal/face_loads.hpp"

namespace snug::physics::internal {

/// A contact of a face, in the frame of the body that it belongs to.
struct SupportPoint {
  double x = 0.0, y = 0.0, height = 0.0;  ///< m, along the plane of the supports and from it
  int contact = 0;                        ///< in Scratch::contacts
  int rank = 0;                           ///< of its support, by its place in the world
};

/// Scratch of mark_covered_contacts().
struct SharedSupports {
  SharedSupports() = default;
  SharedSupports(std::size_t bodies, std::size_t patches, std::size_t contacts);

  std::vector<int> first;    ///< of each body: the first of its patches with fixed supports, or -1
  std::vector<int> next;     ///< of each patch: the next of the same body, or -1
  std::vector<int> touched;  ///< that have such patches
  std::vector<int> plane;    ///< patches of one plane
  std::vector<SupportPoint> points;
  std::vector<FaceLoad> loads;  ///< of each point, where faces bear on surfaces that run
  std::vector<int> contacts;    ///< of the plane
};

}  // namespace snug::physics::internal
