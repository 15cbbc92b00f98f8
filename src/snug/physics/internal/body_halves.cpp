// BodyHalves: slabs across the longest way, the cut between two of them.
#include "snug/physics/internal/body_halves.hpp"

#include <algorithm>

namespace snug::physics::internal {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

BodyHalves::BodyHalves(std::size_t bodies) : slab_(bodies) {}

BodyHalves::Part BodyHalves::of(int ia, int ib) const {
  const Part a = of(ia >= 0 ? ia : ib);
  return a == of(ib >= 0 ? ib : ia) ? a : Seam;
}

void BodyHalves::begin(std::span<const int> bodies, const Vector3* centres) {
  Vector3 least = centres[bodies.front()], most = least;
  for (const int body : bodies) {
    least = least.cwiseMin(centres[body]);
    most = most.cwiseMax(centres[body]);
  }
  int axis = 0;
  const double length = (most - least).maxCoeff(&axis);
  const double to_slab = length > 0.0 ? kSlabs / length : 0.0;
  for (const int body : bodies) {
    const auto slab = static_cast<int>(to_slab * (centres[body][axis] - least[axis]));
    slab_[at(body)] = static_cast<std::uint8_t>(std::min(slab, kSlabs - 1));
  }
  first_.fill(0), second_.fill(0);
}

void BodyHalves::add(int ia, int ib, int rows) {
  const int a = slab_[at(ia >= 0 ? ia : ib)], b = slab_[at(ib >= 0 ? ib : ia)];
  first_[at(std::max(a, b) + 1)] += rows;
  second_[at(std::min(a, b))] += rows;
}

void BodyHalves::cut() {
  for (int i = 0; i < kSlabs; ++i) {
    first_[at(i + 1)] += first_[at(i)];
    second_[at(kSlabs - 1 - i)] += second_[at(kSlabs - i)];
  }
  const auto longest = [this](int i) { return first_.back() - std::min(first_[at(i)], second_[at(i)]); };
  cut_ = 0;
  for (int i = 1; i <= kSlabs; ++i) {
    if (longest(i) < longest(cut_)) cut_ = i;
  }
}

}  // namespace snug::physics::internal
