// DoubleDouble: sums and products with their rounding errors (Dekker 1971), without fused multiply-add: the same steps
// on every processor. Internal to the module.
#pragma once

#include <limits>

#include "snug/numerics/internal/elementary_tables.hpp"

namespace snug::numerics::internal {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kToInteger =
    6755399441055744.0;  // 1.5 * 2^52: what is added to it is rounded to a whole number

inline Pair fast_two_sum(double a, double b) {  // |a| >= |b|
  const double sum = a + b;
  return {sum, b - (sum - a)};
}

inline Pair two_sum(double a, double b) {
  const double sum = a + b, part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}

/// Exact unless a or b is above 2^970 or the error underflows.
inline Pair two_product(double a, double b) {
  constexpr double kSplit = 134217729.0;  // 2^27 + 1
  const double ca = kSplit * a, cb = kSplit * b;
  const double a1 = ca - (ca - a), b1 = cb - (cb - b), a2 = a - a1, b2 = b - b1;
  const double product = a * b;
  return {product, ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2};
}

inline Pair multiply(Pair a, Pair b) {
  const Pair product = two_product(a.high, b.high);
  return fast_two_sum(product.high, product.low + (a.high * b.low + a.low * b.high));
}

inline Pair add(Pair a, Pair b) {
  const Pair sum = two_sum(a.high, b.high);
  return fast_two_sum(sum.high, sum.low + (a.low + b.low));
}

inline Pair divide(Pair a, Pair b) {
  const double quotient = a.high / b.high;
  const Pair product = two_product(quotient, b.high);
  const double rest = ((a.high - product.high) - product.low) + (a.low - quotient * b.low);
  return fast_two_sum(quotient, rest / b.high);
}

/// Of a number that is not negative; the root of 0 is 0.
Pair square_root(Pair a);

}  // namespace snug::numerics::internal
