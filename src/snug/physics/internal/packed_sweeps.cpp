// PackedSweeps: packs rows into blocks, sweeps over them.
#include "snug/physics/internal/packed_sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "snug/core/wide_vectors.hpp"
#include "snug/physics/internal/chunks.hpp"
#include "snug/physics/internal/contact_system.hpp"

namespace snug::physics::internal {
namespace {

using Lanes4 = float __attribute__((vector_size(16)));
using Lanes8 = float __attribute__((vector_size(32)));
constexpr int kLanes = PackedSweeps::kLanes;
template <class V>
constexpr int kWidth = sizeof(V) / sizeof(float);

constexpr int kMostPoints = 4;         ///< of a patch in one lane of a block; more of them follow in a later one
constexpr int kFewPoints = 2;          ///< patches of as many rows, or fewer, do not share a block with larger ones
constexpr std::size_t kMostOpen = 48;  ///< blocks that wait for more patches
constexpr int kWorstUse = 4;  ///< of eight lanes that hold a row, on average: below it one row at a time serves

constexpr float kStill = 0.3F;    ///< of the residual wanted: a change after which a sweep is the last
constexpr int kLeastSweeps = 20;  ///< before few unsolved rows end it
/// Momentum makes some modes grow where contacts slide: where the corrections of a sweep are this many times the least
/// of all before, the most momentum is taken twice as far from 1.
constexpr float kGrown = 30.0F;
constexpr float kLeastMomentum = 0.5F;

std::size_t at(int i) { return static_cast<std::size_t>(i); }
template <class V>
[[gnu::always_inline]] inline V load(const float* from) {
  V x;
  std::memcpy(&x, from, sizeof(V));
  return x;
}
template <class V>
[[gnu::always_inline]] inline void store(V x, float* to) {
  std::memcpy(to, &x, sizeof(V));
}
template <class V>
[[gnu::always_inline]] inline V all(float x) {
  return V{} + x;
}
template <class V>
[[gnu::always_inline]] inline V larger(V x, V y) {
  return x > y ? x : y;
}
template <class V>
[[gnu::always_inline]] inline V absolute(V x) {
  return x < 0.0F ? -x : x;
}
/// Exact to the last bit by any instruction. (An array: so the compiler finds that it has one for all.)
template <class V>
[[gnu::always_inline]] inline V root(V x) {
  float of[kWidth<V>], roots[kWidth<V>];
  store(x, of);
  for (int i = 0; i < kWidth<V>; ++i) roots[i] = __builtin_sqrtf(of[i]);
  return load<V>(roots);
}

/// r[k][i] to r[i][k] of four, in both halves of wider vectors.
template <class V>
[[gnu::always_inline]] inline void transpose_fours(V& r0, V& r1, V& r2, V& r3) {
  V s0, s1, s2, s3;
  if constexpr (kWidth<V> == 4) {
    s0 = __builtin_shufflevector(r0, r1, 0, 4, 1, 5), s1 = __builtin_shufflevector(r0, r1, 2, 6, 3, 7);
    s2 = __builtin_shufflevector(r2, r3, 0, 4, 1, 5), s3 = __builtin_shufflevector(r2, r3, 2, 6, 3, 7);
    r0 = __builtin_shufflevector(s0, s2, 0, 1, 4, 5), r1 = __builtin_shufflevector(s0, s2, 2, 3, 6, 7);
    r2 = __builtin_shufflevector(s1, s3, 0, 1, 4, 5), r3 = __builtin_shufflevector(s1, s3, 2, 3, 6, 7);
  } else {
    s0 = __builtin_shufflevector(r0, r1, 0, 8, 1, 9, 4, 12, 5, 13);
    s1 = __builtin_shufflevector(r0, r1, 2, 10, 3, 11, 6, 14, 7, 15);
    s2 = __builtin_shufflevector(r2, r3, 0, 8, 1, 9, 4, 12, 5, 13);
    s3 = __builtin_shufflevector(r2, r3, 2, 10, 3, 11, 6, 14, 7, 15);
    r0 = __builtin_shufflevector(s0, s2, 0, 1, 8, 9, 4, 5, 12, 13);
    r1 = __builtin_shufflevector(s0, s2, 2, 3, 10, 11, 6, 7, 14, 15);
    r2 = __builtin_shufflevector(s1, s3, 0, 1, 8, 9, 4, 5, 12, 13);
    r3 = __builtin_shufflevector(s1, s3, 2, 3, 10, 11, 6, 7, 14, 15);
  }
}

/// x[k][lane] = velocity k of the body of the lane.
[[gnu::always_inline]] inline void gather(const float* velocities, const std::int32_t* body, Lanes4 (&x)[6]) {
  Lanes4 low[4], high[4];
  for (int i = 0; i < 4; ++i) {
    low[i] = load<Lanes4>(velocities + 8 * body[i]);
    high[i] = load<Lanes4>(velocities + 8 * body[i] + 4);
  }
  transpose_fours(low[0], low[1], low[2], low[3]);
  transpose_fours(high[0], high[1], high[2], high[3]);
  for (int k = 0; k < 4; ++k) x[k] = low[k];
  x[4] = high[0], x[5] = high[1];
}
[[gnu::always_inline]] inline void gather(const float* velocities, const std::int32_t* body, Lanes8 (&x)[6]) {
  Lanes8 r[8];
  for (int i = 0; i < 8; ++i) r[i] = load<Lanes8>(velocities + 8 * body[i]);
  transpose_fours(r[0], r[1], r[2], r[3]);
  transpose_fours(r[4], r[5], r[6], r[7]);
  for (int k = 0; k < 4; ++k) x[k] = __builtin_shufflevector(r[k], r[k + 4], 0, 1, 2, 3, 8, 9, 10, 11);
  for (int k = 0; k < 2; ++k) x[4 + k] = __builtin_shufflevector(r[k], r[k + 4], 4, 5, 6, 7, 12, 13, 14, 15);
}

/// Back. Bodies that do not move come several times, always with zeros.
[[gnu::always_inline]] inline void scatter(const Lanes4 (&x)[6], const std::int32_t* body, float* velocities) {
  Lanes4 low[4] = {x[0], x[1], x[2], x[3]}, high[4] = {x[4], x[5], Lanes4{}, Lanes4{}};
  transpose_fours(low[0], low[1], low[2], low[3]);
  transpose_fours(high[0], high[1], high[2], high[3]);
  for (int i = 0; i < 4; ++i) {
    store(low[i], velocities + 8 * body[i]);
    store(high[i], velocities + 8 * body[i] + 4);
  }
}
[[gnu::always_inline]] inline void scatter(const Lanes8 (&x)[6], const std::int32_t* body, float* velocities) {
  Lanes8 r[8];
  for (int k = 0; k < 4; ++k) {
    const Lanes8 high = k < 2 ? x[4 + k] : Lanes8{};
    r[k] = __builtin_shufflevector(x[k], high, 0, 1, 2, 3, 8, 9, 10, 11);
    r[k + 4] = __builtin_shufflevector(x[k], high, 4, 5, 6, 7, 12, 13, 14, 15);
  }
  transpose_fours(r[0], r[1], r[2], r[3]);
  transpose_fours(r[4], r[5], r[6], r[7]);
  for (int i = 0; i < 8; ++i) store(r[i], velocities + 8 * body[i]);
}

/// What a sweep changes, by lanes.
struct Change {
  PackedSweeps::Lanes largest = {};   ///< from sweep to sweep, m/s
  PackedSweeps::Lanes uphill = {};    ///< positive where the sweep goes back on what momentum adds
  PackedSweeps::Lanes error = {};     ///< sum of W d^2, d what visits correct
  PackedSweeps::Lanes unsolved = {};  ///< number of rows that were corrected by more than is wanted
};

struct Sweep {
  const PackedSweeps::Block* first;
  const PackedSweeps::Block* end;
  PackedSweeps::Points* points;
  float* velocities;
  float momentum;
  float wanted;  ///< m/s
};

/// A sweep over `kWidth<V>` lanes from one on. Lanes share no body, so they may go one after the other, too.
template <class V>
class LaneSweep {
 public:
  [[gnu::always_inline]] LaneSweep(const Sweep& sweep, int lane)
      : sweep_(sweep), lane_(lane), momentum_(all<V>(sweep.momentum)), wanted_(all<V>(sweep.wanted)) {}

