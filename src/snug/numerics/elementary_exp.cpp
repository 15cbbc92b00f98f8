// Exponentials, logarithms and powers: tables of 64 and 93 entries with their errors, and short polynomials (Tang 1989,
// 1990).
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "snug/numerics/elementary.hpp"
#include "snug/numerics/internal/double_double.hpp"

namespace snug::numerics::elementary {
namespace {

using namespace internal;

constexpr double kLargestExponent = 709.79, kSmallestExponent = -745.14;

/// 2^exponent, a normal number.
double power_of_two(int exponent) { return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52U); }

/// A pair times 2^exponent, rounded once where the result is normal.
double scaled(Pair value, int exponent) {
  const double sum = value.high + value.low;
  if (exponent > 1000) return sum * power_of_two(exponent - 100) * power_of_two(100);
  if (exponent > -1000) return sum * power_of_two(exponent);
  return sum * power_of_two(exponent + 200) * power_of_two(-200);
}

/// e^(x.high + x.low) / 2^exponent, between 1 and 2 about. x within the range of exponents.
struct Exponential {
  Pair value;
  int exponent;
};
Exponential exponential(Pair x) {
  const double k = (x.high * kExpPerStep + kToInteger) - kToInteger;
  const double rest = x.high - k * kExpStepHigh;  // exact: k has 17 bits, the step 34
  const Pair r = two_sum(rest, x.low - k * kExpStepLow);
  const double low = r.low;
  const double p = r.high, p2 = p * p;
  const double series =
      p + (low + p2 * (0.5 + p * (1.0 / 6.0 + p * (1.0 / 24.0 + p * (1.0 / 120.0 + p * (1.0 / 720.0))))));
  const auto steps = static_cast<int>(k);
  const Pair& table = kExp2Table[static_cast<std::size_t>(steps & 63)];
  // The first term's product is kept whole: pow and expm1 need more than a number.
  const Pair first = two_product(table.high, p);
  const Pair sum = fast_two_sum(table.high, first.high);
  const double tail = sum.low + (first.low + (table.low + table.high * (series - p)) + table.low * p);
  return {fast_two_sum(sum.high, tail), (steps - (steps & 63)) / 64};
}

/// ln of a positive normal or subnormal number.
Pair logarithm(double x) {
  int exponent = 0;
  if (x < std::numeric_limits<double>::min()) {
    x *= 0x1p54;
    exponent = -54;
  }
  const auto bits = std::bit_cast<std::uint64_t>(x);
  exponent += static_cast<int>(bits >> 52U) - 1023;
  double m = std::bit_cast<double>((bits & 0x000fffffffffffffU) | 0x3ff0000000000000U);
  if (m > 1.4140625) {
    m *= 0.5;
    ++exponent;
  }
  const auto index = static_cast<std::size_t>(m * 128.0 + 0.5) - 90;
  const Pair product = two_product(m, kReciprocals[index]);
  const Pair r = fast_two_sum(product.high - 1.0, product.low);
  const double e = exponent;
  const Pair square = two_product(r.high, r.high);
  const double p = r.high;
  const double series =
      square.high * p *
      (1.0 / 3.0 + p * (-0.25 + p * (0.2 + p * (-1.0 / 6.0 + p * (1.0 / 7.0 + p * (-0.125 + p * (1.0 / 9.0)))))));
  const Pair large = two_sum(e * kLn2High, kLogTable[index].high);
  const Pair with_first = two_sum(large.high, r.high);
  const Pair with_second = two_sum(with_first.high, -0.5 * square.high);
  const double tail = ((series + (r.low - r.high * r.low)) - 0.5 * square.low) + (e * kLn2Low + kLogTable[index].low);
  return fast_two_sum(with_second.high, (large.low + with_first.low) + (with_second.low + tail));
}

bool is_odd(double y) {
  const double size = std::abs(y);
  return size < 0x1p53 && size == std::trunc(size) && (static_cast<std::int64_t>(size) & 1) == 1;
}

/// |x|^y for x neither 0 nor infinite nor 1, y neither.
double magnitude(double x, double y) {
  const Pair ln = logarithm(x);
  if (std::abs(y) > 0x1p66) return (ln.high > 0.0) == (y > 0.0) ? kInfinity : 0.0;
  const Pair product = two_product(y, ln.high);
  const Pair p = fast_two_sum(product.high, product.low + y * ln.low);
  if (p.high > kLargestExponent) return kInfinity;
  if (p.high < kSmallestExponent) return 0.0;
  const Exponential e = exponential(p);
  return scaled(e.value, e.exponent);
}

}  // namespace

