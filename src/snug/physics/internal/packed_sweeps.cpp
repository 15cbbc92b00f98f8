// PackedSweeps: packs rows into blocks, sweeps over them.
#include "snug/physics/internal/packed_sweeps.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "snug/physics/internal/chunks.hpp"
#include "snug/physics/internal/contact_system.hpp"

namespace snug::physics::internal {
namespace {

constexpr int kMostPoints = 4;  ///< of a patch in one lane of a block; more of them follow in a later one
constexpr int kManyPoints = 3;  ///< patches of as many rows, or more, share blocks; those of fewer with their like
constexpr std::size_t kMostOpen = 48;  ///< half blocks that wait for more patches
constexpr std::ptrdiff_t kNear = 64;   ///< half blocks among which one is looked for another
constexpr int kWorstUse = 5;  ///< of sixteen lanes that hold a row, on average: below it one row at a time serves
constexpr double kSameAxes = 1e-12;  ///< relative

constexpr float kStill = 0.3F;    ///< of the residual wanted: a change after which a sweep is the last
constexpr int kLeastSweeps = 20;  ///< before few unsolved rows end it
/// Momentum makes some modes grow where contacts slide: where the corrections of a sweep are this many times the least
/// of all before, the most momentum is taken twice as far from 1.
constexpr float kGrown = 30.0F;
constexpr float kLeastMomentum = 0.5F;
/// What swings under much momentum fades under this one.
constexpr float kCalmMomentum = 0.8F;

std::size_t at(int i) { return static_cast<std::size_t>(i); }
double product(const double* x, const double* y) { return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]; }
bool is_same(const double* x, const double* y) { return x[0] == y[0] && x[1] == y[1] && x[2] == y[2]; }

/// Three numbers into a lane.
void put(const double* x, int lane, Lanes* to) {
  for (int k = 0; k < 3; ++k) to[k][lane] = static_cast<float>(x[k]);
}

/// How the linear velocities of both bodies enter the rows of a contact: along the same three axes.
struct SharedAxes {
  double axes[3][3];
  double scale_a = 0.0, scale_b = 0.0;

  /// False: they do not.
  [[nodiscard]] bool find(const Row& row) {
    const bool has_a = row.ia >= 0, has_b = row.ib >= 0;
    if (has_a) scale_a = -std::sqrt(product(row.a(0), row.a(0)));
    if (has_b) scale_b = std::sqrt(product(row.b(0), row.b(0)));
    const double to_axes = 1.0 / (has_b ? scale_b : scale_a);
    bool is_shared = true;
    for (int i = 0; i < 3; ++i) {
      const double* j = has_b ? row.b(i) : row.a(i);
      for (int k = 0; k < 3; ++k) {
        axes[i][k] = to_axes * j[k];
        is_shared &= !has_a || std::abs(row.a(i)[k] - scale_a * axes[i][k]) <= kSameAxes * -scale_a;
      }
      for (int k = 0; k <= i; ++k) {
        is_shared &= std::abs(product(axes[i], axes[k]) - (i == k ? 1.0 : 0.0)) <= kSameAxes;
      }
    }
    return is_shared;
  }
};

/// Rows from the first on that have its shared axes; 0: it has none.
int count_sharing(const Row* first, int count) {
  if (!SharedAxes().find(*first)) return 0;
  const auto shares = [&](const Row& row) {
    for (int i = 0; i < 3; ++i) {
      if (row.ia >= 0 && !is_same(row.a(i), first->a(i))) return false;
      if (row.ib >= 0 && !is_same(row.b(i), first->b(i))) return false;
    }
    return true;
  };
  return static_cast<int>(std::find_if_not(first + 1, first + count, shares) - first);
}

}  // namespace

PackedSweeps::Part::Part(std::size_t rows) : half_blocks(rows), open(kMostOpen + 1), chunks(rows), blocks(rows) {}

void PackedSweeps::Part::clear() { half_blocks.clear(), open.clear(), chunks.clear(), blocks.clear(); }

PackedSweeps::PackedSweeps(std::size_t bodies, std::size_t rows)
    : halves_(bodies),
      parts_{Part(rows), Part(rows), Part(rows)},
      place_(bodies),
      velocities_(bodies + 2),
      old_velocities_(bodies + 2),
      points_(rows / kWorstUse + kMostPoints),
      linear_(points_.capacity()) {}

