// Feature: 32-bit names of what touches what, and of the axis that a pair remembers.
#pragma once

#include <cstdint>

#include "snug/geometry/internal/tolerances.hpp"
#include "snug/geometry/manifold.hpp"

namespace snug::geometry::internal {

// A code names one vertex, edge or face of one shape in 16 bits; never zero.
constexpr std::uint32_t vertex_code(int index) { return 0x4000U | static_cast<std::uint32_t>(index); }
constexpr std::uint32_t edge_code(int index) { return 0x8000U | static_cast<std::uint32_t>(index); }
constexpr std::uint32_t face_code(int index) { return 0xC000U | static_cast<std::uint32_t>(index); }
/// Times 0 to 3, tells apart points that would carry the same name (all within kSnap of one vertex).
inline constexpr std::uint32_t kSecond = 0x1000U;

constexpr std::uint32_t feature_of(std::uint32_t code_A, std::uint32_t code_B) { return code_A << 16 | code_B; }

enum class AxisKind : std::uint32_t { None = 0, FaceA = 1, FaceB = 2, Edge = 3 };

/// A separating axis: a face of A, a face of B, or an edge of each.
struct Axis {
  AxisKind kind = AxisKind::None;
  int a = 0;  ///< face or edge of A
  int b = 0;  ///< face or edge of B
  bool operator==(const Axis&) const = default;
};

inline Axis flipped(const Axis& axis) {
  if (axis.kind == AxisKind::FaceA) return {AxisKind::FaceB, axis.b, axis.a};
  if (axis.kind == AxisKind::FaceB) return {AxisKind::FaceA, axis.b, axis.a};
  return {axis.kind, axis.b, axis.a};
}

inline PairCache encode(const Axis& axis) {
  return {static_cast<std::uint32_t>(axis.kind) << 28 | static_cast<std::uint32_t>(axis.a) << 14 |
          static_cast<std::uint32_t>(axis.b)};
}

inline Axis decode(const PairCache& cache) {
  return {static_cast<AxisKind>(cache.features >> 28 & 3U), static_cast<int>(cache.features >> 14 & 0x3FFFU),
          static_cast<int>(cache.features & 0x3FFFU)};
}

/// One call: poses in the order in which the shapes are worked on, which does not depend on the caller's order.
struct PairCall {
  const Pose& X_WA;
  const Pose& X_WB;
  double margin;  ///< m
  bool swapped;   ///< A here is the caller's B
};

/// Writes a point of a manifold in the caller's order. p_WA on A here, p_WB = p_WA + phi n.
inline void emit(bool swapped, const Vector3& p_WA, const Vector3& p_WB, double phi, std::uint32_t code_A,
                 std::uint32_t code_B, Manifold& out) noexcept {
  if (out.count >= kMaxManifoldPoints) return;
  ManifoldPoint& point = out.points[static_cast<std::size_t>(out.count++)];
  point.p_WA = swapped ? p_WB : p_WA;
  point.p_WB = swapped ? p_WA : p_WB;
  point.phi = phi;
  point.feature = swapped ? feature_of(code_B, code_A) : feature_of(code_A, code_B);
}

inline void set_normal(bool swapped, const Vector3& n_W, Manifold& out) noexcept {
  out.n_AB_W = swapped ? Vector3(-n_W) : n_W;
}

/// By how much the reported depth may exceed the least one (`separation` is minus that); README.md, "Accuracy".
inline double allowance(double separation) noexcept {
  return separation < 0.0 ? kBias - kBiasRelative * separation : kBias;
}

}  // namespace snug::geometry::internal
