// Rng: the only source of randomness; splittable by name, the same on every machine.
#pragma once

#include <cstdint>
#include <string_view>

namespace snug {

/// SplitMix64 generator (Steele, Lea, Flood 2014). Copyable; equal seeds give equal sequences on every platform.
class Rng {
 public:
  explicit Rng(std::uint64_t seed) : state_(seed) {}

  /// An independent generator for one part of the program; does not advance this one.
  [[nodiscard]] Rng split(std::string_view name) const;

  /// Uniform over all 64-bit values.
  std::uint64_t next();
  /// Uniform in [0, 1), 53 bits.
  double uniform();
  /// Uniform in [low, high).
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Uniform in 0 .. count-1; count > 0.
  int index(int count) { return static_cast<int>(next() % static_cast<std::uint64_t>(count)); }
  /// Standard normal (Box-Muller, both draws used at once).
  double normal();

  bool operator==(const Rng&) const = default;

 private:
  std::uint64_t state_;
};

}  // namespace snug
