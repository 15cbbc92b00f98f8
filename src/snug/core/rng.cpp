// Rng: the only source of randomness; splittable by name, the same on every machine.
#include "snug/core/rng.hpp"

#include <cmath>
#include <numbers>

#include "snug/core/hash.hpp"

namespace snug {

Rng Rng::split(std::string_view name) const {
  Hash hash;
  hash.add(state_);
  hash.add(name);
  return Rng(hash.value());
}

std::uint64_t Rng::next() {
  state_ += 0x9e3779b97f4a7c15ULL;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

double Rng::uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }

double Rng::normal() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * uniform());
}

}  // namespace snug
