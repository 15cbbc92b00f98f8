// Lane kernel: one visit and one sweep, written once for vectors of all widths. Each source that includes it is
// compiled for processors of its own, so all of it is inlined.
#pragma once

#include "snug/physics/internal/lane_sweep.hpp"
#include "snug/physics/internal/lanes.hpp"

namespace snug::physics::internal {

// Loops over axes are written out: their arrays are to be registers.
#define SNUG_UNROLLED _Pragma("GCC unroll 6") for

template <class T>
class Sweeper {
 public:
  SNUG_INLINE explicit Sweeper(const LaneSweep& sweep)
      : sweep_(sweep), momentum_(all<T>(sweep.momentum)), wanted_(all<T>(sweep.wanted)) {}

  SNUG_INLINE void run(const LaneBlock& block) {
    T a[6], b[6];
    gather(sweep_.velocities, block.a, a);
    gather(sweep_.velocities, block.b, b);
    SNUG_UNROLLED(int k = 0; k < 3; ++k) turning_a_[k] = a[3 + k], turning_b_[k] = b[3 + k];
    if (block.linear < 0) {
      visit_shared(block, a, b);
    } else {
      for (int i = 0; i < block.count; ++i) visit_own(block, i, a, b);
    }
    SNUG_UNROLLED(int k = 0; k < 3; ++k) a[3 + k] = turning_a_[k], b[3 + k] = turning_b_[k];
    scatter(a, block.a, sweep_.velocities);
    scatter(b, block.b, sweep_.velocities);
  }
  SNUG_INLINE void put(LaneChange& change) const {
    store(largest_, change.largest);
    store(uphill_, change.uphill);
    store(error_, change.error);
    store(unsolved_, change.unsolved);
  }

 private:
  static SNUG_INLINE T dot(const Lanes* j, const T* u, T start) {
    return (start + load<T>(j[0]) * u[0]) + (load<T>(j[1]) * u[1] + load<T>(j[2]) * u[2]);
  }
  static SNUG_INLINE T dot_column(const Lanes (*j)[6], int k, const T* d, T start) {
    return (start + load<T>(j[0][k]) * d[0]) + (load<T>(j[1][k]) * d[1] + load<T>(j[2][k]) * d[2]);
  }

  /// Rows that have the same axes: what they need of the linear velocities is their difference along these.
  SNUG_INLINE void visit_shared(const LaneBlock& block, T (&a)[6], T (&b)[6]) {
    const T scale_a = load<T>(block.scale_a), scale_b = load<T>(block.scale_b), mobility = load<T>(block.mobility);
    T along[3], before[3], d[3];
    SNUG_UNROLLED(int k = 0; k < 3; ++k) d[k] = scale_a * a[k] + scale_b * b[k];
    SNUG_UNROLLED(int i = 0; i < 3; ++i) before[i] = along[i] = dot(block.axes[i], d, all<T>(0.0F));
    LanePoints* points = sweep_.points + block.first;
    for (int n = 0; n < block.count; ++n) {
      visit(points[n], along, d);
      SNUG_UNROLLED(int i = 0; i < 3; ++i) along[i] = along[i] + mobility * d[i];
    }
    const T mass = load<T>(block.mass);
    SNUG_UNROLLED(int i = 0; i < 3; ++i) d[i] = mass * (along[i] - before[i]);
    SNUG_UNROLLED(int k = 0; k < 3; ++k) {
      const T force =
          load<T>(block.axes[0][k]) * d[0] + (load<T>(block.axes[1][k]) * d[1] + load<T>(block.axes[2][k]) * d[2]);
      a[k] = a[k] + scale_a * force;
      b[k] = b[k] + scale_b * force;
    }
  }

  /// Row n of each lane, where axes are its own.
  SNUG_INLINE void visit_own(const LaneBlock& block, int n, T (&a)[6], T (&b)[6]) {
    const LaneLinear& linear = sweep_.linear[block.linear + n];
    T along[3], d[3];
    SNUG_UNROLLED(int i = 0; i < 3; ++i) along[i] = dot(linear.j[i] + 3, b, dot(linear.j[i], a, all<T>(0.0F)));
    visit(sweep_.points[block.first + n], along, d);
    SNUG_UNROLLED(int k = 0; k < 3; ++k) {
      a[k] = dot_column(linear.j, k, d, a[k]);
      b[k] = dot_column(linear.j, 3 + k, d, b[k]);
    }
  }

