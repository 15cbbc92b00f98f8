// Sine, cosine, tangent: the angle less whole quarter turns, then polynomials near 0 and a table of 27 entries beyond.
#include <bit>
#include <cmath>
#include <cstdint>

#include "snug/numerics/elementary.hpp"
#include "snug/numerics/internal/double_double.hpp"

namespace snug::numerics::elementary {
namespace {

using namespace internal;

constexpr double kQuarterPi = 0.78539816339744828;
constexpr double kLargeAngle = 1.6e6;  // quarter turns have 20 bits below

/// An angle of at most pi/4 and a bit, and the quarter turns that were taken off.
struct Reduced {
  Pair angle;
  unsigned quarter = 0;
};

__extension__ typedef unsigned __int128 Wide;  // NOLINT(modernize-use-using): only a typedef takes the mark

/// 64 binary digits of 2/pi from a place behind the point on, which may lie before it.
std::uint64_t digits_from(int place) {
  const auto word = [](int index) {
    return index >= 0 && index < 20 ? kTwoPerPi[static_cast<std::size_t>(index)] : 0U;
  };
  const int index = place >= 0 ? place / 64 : -1, shift = place - 64 * index;
  return word(index) << shift | (shift > 0 ? word(index + 1) >> (64 - shift) : 0U);
}

double as_double(std::uint64_t bits) { return static_cast<double>(bits); }

/// Payne and Hanek 1983: of x 2/pi only the binary digits that count: those of less than four quarter turns.
Reduced reduce_large(double x) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  const std::uint64_t mantissa = (bits & 0x000fffffffffffffU) | 0x0010000000000000U;
  const int exponent = static_cast<int>(bits >> 52U & 0x7ffU) - 1075;  // |x| = mantissa 2^exponent
  const int place = exponent - 2;
  const Wide last = static_cast<Wide>(mantissa) * digits_from(place + 128);
  const Wide middle = static_cast<Wide>(mantissa) * digits_from(place + 64) + (last >> 64U);
  const std::uint64_t first = mantissa * digits_from(place) + static_cast<std::uint64_t>(middle >> 64U);
  // 2 bits of quarter turns, 126 and 64 of the fraction of one.
  auto quarter = static_cast<unsigned>(first >> 62U);
  Wide fraction = static_cast<Wide>(first & 0x3fffffffffffffffU) << 64U | static_cast<std::uint64_t>(middle);
  auto tail = static_cast<std::uint64_t>(last);
  const bool is_above = (first >> 61U & 1U) != 0;
  if (is_above) {  // nearer to the next one
    ++quarter;
    fraction = (static_cast<Wide>(1) << 126U) - fraction - (tail != 0 ? 1U : 0U);
    tail = ~tail + 1U;
  }
  // In words of 64 bits: of the same shifts of 128 bits gcc 14 makes wrong code (-O2, x86-64).
  constexpr std::uint64_t kMantissa = (std::uint64_t{1} << 53U) - 1;
  const auto high = static_cast<std::uint64_t>(fraction >> 64U), low = static_cast<std::uint64_t>(fraction);
  const Pair upper =
      two_sum(as_double(high >> 9U) * 0x1p-53, as_double((high << 44U | low >> 20U) & kMantissa) * 0x1p-106);
  const double lower = as_double(low & 0xfffffU) * 0x1p-126 + as_double(tail) * 0x1p-190;
  Pair angle = multiply(fast_two_sum(upper.high, upper.low + lower), kHalfPi);
  if (is_above != (x < 0.0)) angle = {-angle.high, -angle.low};
  return {angle, (x < 0.0 ? 4U - (quarter & 3U) : quarter) & 3U};
}

Reduced reduce(double x) {
  if (std::abs(x) <= kQuarterPi) return {{x, 0.0}, 0};
  if (std::abs(x) > kLargeAngle) return reduce_large(x);
  const double n = (x * kPerHalfPi + kToInteger) - kToInteger;
  // Products of 20 and 33 bits are exact; what cancels is the high part alone.
  const Pair first = two_sum(x - n * kHalfPiParts[0], -n * kHalfPiParts[1]);
  const Pair second = two_sum(first.high, -n * kHalfPiParts[2]);
  const double low = (first.low + second.low) - n * kHalfPiParts[3];
  return {two_sum(second.high, low), static_cast<unsigned>(static_cast<std::int64_t>(n)) & 3U};
}

/// sin(x) - x, and cos(x) - 1 + x^2/2.
double sin_rest(double x) {
  const double z = x * x;
  return x * z *
         (-1.0 / 6.0 + z * (1.0 / 120.0 + z * (-1.0 / 5040.0 + z * (1.0 / 362880.0 + z * (-1.0 / 39916800.0 +
                                                                                          z * (1.0 / 6227020800.0))))));
}
double cos_rest(double x) {
  const double z = x * x;
  return z * z *
         (1.0 / 24.0 + z * (-1.0 / 720.0 + z * (1.0 / 40320.0 + z * (-1.0 / 3628800.0 + z * (1.0 / 479001600.0)))));
}

constexpr double kSmall = 0.2734375;  // 8.75 / 32: beyond, the table, and b is at most 1/64
double sin_rest_of_small(double b) {
  const double z = b * b;
  return b * z * (-1.0 / 6.0 + z * (1.0 / 120.0 + z * (-1.0 / 5040.0)));
}
double cos_less_one_of_small(double b) {
  const double z = b * b;
  return z * (-0.5 + z * (1.0 / 24.0 + z * (-1.0 / 720.0 + z * (1.0 / 40320.0))));
}

struct Split {
  std::size_t index;
  Pair rest;
  bool is_negative;
};
Split split(Pair angle) {
  const bool is_negative = angle.high < 0.0;
  if (is_negative) angle = {-angle.high, -angle.low};
  const auto index = static_cast<std::size_t>(angle.high * 32.0 + 0.5);
  return {index, fast_two_sum(angle.high - static_cast<double>(index) / 32.0, angle.low), is_negative};
}

/// main cos(b) + other sin(b): angles of the table and the rest. `other` b is at most a 17th of `main`.
Pair combine(Pair main, Pair other, Pair rest) {
  const double b = rest.high;
  const Pair sum = fast_two_sum(main.high, other.high * b);
  const double small = main.high * cos_less_one_of_small(b) + other.high * (rest.low + sin_rest_of_small(b));
  return {sum.high, sum.low + (main.low + (other.low * b + small))};
}

/// High and low part of the sine; the low part need not be below half a unit of the high one.
Pair sine(Pair angle) {
  const double x = angle.high;
  if (std::abs(x) < kSmall) return {x, angle.low * (1.0 - 0.5 * x * x) + sin_rest(x)};
  const Split s = split(angle);
  const Pair result = combine(kSinTable[s.index], kCosTable[s.index], s.rest);
  return s.is_negative ? Pair{-result.high, -result.low} : result;
}

Pair cosine(Pair angle) {
  const double x = angle.high;
  if (std::abs(x) < kSmall) {
    const Pair square = two_product(x, x);
    const Pair sum = fast_two_sum(1.0, -0.5 * square.high);
    return {sum.high, sum.low + (cos_rest(x) - 0.5 * square.low - x * angle.low)};
  }
  const Split s = split(angle);
  const Pair& other = kSinTable[s.index];
  return combine(kCosTable[s.index], {-other.high, -other.low}, s.rest);
}

double rounded(Pair value) { return value.high + value.low; }
Pair negative(Pair value) { return {-value.high, -value.low}; }

Pair sine_of(const Reduced& r) {
  const Pair value = (r.quarter & 1U) != 0 ? cosine(r.angle) : sine(r.angle);
  return (r.quarter & 2U) != 0 ? negative(value) : value;
}
Pair cosine_of(const Reduced& r) {
  const Pair value = (r.quarter & 1U) != 0 ? sine(r.angle) : cosine(r.angle);
  return r.quarter == 1U || r.quarter == 2U ? negative(value) : value;
}

bool is_tiny(double x) { return std::abs(x) < 0x1p-27; }

}  // namespace

double sin(double x) {
  if (!std::isfinite(x)) return kNan;
  if (is_tiny(x)) return x;
  return rounded(sine_of(reduce(x)));
}

double cos(double x) {
  if (!std::isfinite(x)) return kNan;
  return rounded(cosine_of(reduce(x)));
}

void sincos(double x, double& sine_out, double& cosine_out) {
  sine_out = sin(x);
  cosine_out = cos(x);
}

double tan(double x) {
  if (!std::isfinite(x)) return kNan;
  if (is_tiny(x)) return x;
  const Reduced r = reduce(x);
  const Pair s = sine_of(r), c = cosine_of(r);
  return rounded(divide(fast_two_sum(s.high, s.low), fast_two_sum(c.high, c.low)));
}

}  // namespace snug::numerics::elementary