double exp(double x) {
  if (!(x <= kLargestExponent)) return std::isnan(x) ? x : kInfinity;
  if (x < kSmallestExponent) return 0.0;
  const Exponential e = exponential({x, 0.0});
  return scaled(e.value, e.exponent);
}

double exp2(double x) {
  if (!(x < 1024.0)) return std::isnan(x) ? x : kInfinity;
  if (x < -1075.0) return 0.0;
  const double whole = (x + kToInteger) - kToInteger;
  constexpr Pair kLn2 = {0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56};
  const Exponential e = exponential(multiply({x - whole, 0.0}, kLn2));
  return scaled(e.value, e.exponent + static_cast<int>(whole));
}

double expm1(double x) {
  if (!(x <= kLargestExponent)) return std::isnan(x) ? x : kInfinity;
  if (x < -50.0) return -1.0;
  if (std::abs(x) < 0x1p-54) return x;
  if (std::abs(x) < 0.25) {
    double series = 0.0;
    for (int n = 15; n >= 3; --n) series = (series + 1.0) * (x / n);
    // x + x^2/2 (1 + series): two terms with their errors
    const Pair square = two_product(x, x);
    const Pair sum = fast_two_sum(x, 0.5 * square.high);
    return sum.high + (sum.low + (0.5 * square.low + 0.5 * square.high * series));
  }
  const Exponential e = exponential({x, 0.0});
  if (e.exponent > 60) return scaled(e.value, e.exponent);
  const double scale = power_of_two(e.exponent);
  const Pair sum = two_sum(e.value.high * scale, -1.0);
  return sum.high + (sum.low + e.value.low * scale);
}

double log(double x) {
  if (!(x > 0.0)) return x == 0.0 ? -kInfinity : kNan;
  if (x == kInfinity) return x;
  const Pair ln = logarithm(x);
  return ln.high + ln.low;
}

double log10(double x) {
  if (!(x > 0.0)) return x == 0.0 ? -kInfinity : kNan;
  if (x == kInfinity) return x;
  const Pair lg = multiply(logarithm(x), kPerLn10);
  return lg.high + lg.low;
}

double pow(double x, double y) {
  if (y == 0.0 || x == 1.0) return 1.0;
  if (std::isnan(x) || std::isnan(y)) return kNan;
  const double size = std::abs(x);
  if (std::isinf(y)) return size == 1.0 ? 1.0 : (size > 1.0) == (y > 0.0) ? kInfinity : 0.0;
  const bool is_negative = std::signbit(x) && is_odd(y);
  double result = 1.0;
  if (size == 0.0 || size == kInfinity) {
    result = (size == 0.0) == (y > 0.0) ? 0.0 : kInfinity;
  } else if (x < 0.0 && y != std::trunc(y)) {
    return kNan;
  } else if (size != 1.0) {
    result = magnitude(size, y);
  }
  return is_negative ? -result : result;
}

double cosh(double x) {
  const double size = std::abs(x);
  if (!(size <= 711.0)) return std::isnan(x) ? x : kInfinity;
  const Exponential e = exponential({size, 0.0});
  if (size > 40.0) return scaled(e.value, e.exponent - 1);
  const double scale = power_of_two(e.exponent);
  const Pair up = {e.value.high * scale, e.value.low * scale};
  const Pair sum = add(up, divide({1.0, 0.0}, up));
  return 0.5 * (sum.high + sum.low);
}

}  // namespace snug::numerics::elementary
