#!/usr/bin/env python3
"""make_elementary_tables.py: writes src/snug/numerics/internal/elementary_tables.hpp, the constants of the elementary functions, with mpmath.

Usage: python3 tools/make_elementary_tables.py > src/snug/numerics/internal/elementary_tables.hpp
"""
from mpmath import mp, mpf, log, pi, atan, sin, cos, floor, nint

mp.prec = 1400


def chop(value, bits):
    """The nearest number of so many significant bits."""
    if value == 0:
        return mpf(0)
    exponent = int(floor(log(abs(value), 2)))
    scale = mpf(2) ** (bits - 1 - exponent)
    return nint(value * scale) / scale


def text(value):
    return float(value).hex()


def pair(value):
    high = chop(value, 53)
    return f"{{{text(high)}, {text(chop(value - high, 53))}}}"


def table(name, about, values):
    rows = "".join(f"    {value},\n" for value in values)
    print(f"/// {about}\ninline constexpr std::array<Pair, {len(values)}> {name} = {{{{\n{rows}}}}};\n")


print("""// Constants of the elementary functions, to more digits than a number holds. Written by tools/make_elementary_tables.py.
// clang-format off
#pragma once

#include <array>
#include <cstdint>

namespace snug::numerics::internal {

/// high + low, low at most half a unit in the last place of high.
struct Pair {
  double high, low;
};
""")
ln2 = log(mpf(2))
step = ln2 / 64
high = chop(step, 34)
print(f"inline constexpr double kExpStepHigh = {text(high)}, kExpStepLow = {text(step - high)};  // ln(2) / 64; the first has 34 bits")
print(f"inline constexpr double kExpPerStep = {text(64 / ln2)};")
high = chop(ln2, 40)
print(f"inline constexpr double kLn2High = {text(high)}, kLn2Low = {text(ln2 - high)};  // the first has 40 bits")
parts, rest = [], pi / 2
for _ in range(3):
    part = chop(rest, 33)
    parts.append(part)
    rest -= part
parts.append(rest)
print(f"inline constexpr std::array<double, 4> kHalfPiParts = {{{', '.join(text(part) for part in parts)}}};  // 33 bits each but the last")
print(f"inline constexpr double kPerHalfPi = {text(2 / pi)};")
print(f"inline constexpr Pair kHalfPi = {pair(pi / 2)}, kPi = {pair(pi)}, kPerLn10 = {pair(1 / log(mpf(10)))};\n")
table("kExp2Table", "2^(i/64)", [pair(mpf(2) ** (mpf(i) / 64)) for i in range(64)])
reciprocals = [chop(mpf(128) / i, 10) if i != 128 else mpf(1) for i in range(90, 183)]
print(f"/// Of 10 bits, near 128/i from i = 90\ninline constexpr std::array<double, {len(reciprocals)}> kReciprocals = {{{{\n" +
      "".join(f"    {text(value)},\n" for value in reciprocals) + "}};\n")
table("kLogTable", "-ln of kReciprocals", [pair(-log(value)) for value in reciprocals])
table("kSinTable", "sin(i/32)", [pair(sin(mpf(i) / 32)) for i in range(27)])
table("kCosTable", "cos(i/32)", [pair(cos(mpf(i) / 32)) for i in range(27)])
table("kAtanTable", "atan(i/64)", [pair(atan(mpf(i) / 64)) for i in range(65)])
bits, words = int(floor(2 / pi * mpf(2) ** 1280)), []
for _ in range(20):
    words.insert(0, bits & (2 ** 64 - 1))
    bits >>= 64
print("/// Binary digits of 2/pi behind the point, 64 in each\ninline constexpr std::array<std::uint64_t, 20> kTwoPerPi = {{\n" +
      "".join(f"    0x{word:016x}U,\n" for word in words) + "}};\n")
print("}  // namespace snug::numerics::internal")