bool PackedSweeps::HalfBlock::has(std::int32_t body) const {
  bool found = false;
  for (int i = 0; i < kHalf; ++i) found |= a[i] == body || b[i] == body;
  return body != 0 && found;
}

bool PackedSweeps::HalfBlock::is_like(std::int32_t rows, bool own_axes) const {
  return std::min(count, kManyPoints) == std::min(rows, kManyPoints) && has_own_axes == own_axes;
}

/// Into the oldest half block with room that has about as many rows in a lane and none of its bodies.
void PackedSweeps::Part::add_chunk(Chunk chunk, int a, int b) {
  std::size_t place = 0;
  const auto takes = [&](const HalfBlock& half) {
    return half.is_like(chunk.count, chunk.has_own_axes) && !half.has(a) && !half.has(b);
  };
  while (place < open.size() && !takes(half_blocks[at(open[place])])) ++place;
  const auto close = [&](std::size_t i) {
    std::copy(open.begin() + i + 1, open.end(), open.begin() + i);
    open.resize(open.size() - 1);
  };
  if (place == open.size()) {
    if (place == kMostOpen) close(0);
    open.push_back(static_cast<std::int32_t>(half_blocks.size()));
    HalfBlock& added = half_blocks.push_back({});
    added.count = chunk.count, added.has_own_axes = chunk.has_own_axes;
    place = open.size() - 1;
  }
  chunk.block = open[place];
  HalfBlock& half = half_blocks[at(chunk.block)];
  chunk.lane = half.lanes++;
  half.a[chunk.lane] = a, half.b[chunk.lane] = b;
  half.count = std::max(half.count, chunk.count);
  if (half.lanes == kHalf) close(place);
  chunks.push_back(chunk);
}

/// Two half blocks that share no body to one block, the nearest first. (Sixteen patches at once would leave more lanes
/// empty.)
void PackedSweeps::Part::join_half_blocks() {
  const auto add = [&](HalfBlock& half, int place) {
    LaneBlock& block = blocks.back();
    for (int i = 0; i < kHalf; ++i) {
      block.a[place * kHalf + i] = kNumbers * half.a[i];
      block.b[place * kHalf + i] = kNumbers * half.b[i];
    }
    block.count = std::max(block.count, half.count);
    half.joined = static_cast<std::int32_t>(2 * (blocks.size() - 1)) + place;
  };
  for (HalfBlock* half = half_blocks.begin(); half != half_blocks.end(); ++half) {
    if (half->joined >= 0) continue;
    blocks.push_back({}).linear = half->has_own_axes ? 0 : -1;
    add(*half, 0);
    const auto fits = [&](const HalfBlock& other) {
      const auto has = [&](std::int32_t body) { return other.has(body); };
      return other.joined < 0 && other.is_like(half->count, half->has_own_axes) &&
             std::none_of(half->a, half->a + kHalf, has) && std::none_of(half->b, half->b + kHalf, has);
    };
    HalfBlock* end = half + std::min(half_blocks.end() - half, kNear);
    HalfBlock* other = std::find_if(half + 1, end, fits);
    if (other < end) add(*other, 1);
  }
  for (Chunk& chunk : chunks) {
    const std::int32_t joined = half_blocks[at(chunk.block)].joined;
    chunk.block = joined / 2;
    chunk.lane += joined % 2 * kHalf;
  }
}

BodyHalves::Part PackedSweeps::part_of(const RowPatch& patch) const {
  return is_cut_ ? halves_.of(patch.ia, patch.ib) : BodyHalves::First;
}

void PackedSweeps::cut(std::span<const RowPatch> patches, std::span<const int> bodies, const Vector3* centres) {
  is_cut_ = centres != nullptr;
  if (!is_cut_) return;
  halves_.begin(bodies, centres);
  for (const RowPatch& patch : patches) halves_.add(patch.ia, patch.ib, patch.count);
  halves_.cut();
}

