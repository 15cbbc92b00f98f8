// Elementary functions: errors against a wider format, special values, identities, and the same bytes from every
// compiler.
#include "snug/numerics/elementary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "snug/core/hash.hpp"
#include "snug/core/rng.hpp"

namespace snug::numerics {
namespace {

namespace own = elementary;
using Wide = long double;
constexpr double kInf = std::numeric_limits<double>::infinity(), kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kPi = 3.141592653589793;

/// |got - want| in units in the last place of what is wanted.
double error_of(double got, Wide want) {
  const auto near = static_cast<double>(want);
  if (got == near) return 0.0;  // also infinite; half a unit at most
  const double unit = std::nextafter(std::abs(near), kInf) - std::abs(near);
  return static_cast<double>(std::abs(static_cast<Wide>(got) - want) / unit);
}

double drawn(Rng& rng, double low, double high) { return low + (high - low) * rng.uniform(); }
/// Of either sign, its size even in the logarithm.
double spread(Rng& rng, double low, double high) {
  const double size = std::exp2(drawn(rng, low, high));
  return rng.uniform() < 0.5 ? -size : size;
}

struct Function {
  const char* name;
  std::function<double(double)> own;
  std::function<Wide(Wide)> wide;
  std::function<double(Rng&)> draw;
};

std::vector<Function> functions() {
  const auto even = [](double low, double high) { return [=](Rng& rng) { return drawn(rng, low, high); }; };
  const auto log_even = [](double low, double high) { return [=](Rng& rng) { return spread(rng, low, high); }; };
  const auto positive = [](double low, double high) {
    return [=](Rng& rng) { return std::abs(spread(rng, low, high)); };
  };
  return {{"exp", own::exp, expl, even(-700, 700)},
          {"exp of small", own::exp, expl, log_even(-60, 1)},
          {"exp2", own::exp2, exp2l, even(-1000, 1000)},
          {"expm1", own::expm1, expm1l, even(-3, 3)},
          {"expm1 of small", own::expm1, expm1l, log_even(-60, 0)},
          {"log", own::log, logl, positive(-1060, 1020)},
          {"log near 1", own::log, logl, even(0.7, 1.5)},
          {"log10", own::log10, log10l, positive(-1000, 1000)},
          {"cosh", own::cosh, coshl, even(-700, 700)},
          {"sin", own::sin, sinl, even(-7, 7)},
          {"cos", own::cos, cosl, even(-7, 7)},
          {"tan", own::tan, tanl, even(-7, 7)},
          {"sin of many turns", own::sin, sinl, even(-1.6e6, 1.6e6)},
          {"cos of very many turns", own::cos, cosl, log_even(20, 60)},
          {"sin of small", own::sin, sinl, log_even(-60, 0)},
          {"asin", own::asin, asinl, even(-1, 1)},
          {"acos", own::acos, acosl, even(-1, 1)},
          {"acos near 1", own::acos, acosl, [](Rng& rng) { return 1.0 - std::abs(spread(rng, -50, -3)); }},
          {"atan", own::atan, atanl, log_even(-60, 60)},
          {"cbrt", own::cbrt, cbrtl, log_even(-1060, 1020)}};
}

TEST(Elementary, ErrAtMostByWhatTheHeaderSays) {
  if (std::numeric_limits<Wide>::digits < 64) GTEST_SKIP() << "no wider format here";
  constexpr int kCount = 100'000;
  // 0.54, and what the wider functions err themselves: 1 unit of 64 digits is 1/2048 of ours.
  constexpr double kBound = 0.541;
  for (const Function& function : functions()) {
    SCOPED_TRACE(function.name);
    Rng rng = Rng(3).split(function.name);
    double worst = 0.0, at = 0.0;
    for (int i = 0; i < kCount; ++i) {
      const double x = function.draw(rng);
      const double error = error_of(function.own(x), function.wide(static_cast<Wide>(x)));
      if (error > worst) worst = error, at = x;
    }
    EXPECT_LE(worst, kBound) << "at " << at;
  }
  Rng rng = Rng(3).split("two");
  double power = 0.0, angle = 0.0, length = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double x = std::abs(spread(rng, -8, 8)), y = drawn(rng, -80, 80), z = spread(rng, -60, 60),
                 w = spread(rng, -60, 60);
    power = std::max(power, error_of(own::pow(x, y), powl(x, y)));
    angle = std::max(angle, error_of(own::atan2(z, w), atan2l(z, w)));
    length = std::max(length, error_of(own::hypot(z, w), hypotl(z, w)));
  }
  EXPECT_LE(power, kBound);
  EXPECT_LE(angle, kBound);
  EXPECT_LE(length, kBound);
}

void expect_same(double got, double want, const char* what) {
  if (std::isnan(want)) {
    EXPECT_TRUE(std::isnan(got)) << what << " " << got;
  } else {
    EXPECT_EQ(got, want) << what;
    EXPECT_EQ(std::signbit(got), std::signbit(want)) << what;
  }
}

TEST(Elementary, HaveTheSpecialValuesOfC) {
  const double values[] = {0.0,   -0.0,   1.0,    -1.0,    2.0,      -2.0,   3.0,    -3.0,          0.5,  -0.5,
                           1e308, -1e308, 5e-324, -5e-324, 2.3e-308, 1e-200, 0x1p53, -0x1p53 - 2.0, 1e22, 709.0,
                           710.0, -745.0, -746.0, kInf,    -kInf,    kNone,  1e300,  -1e-300};
  for (const double x : values) {
    SCOPED_TRACE(x);
    const auto is_exact = [](double y) { return y == 0.0 || !std::isfinite(y); };
    const auto check = [&](double got, double want, const char* what) {
      if (is_exact(want) || is_exact(got)) {
        expect_same(got, want, what);
      } else {
        EXPECT_LE(std::abs(got - want), std::abs(want) * 0x1p-52 + 5e-324) << what;
      }
    };
    check(own::exp(x), std::exp(x), "exp");
    check(own::exp2(x), std::exp2(x), "exp2");
    check(own::expm1(x), std::expm1(x), "expm1");
    check(own::log(x), std::log(x), "log");
    check(own::log10(x), std::log10(x), "log10");
    check(own::cosh(x), std::cosh(x), "cosh");
    check(own::sin(x), std::sin(x), "sin");
    check(own::cos(x), std::cos(x), "cos");
    check(own::tan(x), std::tan(x), "tan");
    check(own::asin(x), std::asin(x), "asin");
    check(own::acos(x), std::acos(x), "acos");
    check(own::atan(x), std::atan(x), "atan");
    check(own::cbrt(x), std::cbrt(x), "cbrt");
    for (const double y : values) {
      SCOPED_TRACE(y);
      check(own::pow(x, y), std::pow(x, y), "pow");
      check(own::atan2(x, y), std::atan2(x, y), "atan2");
      check(own::hypot(x, y), std::hypot(x, y), "hypot");
    }
  }
}

TEST(Elementary, AreExactWhereTheResultIsANumber) {
  for (int i = -20; i <= 20; ++i) {
    if (i >= 0) {
      EXPECT_EQ(own::log10(static_cast<double>(std::pow(Wide{10.0}, i))), i);
    }
    EXPECT_EQ(own::cbrt(static_cast<double>(i) * i * i), i);
    EXPECT_EQ(own::pow(i, 3), static_cast<double>(i) * i * i);
    EXPECT_EQ(own::exp2(i), std::ldexp(1.0, i));
    EXPECT_EQ(own::hypot(3.0 * i, 4.0 * i), 5.0 * std::abs(i));
    EXPECT_EQ(own::sin(-0.1 * i), -own::sin(0.1 * i));
    EXPECT_EQ(own::cos(-0.1 * i), own::cos(0.1 * i));
  }
  EXPECT_EQ(own::atan2(0.0, -1.0), kPi);
  EXPECT_EQ(own::acos(0.0), 0.5 * kPi);
  EXPECT_EQ(own::sin(kPi), 1.2246467991473532e-16);
}

// The bytes are what is promised: of every compiler, setting and processor. A change of the functions changes this
// number.
TEST(Elementary, GiveTheSameBytesEverywhere) {
  Hash hash;
  for (const Function& function : functions()) {
    // Not drawn by Rng, whose distributions use such functions: numbers of a plain generator.
    std::uint64_t state = 88172645463325252ULL;
    for (int i = 0; i < 20'000; ++i) {
      state ^= state << 13U;
      state ^= state >> 7U;
      state ^= state << 17U;
      const double unit = static_cast<double>(state >> 11U) * 0x1p-53;
      hash.add(function.own(2.0 * unit - 1.0));
      hash.add(function.own(std::ldexp(unit + 0.5, static_cast<int>(state % 40) - 20)));
    }
  }
  for (int i = 1; i < 20'000; ++i) {
    hash.add(own::pow(0.001 * i, 0.37 * (i % 91 - 45)));
    hash.add(own::atan2(0.01 * i - 100.0, 1.0 + i % 13));
    hash.add(own::hypot(0.01 * i - 100.0, 1.0 + i % 13));
  }
  EXPECT_EQ(hash.value(), 5711758154280404711U);
}

}  // namespace
}  // namespace snug::numerics
