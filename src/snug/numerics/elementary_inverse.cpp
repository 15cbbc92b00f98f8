// Arcs and roots: angles from quotients of pairs, near a table of 65; roots by Newton's step in pairs.
#include <bit>
#include <cmath>
#include <cstdint>
#include <utility>

#include "snug/numerics/elementary.hpp"
#include "snug/numerics/internal/double_double.hpp"

namespace snug::numerics::internal {

Pair square_root(Pair a) {
  const double root = std::sqrt(a.high);
  if (root == 0.0) return {0.0, 0.0};
  const Pair square = two_product(root, root);
  return fast_two_sum(root, (((a.high - square.high) - square.low) + a.low) / (2.0 * root));
}

}  // namespace snug::numerics::internal

namespace snug::numerics::elementary {
namespace {

using namespace internal;

/// atan(y / x) for 0 < y <= x about, both far from over- and underflow.
Pair arc(Pair y, Pair x) {
  const auto index = static_cast<std::size_t>(y.high / x.high * 64.0 + 0.5);
  const double c = static_cast<double>(index) / 64.0;
  // tan(a - b) = (y - c x) / (x + c y). c has 7 bits: its products with both halves of x are exact.
  const double spread = 134217729.0 * x.high, x1 = spread - (spread - x.high), x2 = x.high - x1;
  const Pair above = two_sum(y.high - c * x1, -(c * x2));
  const Pair below = fast_two_sum(x.high, c * y.high);
  const Pair d = divide({above.high, above.low + (y.low - c * x.low)}, {below.high, below.low + x.low});
  const double z = d.high * d.high;
  const double rest = d.high * z * (-1.0 / 3.0 + z * (0.2 + z * (-1.0 / 7.0 + z * (1.0 / 9.0 - z / 11.0))));
  const Pair& table = kAtanTable[index];
  const Pair sum = two_sum(table.high, d.high);
  return fast_two_sum(sum.high, sum.low + (table.low + (d.low + rest)));
}

Pair subtract(Pair a, Pair b) { return add(a, {-b.high, -b.low}); }

/// The angle of (x, y), y >= 0, neither both 0 nor near the ends of the range.
Pair angle_of(Pair y, Pair x) {
  const bool is_left = x.high < 0.0;
  if (is_left) x = {-x.high, -x.low};
  const bool is_steep = y.high > x.high;
  Pair angle = is_steep ? arc(x, y) : arc(y, x);
  if (is_steep) angle = subtract(kHalfPi, angle);
  return is_left ? subtract(kPi, angle) : angle;
}

int exponent_of(double x) { return static_cast<int>(std::bit_cast<std::uint64_t>(x) >> 52U & 0x7ffU); }

double atan2_of_specials(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return kNan;
  const bool is_left = std::signbit(x);
  double angle = 0.0;
  if (std::isinf(y)) {
    angle = std::isinf(x) ? (is_left ? 0.75 : 0.25) * kPi.high : kHalfPi.high;
  } else if (y == 0.0 || std::isinf(x)) {
    angle = is_left ? kPi.high : 0.0;
  } else {
    angle = kHalfPi.high;  // x is 0
  }
  return std::copysign(angle, y);
}

}  // namespace

double atan2(double y, double x) {
  if (!std::isfinite(x) || !std::isfinite(y) || x == 0.0 || y == 0.0) return atan2_of_specials(y, x);
  double a = std::abs(y), b = std::abs(x);
  if (a < 0x1p-900 && b < 0x1p-900) {
    a *= 0x1p120;
    b *= 0x1p120;
  }
  if (a > 0x1p900 || b > 0x1p900) {
    a *= 0x1p-120;
    b *= 0x1p-120;
  }
  const int difference = exponent_of(a) - exponent_of(b);
  Pair angle;
  if (difference > 64) {
    angle = kHalfPi;
  } else if (difference < -64) {
    if (x > 0.0) return std::copysign(std::abs(y) / std::abs(x), y);
    angle = kPi;
  } else {
    if (a < 0x1p-900 || b < 0x1p-900) {  // one of them, the other near
      a *= 0x1p120;
      b *= 0x1p120;
    }
    angle = angle_of({a, 0.0}, {std::copysign(b, x), 0.0});
  }
  return std::copysign(angle.high + angle.low, y);
}

double atan(double x) {
  if (std::isnan(x)) return kNan;
  if (std::abs(x) < 0x1p-27) return x;
  return atan2(x, 1.0);
}

double asin(double x) {
  const double size = std::abs(x);
  if (!(size <= 1.0)) return kNan;
  if (size < 0x1p-27) return x;
  if (size == 1.0) return std::copysign(kHalfPi.high, x);
  const Pair square = two_product(size, size);
  const Pair angle = angle_of({size, 0.0}, square_root(subtract({1.0, 0.0}, square)));
  return std::copysign(angle.high + angle.low, x);
}

double acos(double x) {
  const double size = std::abs(x);
  if (!(size <= 1.0)) return kNan;
  if (x == 1.0) return 0.0;
  if (x == -1.0) return kPi.high;
  if (size < 0x1p-60) return kHalfPi.high;
  const Pair angle = angle_of(square_root(subtract({1.0, 0.0}, two_product(size, size))), {x, 0.0});
  return angle.high + angle.low;
}

double cbrt(double x) {
  if (x == 0.0 || !std::isfinite(x)) return x;
  double size = std::abs(x), scale = 1.0;
  if (size < 0x1p-900) {
    size *= 0x1p150;
    scale = 0x1p-50;
  }
  if (size > 0x1p900) {
    size *= 0x1p-150;
    scale = 0x1p50;
  }
  // A third of the exponent, then steps of Halley's: three times the digits each.
  double root = std::bit_cast<double>(std::bit_cast<std::uint64_t>(size) / 3 + 0x2a9f7893782da1ceU);
  for (int i = 0; i < 3; ++i) {
    const double cube = root * root * root;
    root *= (cube + 2.0 * size) / (2.0 * cube + size);
  }
  const Pair square = two_product(root, root);
  const Pair cube = two_product(square.high, root);
  const double rest = ((size - cube.high) - cube.low) - square.low * root;
  return std::copysign(scale * (root + rest / (3.0 * square.high)), x);
}

double hypot(double x, double y) {
  double a = std::abs(x), b = std::abs(y);
  if (std::isinf(a) || std::isinf(b)) return kInfinity;
  if (std::isnan(a) || std::isnan(b)) return kNan;
  if (a < b) std::swap(a, b);
  if (b == 0.0 || exponent_of(a) - exponent_of(b) > 60) return a + b;
  double scale = 1.0;
  if (a > 0x1p450) {
    a *= 0x1p-600;
    b *= 0x1p-600;
    scale = 0x1p600;
  }
  if (b < 0x1p-400) {
    a *= 0x1p600;
    b *= 0x1p600;
    scale = 0x1p-600;
  }
  const Pair root = square_root(add(two_product(a, a), two_product(b, b)));
  return scale * (root.high + root.low);
}

}  // namespace snug::numerics::elementary
