// Lanes: sixteen numbers in single precision that go through the same instructions, as one vector or as several.
#pragma once

#include <cstdint>
#include <cstring>
#ifdef __AVX512DQ__
#include <immintrin.h>
#endif

namespace snug::physics::internal {

#define SNUG_INLINE __attribute__((always_inline)) inline

using Lanes4 = float __attribute__((vector_size(16)));
using Lanes8 = float __attribute__((vector_size(32)));
using Lanes16 = float __attribute__((vector_size(64)));

/// Twice as many lanes: each operation on both halves before the next, so that neither waits for the other.
template <class T>
struct Two {
  T low, high;
};

/// How a type holds its lanes: here, in one vector.
template <class T>
struct LaneTraits {
  static constexpr int width = sizeof(T) / sizeof(float);
  static SNUG_INLINE T load(const float* from) {
    T x;
    std::memcpy(&x, from, sizeof(T));
    return x;
  }
  static SNUG_INLINE void store(T x, float* to) { std::memcpy(to, &x, sizeof(T)); }
  static SNUG_INLINE T all(float x) { return T{} + x; }
};
template <class T>
struct LaneTraits<Two<T>> {
  static constexpr int width = 2 * LaneTraits<T>::width;
  static SNUG_INLINE Two<T> load(const float* from) {
    return {LaneTraits<T>::load(from), LaneTraits<T>::load(from + width / 2)};
  }
  static SNUG_INLINE void store(Two<T> x, float* to) {
    LaneTraits<T>::store(x.low, to);
    LaneTraits<T>::store(x.high, to + width / 2);
  }
  static SNUG_INLINE Two<T> all(float x) { return {LaneTraits<T>::all(x), LaneTraits<T>::all(x)}; }
};

template <class T>
SNUG_INLINE T load(const float* from) {
  return LaneTraits<T>::load(from);
}
template <class T>
SNUG_INLINE void store(T x, float* to) {
  LaneTraits<T>::store(x, to);
}
template <class T>
SNUG_INLINE T all(float x) {
  return LaneTraits<T>::all(x);
}

template <class T>
SNUG_INLINE Two<T> operator+(Two<T> x, Two<T> y) {
  return {x.low + y.low, x.high + y.high};
}
template <class T>
SNUG_INLINE Two<T> operator-(Two<T> x, Two<T> y) {
  return {x.low - y.low, x.high - y.high};
}
template <class T>
SNUG_INLINE Two<T> operator*(Two<T> x, Two<T> y) {
  return {x.low * y.low, x.high * y.high};
}
template <class T>
SNUG_INLINE Two<T> operator/(Two<T> x, Two<T> y) {
  return {x.low / y.low, x.high / y.high};
}
/// Masks of x >= y.
template <class T>
SNUG_INLINE auto at_least(T x, T y) {
  return x >= y;
}
template <class T>
SNUG_INLINE auto at_least(Two<T> x, Two<T> y) {
  return Two<decltype(at_least(x.low, y.low))>{at_least(x.low, y.low), at_least(x.high, y.high)};
}
/// x where the mask holds, else y.
template <class M, class T>
SNUG_INLINE T choose(M mask, T x, T y) {
  return mask ? x : y;
}
template <class M, class T>
SNUG_INLINE Two<T> choose(Two<M> mask, Two<T> x, Two<T> y) {
  return {choose(mask.low, x.low, y.low), choose(mask.high, x.high, y.high)};
}
template <class T>
SNUG_INLINE T larger(T x, T y) {
  return x > y ? x : y;
}
template <class T>
SNUG_INLINE Two<T> larger(Two<T> x, Two<T> y) {
  return {larger(x.low, y.low), larger(x.high, y.high)};
}
template <class T>
SNUG_INLINE T absolute(T x) {
  return larger(x, all<T>(0.0F) - x);
}

/// Exact to the last bit by any instruction. (Arrays: so the compiler finds that it has one for all.)
template <class T>
SNUG_INLINE T root(T x) {
  constexpr int width = LaneTraits<T>::width;
  float of[width], roots[width];
  store(x, of);
  for (int i = 0; i < width; ++i) roots[i] = __builtin_sqrtf(of[i]);
  return load<T>(roots);
}
template <class T>
SNUG_INLINE Two<T> root(Two<T> x) {
  return {root(x.low), root(x.high)};
}
/// r[k][i] to r[i][k] of four, in each quarter of wider vectors.
SNUG_INLINE void transpose_fours(Lanes4& r0, Lanes4& r1, Lanes4& r2, Lanes4& r3) {
  const Lanes4 s0 = __builtin_shufflevector(r0, r1, 0, 4, 1, 5), s1 = __builtin_shufflevector(r0, r1, 2, 6, 3, 7);
  const Lanes4 s2 = __builtin_shufflevector(r2, r3, 0, 4, 1, 5), s3 = __builtin_shufflevector(r2, r3, 2, 6, 3, 7);
  r0 = __builtin_shufflevector(s0, s2, 0, 1, 4, 5), r1 = __builtin_shufflevector(s0, s2, 2, 3, 6, 7);
  r2 = __builtin_shufflevector(s1, s3, 0, 1, 4, 5), r3 = __builtin_shufflevector(s1, s3, 2, 3, 6, 7);
}
SNUG_INLINE void transpose_fours(Lanes8& r0, Lanes8& r1, Lanes8& r2, Lanes8& r3) {
  const Lanes8 s0 = __builtin_shufflevector(r0, r1, 0, 8, 1, 9, 4, 12, 5, 13);
  const Lanes8 s1 = __builtin_shufflevector(r0, r1, 2, 10, 3, 11, 6, 14, 7, 15);
  const Lanes8 s2 = __builtin_shufflevector(r2, r3, 0, 8, 1, 9, 4, 12, 5, 13);
  const Lanes8 s3 = __builtin_shufflevector(r2, r3, 2, 10, 3, 11, 6, 14, 7, 15);
  r0 = __builtin_shufflevector(s0, s2, 0, 1, 8, 9, 4, 5, 12, 13);
  r1 = __builtin_shufflevector(s0, s2, 2, 3, 10, 11, 6, 7, 14, 15);
  r2 = __builtin_shufflevector(s1, s3, 0, 1, 8, 9, 4, 5, 12, 13);
  r3 = __builtin_shufflevector(s1, s3, 2, 3, 10, 11, 6, 7, 14, 15);
}
#ifdef __AVX512DQ__
SNUG_INLINE void transpose_fours(Lanes16& r0, Lanes16& r1, Lanes16& r2, Lanes16& r3) {
  const Lanes16 s0 = _mm512_unpacklo_ps(r0, r1), s1 = _mm512_unpackhi_ps(r0, r1);
  const Lanes16 s2 = _mm512_unpacklo_ps(r2, r3), s3 = _mm512_unpackhi_ps(r2, r3);
  r0 = _mm512_shuffle_ps(s0, s2, 0x44), r1 = _mm512_shuffle_ps(s0, s2, 0xee);
  r2 = _mm512_shuffle_ps(s1, s3, 0x44), r3 = _mm512_shuffle_ps(s1, s3, 0xee);
}
#endif

/// x[k][lane] = number k of eight, the last two of no use, that stand from `body[lane]` on.
SNUG_INLINE void gather(const float* numbers, const std::int32_t* body, Lanes4 (&x)[6]) {
  Lanes4 low[4], high[4];
  for (int i = 0; i < 4; ++i) {
    low[i] = load<Lanes4>(numbers + body[i]);
    high[i] = load<Lanes4>(numbers + body[i] + 4);
  }
  transpose_fours(low[0], low[1], low[2], low[3]);
  transpose_fours(high[0], high[1], high[2], high[3]);
  for (int k = 0; k < 4; ++k) x[k] = low[k];
  x[4] = high[0], x[5] = high[1];
}
SNUG_INLINE void gather(const float* numbers, const std::int32_t* body, Lanes8 (&x)[6]) {
  Lanes8 r[8];
  for (int i = 0; i < 8; ++i) r[i] = load<Lanes8>(numbers + body[i]);
  transpose_fours(r[0], r[1], r[2], r[3]);
  transpose_fours(r[4], r[5], r[6], r[7]);
  for (int k = 0; k < 4; ++k) x[k] = __builtin_shufflevector(r[k], r[k + 4], 0, 1, 2, 3, 8, 9, 10, 11);
  for (int k = 0; k < 2; ++k) x[4 + k] = __builtin_shufflevector(r[k], r[k + 4], 4, 5, 6, 7, 12, 13, 14, 15);
}
#ifdef __AVX512DQ__
/// Numbers of a body and of the one four lanes on.
SNUG_INLINE void gather(const float* numbers, const std::int32_t* body, Lanes16 (&x)[6]) {
  Lanes16 r[8];
  for (int i = 0; i < 8; ++i) {
    const std::int32_t* lane = body + (i < 4 ? i : i + 4);
    r[i] = _mm512_insertf32x8(_mm512_castps256_ps512(_mm256_loadu_ps(numbers + lane[0])),
                              _mm256_loadu_ps(numbers + lane[4]), 1);
  }
  transpose_fours(r[0], r[1], r[2], r[3]);
  transpose_fours(r[4], r[5], r[6], r[7]);
  for (int k = 0; k < 4; ++k) x[k] = _mm512_shuffle_f32x4(r[k], r[k + 4], 0x88);
  for (int k = 0; k < 2; ++k) x[4 + k] = _mm512_shuffle_f32x4(r[k], r[k + 4], 0xdd);
}
#endif
template <class T>
SNUG_INLINE void gather(const float* numbers, const std::int32_t* body, Two<T> (&x)[6]) {
  T low[6], high[6];
  gather(numbers, body, low);
  gather(numbers, body + LaneTraits<T>::width, high);
  for (int k = 0; k < 6; ++k) x[k] = {low[k], high[k]};
}

/// Back. Bodies that do not move come several times, always with zeros.
SNUG_INLINE void scatter(const Lanes4 (&x)[6], const std::int32_t* body, float* numbers) {
  Lanes4 low[4] = {x[0], x[1], x[2], x[3]}, high[4] = {x[4], x[5], Lanes4{}, Lanes4{}};
  transpose_fours(low[0], low[1], low[2], low[3]);
  transpose_fours(high[0], high[1], high[2], high[3]);
  for (int i = 0; i < 4; ++i) {
    store(low[i], numbers + body[i]);
    store(high[i], numbers + body[i] + 4);
  }
}
SNUG_INLINE void scatter(const Lanes8 (&x)[6], const std::int32_t* body, float* numbers) {
  Lanes8 r[8];
  for (int k = 0; k < 4; ++k) {
    const Lanes8 high = k < 2 ? x[4 + k] : Lanes8{};
    r[k] = __builtin_shufflevector(x[k], high, 0, 1, 2, 3, 8, 9, 10, 11);
    r[k + 4] = __builtin_shufflevector(x[k], high, 4, 5, 6, 7, 12, 13, 14, 15);
  }
  transpose_fours(r[0], r[1], r[2], r[3]);
  transpose_fours(r[4], r[5], r[6], r[7]);
  for (int i = 0; i < 8; ++i) store(r[i], numbers + body[i]);
}
#ifdef __AVX512DQ__
SNUG_INLINE void scatter(const Lanes16 (&x)[6], const std::int32_t* body, float* numbers) {
  const __m512i first = _mm512_setr_epi32(0, 1, 2, 3, 16, 17, 18, 19, 4, 5, 6, 7, 20, 21, 22, 23);
  const __m512i second = _mm512_setr_epi32(8, 9, 10, 11, 24, 25, 26, 27, 12, 13, 14, 15, 28, 29, 30, 31);
  Lanes16 r[8];
  for (int k = 0; k < 4; ++k) {
    const Lanes16 high = k < 2 ? x[4 + k] : Lanes16{};
    r[k] = _mm512_permutex2var_ps(x[k], first, high);
    r[k + 4] = _mm512_permutex2var_ps(x[k], second, high);
  }
  transpose_fours(r[0], r[1], r[2], r[3]);
  transpose_fours(r[4], r[5], r[6], r[7]);
  for (int i = 0; i < 8; ++i) {
    const std::int32_t* lane = body + (i < 4 ? i : i + 4);
    _mm256_storeu_ps(numbers + lane[0], _mm512_castps512_ps256(r[i]));
    _mm256_storeu_ps(numbers + lane[4], _mm512_extractf32x8_ps(r[i], 1));
  }
}
#endif
template <class T>
SNUG_INLINE void scatter(const Two<T> (&x)[6], const std::int32_t* body, float* numbers) {
  T low[6], high[6];
  for (int k = 0; k < 6; ++k) low[k] = x[k].low, high[k] = x[k].high;
  scatter(low, body, numbers);
  scatter(high, body + LaneTraits<T>::width, numbers);
}

}  // namespace snug::physics::internal