  [[gnu::always_inline]] void run(const PackedSweeps::Block& block) {
    V a[6], b[6];
    gather(sweep_.velocities, block.a + lane_, a);
    gather(sweep_.velocities, block.b + lane_, b);
    for (int i = 0; i < block.count; ++i) visit(sweep_.points[block.first + i], a, b);
    scatter(a, block.a + lane_, sweep_.velocities);
    scatter(b, block.b + lane_, sweep_.velocities);
  }
  [[gnu::always_inline]] void put(Change& change) const {
    store(largest_, change.largest + lane_);
    store(uphill_, change.uphill + lane_);
    store(error_, change.error + lane_);
    store(unsolved_, change.unsolved + lane_);
  }

 private:
  [[gnu::always_inline]] V of(const PackedSweeps::Lanes& lanes) const { return load<V>(lanes + lane_); }

  /// Impulses of a sliding contact: the normal law, then friction for its answer (solve_sliding, contact_solver.cpp).
  [[gnu::always_inline]] void slide(const PackedSweeps::Points& p, const V (&l)[3], V normal, V x1, V x2,
                                    V (&out)[3]) const {
    out[0] = larger(l[0] - normal * of(p.W_inverse), V{});
    const V d = out[0] - l[0], step = of(p.step_t);
    out[1] = l[1] - step * (x1 + of(p.W[1]) * d);
    out[2] = l[2] - step * (x2 + of(p.W[2]) * d);
    const V radius = of(p.mu) * out[0], square = out[1] * out[1] + out[2] * out[2];
    const V scale = square > radius * radius ? radius / root(square) : all<V>(1.0F);
    out[1] *= scale;
    out[2] *= scale;
  }