  /// Impulses of a sliding contact: the normal law, then friction for its answer (solve_sliding, contact_solver.cpp).
  static SNUG_INLINE void slide(const LanePoints& p, const T (&l)[3], T normal, const T (&x)[3], T (&out)[3]) {
    out[0] = larger(l[0] + load<T>(p.W_inverse) * normal, all<T>(0.0F));
    const T d = out[0] - l[0], step = load<T>(p.step_t);
    out[1] = l[1] + step * (x[1] + load<T>(p.W[1]) * d);
    out[2] = l[2] + step * (x[2] + load<T>(p.W[2]) * d);
    const T radius = load<T>(p.mu) * out[0], square = out[1] * out[1] + out[2] * out[2];
    const T scale = choose(at_least(radius * radius, square), all<T>(1.0F), radius / root(square));
    out[1] = out[1] * scale;
    out[2] = out[2] * scale;
  }

  /// One row of each lane (relax, contact_solver.cpp). `along`: relative velocity by the linear velocities. d: what
  /// impulses change by.
  SNUG_INLINE void visit(LanePoints& p, const T (&along)[3], T (&d)[3]) {
    const T zero = all<T>(0.0F);
    T x[3], old[3], l[3], s[3], g[3], V[6];
    SNUG_UNROLLED(int i = 0; i < 3; ++i) {
      x[i] = dot(p.turning[i], turning_a_, load<T>(p.start[i])) + dot(p.turning[i] + 3, turning_b_, along[i]);
    }
    SNUG_UNROLLED(int i = 0; i < 3; ++i) {
      old[i] = load<T>(p.lambda[i]);
      l[i] = old[i] + momentum_ * (old[i] - load<T>(p.before[i]));
      store(old[i], p.before[i]);
    }
    SNUG_UNROLLED(int k = 0; k < 6; ++k) V[k] = load<T>(p.V[k]);
    const T normal = x[0] + load<T>(p.gamma) * l[0];
    const T pressed = load<T>(p.W[0]) * l[0] + (load<T>(p.W[1]) * l[1] + load<T>(p.W[2]) * l[2]);
    const auto opens = at_least(normal, pressed);
    s[0] = (l[0] + V[0] * normal) + (V[1] * x[1] + V[2] * x[2]);
    s[1] = (l[1] + V[1] * normal) + (V[3] * x[1] + V[4] * x[2]);
    s[2] = (l[2] + V[2] * normal) + (V[4] * x[1] + V[5] * x[2]);
    const T limit = load<T>(p.mu) * s[0];
    const auto is_within = at_least(limit * limit, s[1] * s[1] + s[2] * s[2]), presses = at_least(s[0], zero);
    slide(p, l, normal, x, g);
    const T mobility[3] = {load<T>(p.W[0]), load<T>(p.mobility[0]), load<T>(p.mobility[1])};
    T worst = zero;
    SNUG_UNROLLED(int i = 0; i < 3; ++i) {
      const T next = choose(opens, zero, choose(presses, choose(is_within, s[i], g[i]), g[i]));
      store(next, p.lambda[i]);
      d[i] = next - l[i];
      const T corrected = mobility[i] * d[i];
      worst = larger(worst, absolute(corrected));
      uphill_ = uphill_ - corrected * (next - old[i]);
      error_ = error_ + corrected * d[i];
    }
    largest_ = larger(largest_, worst);
    unsolved_ = unsolved_ + choose(at_least(wanted_, worst), zero, all<T>(1.0F));
    SNUG_UNROLLED(int k = 0; k < 3; ++k) {
      turning_a_[k] = dot_column(p.turning, k, d, turning_a_[k]);
      turning_b_[k] = dot_column(p.turning, 3 + k, d, turning_b_[k]);
    }
  }

  const LaneSweep& sweep_;
  T momentum_, wanted_;
  T turning_a_[3], turning_b_[3];
  T largest_ = all<T>(0.0F), uphill_ = all<T>(0.0F), error_ = all<T>(0.0F), unsolved_ = all<T>(0.0F);
};

template <class T>
SNUG_INLINE void sweep_blocks(const LaneSweep& sweep, LaneChange& change) {
  Sweeper<T> sweeper(sweep);
  for (const LaneBlock* block = sweep.first; block != sweep.end; ++block) sweeper.run(*block);
  sweeper.put(change);
}

#undef SNUG_UNROLLED

}  // namespace snug::physics::internal
