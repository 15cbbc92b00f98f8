// Sobol points by the recurrence of Bratley and Fox (ACM Algorithm 659).
#include "snug/study/sobol.hpp"

#include <array>

#include "snug/core/check.hpp"

namespace snug::study {
namespace {

constexpr int kBits = 32;

/// A primitive polynomial over GF(2): its degree, its inner coefficients as bits, and the first odd numbers m.
struct Polynomial {
  int degree;
  std::uint32_t coefficients;
  std::array<std::uint32_t, 7> m;
};

/// Dimensions 2 .. 21 of Joe and Kuo's table new-joe-kuo-6 (2008).
constexpr std::array<Polynomial, kMostSobolDimensions - 1> kPolynomials = {{
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
    {5, 14, {1, 3, 5, 5, 31}},
    {6, 1, {1, 3, 3, 9, 7, 49}},
    {6, 13, {1, 1, 1, 15, 21, 21}},
    {6, 16, {1, 3, 1, 13, 27, 49}},
    {6, 19, {1, 1, 1, 15, 7, 5}},
    {6, 22, {1, 3, 1, 15, 13, 25}},
    {6, 25, {1, 1, 5, 5, 19, 61}},
    {7, 1, {1, 3, 7, 11, 23, 15, 103}},
    {7, 4, {1, 3, 7, 13, 13, 15, 69}},
}};

using Directions = std::array<std::uint32_t, kBits>;

Directions directions_of(int dimension) {
  Directions v{};
  if (dimension == 0) {  // van der Corput
    for (int k = 0; k < kBits; ++k) v[static_cast<std::size_t>(k)] = 1U << (kBits - 1 - k);
    return v;
  }
  const Polynomial& p = kPolynomials[static_cast<std::size_t>(dimension - 1)];
  for (int k = 0; k < kBits; ++k) {
    const auto at = static_cast<std::size_t>(k);
    if (k < p.degree) {
      v[at] = p.m[at] << (kBits - 1 - k);
      continue;
    }
    const auto s = static_cast<std::size_t>(p.degree);
    v[at] = v[at - s] ^ (v[at - s] >> p.degree);
    for (int i = 1; i < p.degree; ++i) {
      if (((p.coefficients >> (p.degree - 1 - i)) & 1U) != 0) v[at] ^= v[at - static_cast<std::size_t>(i)];
    }
  }
  return v;
}

}  // namespace

double sobol(std::uint32_t index, int dimension, std::uint32_t shift) {
  SNUG_CHECK(dimension >= 0 && dimension < kMostSobolDimensions, "a dimension that the table has");
  const Directions v = directions_of(dimension);
  std::uint32_t x = shift;
  for (std::size_t k = 0; index != 0; ++k, index >>= 1U) {
    if ((index & 1U) != 0) x ^= v[k];
  }
  return static_cast<double>(x) / 4294967296.0;
}

}  // namespace snug::study