  /// One row of each lane (relax, contact_solver.cpp).
  [[gnu::always_inline]] void visit(PackedSweeps::Points& p, V (&a)[6], V (&b)[6]) {
    V x[3], old[3], l[3], s[3], g[3], d[3], V0[6];
    for (int i = 0; i < 3; ++i) {
      V sa = of(p.j[i][0]) * a[0], sb = of(p.j[i][6]) * b[0];
      for (int k = 1; k < 6; ++k) sa += of(p.j[i][k]) * a[k], sb += of(p.j[i][6 + k]) * b[k];
      x[i] = of(p.start[i]) + (sa + sb);
    }
    for (int i = 0; i < 3; ++i) {
      old[i] = of(p.lambda[i]);
      l[i] = old[i] + momentum_ * (old[i] - of(p.before[i]));
      store(old[i], p.before[i] + lane_);
    }
    const V normal = x[0] + of(p.gamma) * l[0];
    const auto opens = normal - (of(p.W[0]) * l[0] + of(p.W[1]) * l[1] + of(p.W[2]) * l[2]) >= 0.0F;
    for (int k = 0; k < 6; ++k) V0[k] = of(p.V[k]);
    s[0] = l[0] - (V0[0] * normal + V0[1] * x[1] + V0[2] * x[2]);
    s[1] = l[1] - (V0[1] * normal + V0[3] * x[1] + V0[4] * x[2]);
    s[2] = l[2] - (V0[2] * normal + V0[4] * x[1] + V0[5] * x[2]);
    const V limit = of(p.mu) * s[0];
    const auto sticks = (s[0] >= 0.0F) & (s[1] * s[1] + s[2] * s[2] <= limit * limit);
    slide(p, l, normal, x[1], x[2], g);
    const V mobility[3] = {of(p.W[0]), of(p.mobility[0]), of(p.mobility[1])};
    V most{}, worst{};
    for (int i = 0; i < 3; ++i) {
      const V chosen = sticks ? s[i] : g[i];
      const V next = opens ? V{} : chosen;
      store(next, p.lambda[i] + lane_);
      d[i] = next - l[i];
      const V moved = mobility[i] * (next - old[i]), corrected = mobility[i] * d[i];
      most = larger(absolute(moved), most);
      worst = larger(absolute(corrected), worst);
      uphill_ -= d[i] * moved;
      error_ += d[i] * corrected;
    }
    largest_ = larger(most, largest_);
    unsolved_ += worst > wanted_ ? all<V>(1.0F) : V{};
    for (int k = 0; k < 6; ++k) {
      a[k] += of(p.j[0][k]) * d[0] + of(p.j[1][k]) * d[1] + of(p.j[2][k]) * d[2];
      b[k] += of(p.j[0][6 + k]) * d[0] + of(p.j[1][6 + k]) * d[1] + of(p.j[2][6 + k]) * d[2];
    }
  }

