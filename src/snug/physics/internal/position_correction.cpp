// PositionCorrection: errors of the rigid contacts of an island, sweeps over those that matter.
#include "snug/physics/internal/position_correction.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {
namespace {

/// Old overlaps are pushed out no faster than this, m/s; what this step's impacts overshot is undone at once.
constexpr double kRecoverySpeed = 0.2;
/// Bodies jammed between heavier ones need more than the first: with these alone they end up to 8 mm inside a wall.
/// Then bounces no longer pull, since what several of them ask for at once may be far away.
constexpr int kSweeps = 50, kMostSweeps = 1000;
constexpr double kCoarse = 1e-6;  ///< m, change of a sweep
constexpr double kLarge = 1e-4;   ///< m, displacement wanted; what rests or is pressed slowly stays below
/// Of the largest displacement wanted, in heaps of more pairs than this: a change that is left for the next step.
constexpr double kPrecision = 1e-3;
constexpr std::size_t kHeap = 32;
/// The first sweeps end what a few contacts want exactly; then large heaps gain a quarter by going further each time
/// (of 1.2, 1.3, 1.4 and 1.6; piles of 1000).
constexpr int kPlainSweeps = 5;
constexpr double kRelaxation = 1.3;
constexpr int kUnknown = -1;  ///< sweep that moved a body

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

PositionCorrection::PositionCorrection(std::size_t bodies, std::size_t rows, std::shared_ptr<Row[]> room)
    : room_(std::move(room)), normals_(reinterpret_cast<Normal*>(room_.get())), moved_in_(bodies), halves_(bodies) {
  runs_.reserve(rows);
  sorted_.reserve(rows);
  visited_.reserve(rows);
  bodies_.reserve(bodies);
}

double PositionCorrection::find_error(const StepSettings& settings, const Row& row, const Contact* contacts,
                                      const double* u, Normal& normal) {
  normal.is_rigid = row.is_rigid;
  normal.ia = row.ia, normal.ib = row.ib;
  if (!row.is_rigid) return 0.0;
  const double dt = settings.dt;
  const Contact& contact = contacts[row.contact];
  const double gap = contact.phi + 0.5 * dt * (contact.approach + relative_velocity(row, 0, u));
  const double error = row.gap_end - gap;
  const double cap = dt * (0.5 * std::abs(contact.approach) + kRecoverySpeed);
  const bool is_swept = contact.point < 0;  // not an old overlap
  std::fill_n(normal.a, 12, 0.0);
  if (row.ia >= 0) std::copy_n(row.a(0), 6, normal.a);
  if (row.ib >= 0) std::copy_n(row.b(0), 6, normal.b);
  normal.W = row.W[0];
  normal.wanted = is_swept ? error : std::min(error, cap);
  normal.lambda = 0.0;
  normal.is_bounce = row.is_bounce;
  return row.is_bounce ? std::abs(error) : error;
}

void PositionCorrection::list_runs(std::size_t normals) {
  runs_.clear();
  for (std::size_t i = 0; i < normals; ++i) {
    const Normal& normal = normals_[i];
    if (!normal.is_rigid) continue;
    const auto index = static_cast<int>(i);
    if (runs_.empty() || runs_.back().a != normal.ia || runs_.back().b != normal.ib || runs_.back().end != index) {
      runs_.push_back({normal.ia, normal.ib, index, index, false});
    }
    runs_.back().end = index + 1;
    runs_.back().is_wanted |= normal.wanted > 0.0 || normal.is_bounce;
  }
}

/// The runs of each part behind each other, in their order.
void PositionCorrection::divide(bool is_cut, const Vector3* centres) {
  bodies_.clear();
  for (const Run& run : runs_) {
    for (const int body : {run.a, run.b}) {
      if (body >= 0) moved_in_[at(body)] = kUnknown;
    }
  }
  for (const Run& run : runs_) {
    for (const int body : {run.a, run.b}) {
      if (body < 0 || moved_in_[at(body)] != kUnknown) continue;
      moved_in_[at(body)] = 0;
      bodies_.push_back(body);
    }
  }
  visited_.resize(runs_.size());
  parts_ = {};
  parts_[BodyHalves::First].end = static_cast<int>(runs_.size());
  if (!is_cut) return;
  halves_.begin(bodies_, centres);
  for (const Run& run : runs_) halves_.add(run.a, run.b, run.end - run.first);
  halves_.cut();
  sorted_.clear();
  for (const auto part : {BodyHalves::First, BodyHalves::Second, BodyHalves::Seam}) {
    parts_[at(part)].first = static_cast<int>(sorted_.size());
    std::copy_if(runs_.begin(), runs_.end(), std::back_inserter(sorted_),
                 [&](const Run& run) { return halves_.of(run.a, run.b) == part; });
    parts_[at(part)].end = static_cast<int>(sorted_.size());
  }
  runs_.swap(sorted_);
}

/// In the first sweep what has an error, then what has a body that has moved since the sweep before began.
bool PositionCorrection::is_to_visit(const Run& run, int sweep) const {
  if (sweep == 1) return run.is_wanted;
  return (run.a >= 0 && moved_in_[at(run.a)] >= sweep - 1) || (run.b >= 0 && moved_in_[at(run.b)] >= sweep - 1);
}

/// Returns the largest change of a displacement, m.
double PositionCorrection::visit(const Run& run, const Sweep& sweep, double* shift) {
  double* a = run.a >= 0 ? shift + 6 * run.a : nullptr;
  double* b = run.b >= 0 ? shift + 6 * run.b : nullptr;
  Pair x[3] = {}, y[3] = {};
  for (int k = 0; k < 3; ++k) {
    if (a != nullptr) x[k] = load(a + 2 * k);
    if (b != nullptr) y[k] = load(b + 2 * k);
  }
  double largest = 0.0;
  for (int i = run.first; i < run.end; ++i) {
    Normal& normal = normals_[at(i)];
    Pair moved{};
    for (int k = 0; k < 3; ++k) moved += load(normal.a + 2 * k) * x[k] + load(normal.b + 2 * k) * y[k];
    double lambda = normal.lambda + sweep.relaxation * (normal.wanted - (moved[0] + moved[1])) / normal.W;
    if (!normal.is_bounce || !sweep.is_bounce_pulled) lambda = std::max(0.0, lambda);
    const double d = lambda - normal.lambda;
    if (d == 0.0) continue;
    normal.lambda = lambda;
    for (int k = 0; k < 3; ++k) {
      x[k] += load(normal.a + 2 * k) * Pair{d, d};
      y[k] += load(normal.b + 2 * k) * Pair{d, d};
    }
    largest = std::max(largest, std::abs(d) * normal.W);
  }
  if (largest == 0.0) return 0.0;
  for (int k = 0; k < 3; ++k) {
    if (a != nullptr) store(a + 2 * k, x[k]);
    if (b != nullptr) store(b + 2 * k, y[k]);
  }
  return largest;
}

double PositionCorrection::sweep(const Part& part, const Sweep& sweep, double* shift) {
  int end = part.first;  // of the runs to visit, found before the first is
  for (int i = part.first; i < part.end; ++i) {
    if (is_to_visit(runs_[at(i)], sweep.number)) visited_[at(end++)] = i;
  }
  double largest = 0.0;
  for (int i = part.first; i < end; ++i) {
    const Run& run = runs_[at(visited_[at(i)])];
    const double change = visit(run, sweep, shift);
    largest = std::max(largest, change);
    if (change <= sweep.least) continue;
    for (const int body : {run.a, run.b}) {
      if (body >= 0) moved_in_[at(body)] = sweep.number;
    }
  }
  return largest;
}

double PositionCorrection::sweep(const Sweep& sweep, double* shift, WorkerPool* pool) {
  double changes[2] = {};
  const auto sweep_half = [&](int half, int) { changes[half] = this->sweep(parts_[at(half)], sweep, shift); };
  if (pool != nullptr && parts_[BodyHalves::Second].first < parts_[BodyHalves::Second].end) {
    pool->run(2, sweep_half);
  } else {
    sweep_half(0, 0), sweep_half(1, 0);
  }
  return std::max({changes[0], changes[1], this->sweep(parts_[BodyHalves::Seam], sweep, shift)});
}

void PositionCorrection::run(const StepSettings& settings, const Row* first, const Row* end, const Contact* contacts,
                             const double* u, const Vector3* centres, bool is_infeasible, double* shift,
                             WorkerPool* pool) noexcept {
  const auto rows = static_cast<std::size_t>(end - first);
  const double worst = largest_of_ranges(pool, rows, [&](std::size_t begin, std::size_t past) {
    double most = 0.0;
    for (std::size_t i = begin; i < past; ++i) {
      most = std::max(most, find_error(settings, first[i], contacts, u, normals_[i]));
    }
    return most;
  });
  if (worst <= settings.position_slop) return;
  list_runs(rows);
  divide(static_cast<std::ptrdiff_t>(rows) >= kSharedGroup, centres);
  const bool is_heap = runs_.size() > kHeap;
  const double least = std::max(0.1 * settings.position_slop, is_heap ? kPrecision * worst : 0.0);
  const int most = is_infeasible || worst <= kLarge ? kSweeps : kMostSweeps;
  double change = 0.0;
  for (int i = 0; i < kSweeps || (change > kCoarse && i < most); ++i) {
    change = sweep({i + 1, i < kSweeps, is_heap && i >= kPlainSweeps ? kRelaxation : 1.0, least}, shift, pool);
    if (change <= least) break;
  }
}

}  // namespace snug::physics::internal
