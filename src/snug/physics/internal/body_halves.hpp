// BodyHalves: cuts bodies in two by a plane, with few contacts between the halves.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "snug/spatial/pose.hpp"

namespace snug::physics::internal {

/// The plane stands across the longest way of the centres of the bodies. What has bodies on both sides is the seam. All
/// of it depends on the bodies and what lies between them alone. Never allocates after construction.
class BodyHalves {
 public:
  enum Part : std::int8_t { First, Second, Seam };

  explicit BodyHalves(std::size_t bodies);

  /// Active bodies, and the centres of all by active index, m, W.
  void begin(std::span<const int> bodies, const Vector3* centres);
  /// Rows between two of these bodies; -1: one that does not move.
  void add(int ia, int ib, int rows);
  /// The cut that leaves the least work to whoever has the larger half, then the seam.
  void cut();
  [[nodiscard]] Part of(int body) const { return slab_[static_cast<std::size_t>(body)] < cut_ ? First : Second; }
  /// Of what lies between two bodies, of which one may be -1.
  [[nodiscard]] Part of(int ia, int ib) const;

 private:
  static constexpr int kSlabs = 128;  ///< between which the cut may be

  std::vector<std::uint8_t> slab_;        ///< of each active body
  std::array<int, kSlabs + 1> first_{};   ///< rows that are in the first half from this cut on
  std::array<int, kSlabs + 1> second_{};  ///< rows that are in the second half up to this cut
  int cut_ = 0;                           ///< first slab of the second half
};

}  // namespace snug::physics::internal