  const Sweep& sweep_;
  int lane_;
  V momentum_, wanted_;
  V largest_{}, uphill_{}, error_{}, unsolved_{};
};

template <class V>
[[gnu::always_inline]] inline void sweep_blocks(const Sweep& sweep, Change& change) {
  if constexpr (kWidth<V> == kLanes) {
    LaneSweep<V> lanes(sweep, 0);
    for (const PackedSweeps::Block* block = sweep.first; block != sweep.end; ++block) lanes.run(*block);
    lanes.put(change);
  } else {
    LaneSweep<V> low(sweep, 0), high(sweep, kWidth<V>);
    for (const PackedSweeps::Block* block = sweep.first; block != sweep.end; ++block) low.run(*block), high.run(*block);
    low.put(change), high.put(change);
  }
}

using Kernel = void (*)(const Sweep&, Change&);
void sweep_by_four(const Sweep& sweep, Change& change) { sweep_blocks<Lanes4>(sweep, change); }
#if SNUG_HAS_WIDE_VECTORS
[[gnu::target("avx2")]] void sweep_by_eight(const Sweep& sweep, Change& change) { sweep_blocks<Lanes8>(sweep, change); }
/// As many lanes, and registers for all velocities.
[[gnu::target("avx512f,avx512vl,avx512dq")]] void sweep_in_registers(const Sweep& sweep, Change& change) {
  sweep_blocks<Lanes8>(sweep, change);
}
Kernel choose_kernel(int most_lanes) {
  if (most_lanes < kLanes || !__builtin_cpu_supports("avx2")) return sweep_by_four;
  const bool has_registers = __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
  return has_registers ? sweep_in_registers : sweep_by_eight;
}
#else
Kernel choose_kernel(int) { return sweep_by_four; }
#endif

}  // namespace

PackedSweeps::PackedSweeps(std::size_t bodies, std::size_t rows)
    : halves_(bodies, rows),
      place_(bodies),
      velocities_(bodies + 2),
      old_velocities_(bodies + 2),
      blocks_(rows),
      points_(rows / kWorstUse + kMostPoints),
      chunks_(rows),
      open_(kMostOpen + 1) {}

/// Into the oldest block with room that has about as many rows in a lane and none of its bodies.
void PackedSweeps::add_chunk(Chunk chunk, int a, int b) {
  const auto takes = [&](const Block& block) {
    bool has_body = (block.count > kFewPoints) != (chunk.count > kFewPoints);
    for (int i = 0; i < kLanes; ++i) {
      has_body |= a != 0 && (block.a[i] == a || block.b[i] == a);
      has_body |= b != 0 && (block.a[i] == b || block.b[i] == b);
    }
    return !has_body;
  };
  std::size_t open = 0;
  while (open < open_.size() && !takes(blocks_[at(open_[open])])) ++open;
  const auto close = [&](std::size_t i) {
    std::copy(open_.begin() + i + 1, open_.end(), open_.begin() + i);
    open_.resize(open_.size() - 1);
  };
  if (open == open_.size()) {
    if (open == kMostOpen) close(0);
    open_.push_back(static_cast<std::int32_t>(blocks_.size()));
    blocks_.push_back({});
    open = open_.size() - 1;
  }
  chunk.block = open_[open];
  Block& block = blocks_[at(chunk.block)];
  chunk.lane = block.lanes++;
  block.a[chunk.lane] = a, block.b[chunk.lane] = b;
  block.count = std::max(block.count, chunk.count);
  if (block.lanes == kLanes) close(open);
  chunks_.push_back(chunk);
}

/// The bodies of a half stand behind each other. What does not move has a place in each half, before the first and
/// behind the last body, so that threads do not write to the same.
void PackedSweeps::place_bodies(std::span<const int> bodies, bool is_cut) {
  std::int32_t place = 0;
  for (const auto half : {GroupHalves::First, GroupHalves::Second}) {
    for (const int body : bodies) {
      if ((is_cut ? halves_.of(body) : GroupHalves::First) == half) place_[at(body)] = ++place;
    }
    parts_[half].end_place = at(place) + 1;
  }
  Part& second = parts_[GroupHalves::Second];
  second.first_place = parts_[GroupHalves::First].end_place;
  ++second.end_place;
  velocities_.resize(second.end_place);
  old_velocities_.resize(second.end_place);
}

void PackedSweeps::add_part(GroupHalves::Part which, std::span<const RowPatch> patches, bool is_cut) {
  Part& part = parts_[at(which)];
  part.first_block = blocks_.size();
  open_.clear();
  for (const RowPatch& patch : patches) {
    if ((is_cut ? halves_.of(patch) : GroupHalves::First) != which) continue;
    const int a = patch.ia >= 0 ? place_[at(patch.ia)] : 0, b = patch.ib >= 0 ? place_[at(patch.ib)] : 0;
    for (int i = 0; i < patch.count; i += kMostPoints) {
      add_chunk({patch.first + i, std::min(kMostPoints, patch.count - i), 0, 0}, a, b);
    }
    row_count_ += patch.count;
  }
  part.end_block = blocks_.size();
  if (which != GroupHalves::Second) return;
  const auto fixed = static_cast<std::int32_t>(part.end_place - 1);
  for (std::size_t i = part.first_block; i < part.end_block; ++i) {
    std::replace(blocks_[i].a, blocks_[i].a + kLanes, 0, fixed);
    std::replace(blocks_[i].b, blocks_[i].b + kLanes, 0, fixed);
  }
}

bool PackedSweeps::pack(const Row* rows, std::span<const RowPatch> patches, std::span<const int> bodies, bool is_cut,
                        WorkerPool* pool) {
  if (is_cut) halves_.cut(patches, bodies);
  place_bodies(bodies, is_cut);
  blocks_.clear(), chunks_.clear();
  row_count_ = 0;
  for (const auto part : {GroupHalves::First, GroupHalves::Second, GroupHalves::Seam}) add_part(part, patches, is_cut);
  std::int32_t count = 0;
  for (Block& block : blocks_) {
    block.first = count;
    count += block.count;
  }
  if (count > row_count_ / kWorstUse + kMostPoints) return false;
  points_.resize(at(count));
  fill(rows, pool);
  return true;
}

/// Calls visit(index of the row, its points, its lane), on several threads where there are many.
template <class Visit>
void PackedSweeps::each_row(WorkerPool* pool, const Visit& visit) {
  for_ranges(pool, chunks_.size(), [&](std::size_t first, std::size_t end) {
    for (std::size_t k = first; k < end; ++k) {
      const Chunk& chunk = chunks_[k];
      Points* points = points_.begin() + blocks_[at(chunk.block)].first;
      for (int i = 0; i < chunk.count; ++i) visit(chunk.row + i, points[i], chunk.lane);
    }
  });
}

/// What stays from sweep to sweep. Lanes without a row hold one that stays open.
void PackedSweeps::fill(const Row* rows, WorkerPool* pool) {
  Points none{};
  std::fill_n(none.start[0], kLanes, 1.0F);
  for_ranges(pool, points_.size(), [&](std::size_t first, std::size_t end) {
    std::fill(points_.begin() + first, points_.begin() + end, none);
  });
  each_row(pool, [&](int index, Points& p, int lane) {
    const Row& row = rows[index];
    const int first = row.ia >= 0 ? 0 : 6, end = row.ib >= 0 ? 12 : 6;
    for (int i = 0; i < 3; ++i) {
      for (int k = first; k < end; ++k) p.j[i][k][lane] = static_cast<float>(row.j[i][k]);
      p.W[i][lane] = static_cast<float>(row.W[i]);
    }
    for (int k = 0; k < 6; ++k) p.V[k][lane] = static_cast<float>(row.W_inverse[k]);
    p.W_inverse[lane] = static_cast<float>(1.0 / row.W[0]);
    p.mobility[0][lane] = static_cast<float>(row.W[3]);
    p.mobility[1][lane] = static_cast<float>(row.W[5]);
    p.step_t[lane] = static_cast<float>(row.step_t);
    p.mu[lane] = static_cast<float>(row.mu);
    p.gamma[lane] = static_cast<float>(row.gamma);
  });
}

void PackedSweeps::begin(const Row* rows, const double* u, WorkerPool* pool) {
  std::fill(velocities_.begin(), velocities_.end(), std::array<float, kLanes>{});
  std::fill(old_velocities_.begin(), old_velocities_.end(), std::array<float, kLanes>{});
  each_row(pool, [&](int index, Points& p, int lane) {
    const Row& row = rows[index];
    double xi[3];
    contact_velocity(row, u, xi);
    xi[0] -= row.target;
    for (int i = 0; i < 3; ++i) {
      p.start[i][lane] = static_cast<float>(xi[i]);
      p.lambda[i][lane] = p.before[i][lane] = static_cast<float>(row.lambda[i]);
    }
  });
}

/// Velocities are linear in the impulses: they go on as these do.
void PackedSweeps::take_momentum(const Part& part, float momentum) {
  for (std::size_t i = part.first_place; i < part.end_place; ++i) {
    std::array<float, kLanes>&now = velocities_[i], &old = old_velocities_[i];
    for (std::size_t k = 0; k < kLanes; ++k) {
      const float value = now[k];
      now[k] = value + momentum * (value - old[k]);
      old[k] = value;
    }
  }
}

int PackedSweeps::run(Row* rows, const double* u, const Effort& effort, WorkerPool* pool) {
  begin(rows, u, pool);
  const Kernel kernel = choose_kernel(effort.most_lanes);
  const auto wanted = static_cast<float>(effort.wanted);
  float most = static_cast<float>(effort.momentum), momentum = 0.0F, least_error = -1.0F;
  std::array<Change, 3> changes;
  const auto sweep = [&](int index, int) {
    const Part& part = parts_[at(index)];
    take_momentum(part, momentum);
    changes[at(index)] = {};
    if (part.first_block == part.end_block) return;
    const Sweep of_part{blocks_.begin() + part.first_block,
                        blocks_.begin() + part.end_block,
                        points_.begin(),
                        velocities_.begin()->data(),
                        momentum,
                        wanted};
    kernel(of_part, changes[at(index)]);
  };
  double t = 1.0;
  int count = 0;
  while (count < effort.sweeps) {
    if (pool != nullptr) {
      pool->run(2, sweep);
    } else {
      sweep(0, 0), sweep(1, 0);
    }
    sweep(2, 0);
    ++count;
    float largest = 0.0F, uphill = 0.0F, error = 0.0F, unsolved = 0.0F;
    for (const Change& change : changes) {
      for (int i = 0; i < kLanes; ++i) {
        largest = std::max(largest, change.largest[i]);
        uphill += change.uphill[i];
        error += change.error[i];
        unsolved += change.unsolved[i];
      }
    }
    if (largest <= kStill * wanted ||
        (count >= kLeastSweeps && static_cast<double>(unsolved) <= effort.few * row_count_))
      break;
    const bool grows = least_error >= 0.0F && error > kGrown * least_error;
    if (grows) most = std::max(kLeastMomentum, 1.0F - 2.0F * (1.0F - most));
    least_error = grows || least_error < 0.0F ? error : std::min(error, least_error);
    const bool starts_anew = grows || uphill > 0.0F;
    const double next = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * t * t));
    momentum = starts_anew ? 0.0F : std::min(most, static_cast<float>((t - 1.0) / next));
    t = starts_anew ? 1.0 : next;
  }
  each_row(pool, [&](int index, const Points& p, int lane) {
    for (int i = 0; i < 3; ++i) rows[index].lambda[i] = static_cast<double>(p.lambda[i][lane]);
  });
  return count;
}

}  // namespace snug::physics::internal