/// The bodies of a half stand behind each other. What does not move has a place in each half, before the first and
/// behind the last body, so that threads do not write to the same.
void PackedSweeps::place_bodies(std::span<const int> bodies) {
  std::int32_t place = 0;
  for (const auto half : {BodyHalves::First, BodyHalves::Second}) {
    for (const int body : bodies) {
      if (part_of(body) == half) place_[at(body)] = ++place;
    }
    parts_[half].end_place = at(place) + 1;
  }
  Part& second = parts_[BodyHalves::Second];
  second.first_place = parts_[BodyHalves::First].end_place;
  ++second.end_place;
  velocities_.resize(second.end_place);
  old_velocities_.resize(second.end_place);
}

void PackedSweeps::add_patches(BodyHalves::Part which, const Row* rows, std::span<const RowPatch> patches) {
  Part& part = parts_[at(which)];
  part.clear();
  for (const RowPatch& patch : patches) {
    if (part_of(patch) != which) continue;
    const int a = patch.ia >= 0 ? place_[at(patch.ia)] : 0, b = patch.ib >= 0 ? place_[at(patch.ib)] : 0;
    for (int i = 0; i < patch.count;) {
      const int row = patch.first + i, most = std::min(kMostPoints, patch.count - i);
      const int sharing = count_sharing(rows + row, most);
      const int count = sharing > 0 ? sharing : most;
      part.add_chunk({row, count, 0, 0, sharing == 0}, a, b);
      i += count;
    }
  }
  part.join_half_blocks();
  if (which != BodyHalves::Second) return;
  const auto fixed = kNumbers * static_cast<std::int32_t>(part.end_place - 1);
  for (LaneBlock& block : part.blocks) {
    std::replace(block.a, block.a + kLanes, 0, fixed);
    std::replace(block.b, block.b + kLanes, 0, fixed);
  }
}

/// Calls job(part, worker), on several threads where there is a cut.
template <class Job>
void PackedSweeps::each_part(WorkerPool* pool, const Job& job) {
  if (is_cut_ && pool != nullptr) return pool->run(3, job);
  for (const auto part : {BodyHalves::First, BodyHalves::Second, BodyHalves::Seam}) job(part, 0);
}

bool PackedSweeps::pack(const Row* rows, std::span<const RowPatch> patches, std::span<const int> bodies,
                        const Vector3* centres, WorkerPool* pool) {
  cut(patches, bodies, centres);
  place_bodies(bodies);
  each_part(pool, [&](int part, int) { add_patches(static_cast<BodyHalves::Part>(part), rows, patches); });
  row_count_ = patches.back().first + patches.back().count;
  std::int32_t count = 0, linear = 0;
  for (Part& part : parts_) {
    for (LaneBlock& block : part.blocks) {
      block.first = count;
      count += block.count;
      if (block.linear >= 0) block.linear = std::exchange(linear, linear + block.count);
    }
  }
  if (count > row_count_ / kWorstUse + kMostPoints) return false;
  points_.resize(at(count));
  linear_.resize(at(linear));
  fill(rows, pool);
  return true;
}

/// Calls visit(chunk, its block); the parts on several threads.
template <class Visit>
void PackedSweeps::each_chunk(WorkerPool* pool, const Visit& visit) {
  each_part(pool, [&](int index, int) {
    Part& part = parts_[at(index)];
    for (const Chunk& chunk : part.chunks) visit(chunk, part.blocks[at(chunk.block)]);
  });
}

/// Calls visit(index of the row, its points, its lane).
template <class Visit>
void PackedSweeps::each_row(WorkerPool* pool, const Visit& visit) {
  each_chunk(pool, [&](const Chunk& chunk, const LaneBlock& block) {
    LanePoints* points = points_.begin() + block.first;
    for (int i = 0; i < chunk.count; ++i) visit(chunk.row + i, points[i], chunk.lane);
  });
}

/// How linear velocities enter the rows of a chunk.
void PackedSweeps::fill_linear(const Row* first, const Chunk& chunk, LaneBlock& block) {
  if (!chunk.has_own_axes) {
    SharedAxes shared;
    (void)shared.find(*first);
    const double mobility = shared.scale_a * shared.scale_a + shared.scale_b * shared.scale_b;
    for (int i = 0; i < 3; ++i) put(shared.axes[i], chunk.lane, block.axes[i]);
    block.scale_a[chunk.lane] = static_cast<float>(shared.scale_a);
    block.scale_b[chunk.lane] = static_cast<float>(shared.scale_b);
    block.mobility[chunk.lane] = static_cast<float>(mobility);
    block.mass[chunk.lane] = static_cast<float>(1.0 / mobility);
    return;
  }
  for (int n = 0; n < chunk.count; ++n) {
    for (int i = 0; i < 3; ++i) {
      Lanes* j = linear_[at(block.linear + n)].j[i];
      if (first[n].ia >= 0) put(first[n].a(i), chunk.lane, j);
      if (first[n].ib >= 0) put(first[n].b(i), chunk.lane, j + 3);
    }
  }
}

