// Shared supports: a face that lies on several fixed geoms in one plane bears on the rim of them all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <vector>

#include "snug/core/bounded_vector.hpp"
#include "snug/physics/internal/face_loads.hpp"

namespace snug::physics::internal {

/// A contact of a face, in the frame of the body that it belongs to.
struct SupportPoint {
  double x = 0.0, y = 0.0, height = 0.0;  ///< m, along the plane of the supports and from it
  int contact = 0;                        ///< in Scratch::contacts
  int rank = 0;                           ///< of its support, by its place in the world
};

/// What a point of a pair bore in the step before, where the pair has no such point now: a corner has slid to the next
/// support.
struct LostImpulse {
  std::uint32_t pair = 0;
  int point = 0;    ///< of the manifold before
  int moving = 0;   ///< body
  Vector3 p;        ///< on it, in its frame
  Vector3 n_W;      ///< from the support to it
  Vector3 impulse;  ///< N s, on it, W
};

/// Of one step. Threads that look at pairs add to it.
struct LostImpulses {
  std::mutex mutex;
  BoundedVector<LostImpulse> all;
};

/// Contacts of one plane that bear: [first, end) in SharedSupports::order and ::ascending.
struct PlaneOrder {
  std::size_t first = 0, end = 0;
};

/// Scratch of mark_covered_contacts().
struct SharedSupports {
  SharedSupports() = default;
  SharedSupports(std::size_t bodies, std::size_t patches, std::size_t contacts);

  std::vector<int> first;    ///< of each body: the first of its patches with fixed supports, or -1
  BoundedVector<int> next;   ///< of each patch: the next of the same body, or -1
  std::vector<int> touched;  ///< that have such patches
  std::vector<int> plane;    ///< patches of one plane
  std::vector<SupportPoint> points;
  std::vector<FaceLoad> loads;     ///< of each point, where faces bear on surfaces that run
  std::vector<int> contacts;       ///< of the plane
  std::vector<PlaneOrder> orders;  ///< of all planes whose corners bear; Patch::plane is an index
  std::vector<int> order;          ///< contacts, in the order in which one slab has them
  std::vector<int> ascending;      ///< the same, in their own order
};

}  // namespace snug::physics::internal
