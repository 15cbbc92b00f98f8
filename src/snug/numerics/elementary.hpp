// Elementary functions with one fixed sequence of operations: the same bytes on every processor.
#pragma once

/// The system's library chooses by the processor which code runs, and the last bit differs. These use additions,
/// products, quotients and square roots of IEEE 754 alone, in an order that no setting of the compiler changes
/// (-ffp-contract=off, no -ffast-math). Errors, in units in the last place of results that are normal numbers, against
/// twice the digits: at most 0.54. Special values are those of C (annex F); errno is not set. docs/decisions/0071 says
/// why.
namespace snug::numerics::elementary {

[[nodiscard]] double exp(double x);
[[nodiscard]] double exp2(double x);
[[nodiscard]] double expm1(double x);
[[nodiscard]] double log(double x);
[[nodiscard]] double log10(double x);
[[nodiscard]] double pow(double x, double y);
[[nodiscard]] double cosh(double x);
[[nodiscard]] double sin(double x);
[[nodiscard]] double cos(double x);
[[nodiscard]] double tan(double x);
void sincos(double x, double& sine, double& cosine);
[[nodiscard]] double asin(double x);
[[nodiscard]] double acos(double x);
[[nodiscard]] double atan(double x);
[[nodiscard]] double atan2(double y, double x);
[[nodiscard]] double cbrt(double x);
[[nodiscard]] double hypot(double x, double y);

}  // namespace snug::numerics::elementary