/// What stays from sweep to sweep. Lanes without a row hold one that stays open.
void PackedSweeps::fill(const Row* rows, WorkerPool* pool) {
  LanePoints none{};
  std::fill_n(none.start[0], kLanes, 1.0F);
  for_ranges(pool, points_.size(), [&](std::size_t first, std::size_t end) {
    std::fill(points_.begin() + first, points_.begin() + end, none);
  });
  std::fill(linear_.begin(), linear_.end(), LaneLinear{});
  each_chunk(pool, [&](const Chunk& chunk, LaneBlock& block) { fill_linear(rows + chunk.row, chunk, block); });
  each_row(pool, [&](int index, LanePoints& p, int lane) {
    const Row& row = rows[index];
    for (int i = 0; i < 3; ++i) {
      if (row.ia >= 0) put(row.a(i) + 3, lane, p.turning[i]);
      if (row.ib >= 0) put(row.b(i) + 3, lane, p.turning[i] + 3);
    }
    put(row.W, lane, p.W);
    for (int k = 0; k < 6; ++k) p.V[k][lane] = static_cast<float>(-row.W_inverse[k]);
    p.W_inverse[lane] = static_cast<float>(-1.0 / row.W[0]);
    p.mobility[0][lane] = static_cast<float>(row.W[3]);
    p.mobility[1][lane] = static_cast<float>(row.W[5]);
    p.step_t[lane] = static_cast<float>(-row.step_t);
    p.mu[lane] = static_cast<float>(row.mu);
    p.gamma[lane] = static_cast<float>(row.gamma);
  });
}

void PackedSweeps::begin(const Row* rows, const double* u, WorkerPool* pool) {
  std::fill(velocities_.begin(), velocities_.end(), Numbers{});
  std::fill(old_velocities_.begin(), old_velocities_.end(), Numbers{});
  each_row(pool, [&](int index, LanePoints& p, int lane) {
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
    Numbers &now = velocities_[i], &old = old_velocities_[i];
    for (std::size_t k = 0; k < now.size(); ++k) {
      const float value = now[k];
      now[k] = value + momentum * (value - old[k]);
      old[k] = value;
    }
  }
}

int PackedSweeps::run(Row* rows, const double* u, const Effort& effort, WorkerPool* pool) {
  begin(rows, u, pool);
  const LaneKernel kernel = choose_lane_kernel(effort.most_width);
  const auto wanted = static_cast<float>(effort.wanted);
  float most = static_cast<float>(effort.momentum), momentum = 0.0F, least_error = -1.0F;
  std::array<LaneChange, 3> changes;
  const auto sweep = [&](int index, int) {
    const Part& part = parts_[at(index)];
    take_momentum(part, momentum);
    changes[at(index)] = {};
    if (part.blocks.empty()) return;
    const LaneSweep of_part{part.blocks.begin(),         part.blocks.end(), points_.begin(), linear_.begin(),
                            velocities_.begin()->data(), momentum,          wanted};
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
    for (const LaneChange& change : changes) {
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
    const float limit = count < effort.sweeps - effort.calm ? most : std::min(most, kCalmMomentum);
    momentum = starts_anew ? 0.0F : std::min(limit, static_cast<float>((t - 1.0) / next));
    t = starts_anew ? 1.0 : next;
  }
  each_row(pool, [&](int index, const LanePoints& p, int lane) {
    for (int i = 0; i < 3; ++i) rows[index].lambda[i] = static_cast<double>(p.lambda[i][lane]);
  });
  return count;
}

void PackedSweeps::add_change(std::span<const int> bodies, double* u) const {
  for (const int body : bodies) {
    const Numbers& change = velocities_[at(place_[at(body)])];
    for (int k = 0; k < 6; ++k) u[6 * body + k] += static_cast<double>(change[at(k)]);
  }
}

}  // namespace snug::physics::internal
