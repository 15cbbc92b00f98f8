// The names of C's library for the elementary functions: a program that is linked with this file uses them everywhere,
// also in the libraries that it loads, and its results do not depend on which code the system's library picks for the
// processor.
//
// Not part of any library: a program of somebody else that links snug's modules keeps its own functions.
#include "snug/numerics/elementary.hpp"

// What <cmath> declares is not included: these are the functions themselves.
namespace elementary = snug::numerics::elementary;

extern "C" {

[[gnu::visibility("default")]] double exp(double x) noexcept { return elementary::exp(x); }
[[gnu::visibility("default")]] double exp2(double x) noexcept { return elementary::exp2(x); }
[[gnu::visibility("default")]] double expm1(double x) noexcept { return elementary::expm1(x); }
[[gnu::visibility("default")]] double log(double x) noexcept { return elementary::log(x); }
[[gnu::visibility("default")]] double log10(double x) noexcept { return elementary::log10(x); }
[[gnu::visibility("default")]] double pow(double x, double y) noexcept { return elementary::pow(x, y); }
[[gnu::visibility("default")]] double cosh(double x) noexcept { return elementary::cosh(x); }
[[gnu::visibility("default")]] double sin(double x) noexcept { return elementary::sin(x); }
[[gnu::visibility("default")]] double cos(double x) noexcept { return elementary::cos(x); }
[[gnu::visibility("default")]] double tan(double x) noexcept { return elementary::tan(x); }
[[gnu::visibility("default")]] void sincos(double x, double* sine, double* cosine) noexcept {
  elementary::sincos(x, *sine, *cosine);
}
[[gnu::visibility("default")]] double asin(double x) noexcept { return elementary::asin(x); }
[[gnu::visibility("default")]] double acos(double x) noexcept { return elementary::acos(x); }
[[gnu::visibility("default")]] double atan(double x) noexcept { return elementary::atan(x); }
[[gnu::visibility("default")]] double atan2(double y, double x) noexcept { return elementary::atan2(y, x); }
[[gnu::visibility("default")]] double cbrt(double x) noexcept { return elementary::cbrt(x); }
[[gnu::visibility("default")]] double hypot(double x, double y) noexcept { return elementary::hypot(x, y); }
/// Rounded once more: right in all but one of a hundred million cases, and the same everywhere.
[[gnu::visibility("default")]] float expf(float x) noexcept {
  return static_cast<float>(elementary::exp(static_cast<double>(x)));
}

}  // extern "C"
