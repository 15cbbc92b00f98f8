// PositionCorrection: errors of the rigid contacts of an island, sweeps over those that matter.
#include "snug/physics/internal/position_correction.hpp"

#include <algorithm>
#include <cmath>
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

}  // namespace

PositionCorrection::PositionCorrection(std::size_t bodies, std::size_t rows, std::shared_ptr<Row[]> room)
    : room_(std::move(room)), normals_(reinterpret_cast<Normal*>(room_.get())), has_moved_(bodies + 1) {
  runs_.reserve(rows);
  visited_.reserve(rows);
}

double PositionCorrection::find_errors(const StepSettings& settings, const Row* first, const Row* end,
                                       const Contact* contacts, const double* u) {
  const double dt = settings.dt;
  double worst = 0.0;
  count_ = 0;
  runs_.clear();
  visited_.clear();
  for (const Row* row = first; row != end; ++row) {
    if (!row->is_rigid) continue;
    const Contact& contact = contacts[row->contact];
    const double gap = contact.phi + 0.5 * dt * (contact.approach + relative_velocity(*row, 0, u));
    const double error = row->gap_end - gap;
    const double cap = dt * (0.5 * std::abs(contact.approach) + kRecoverySpeed);
    const bool is_swept = contact.point < 0;  // not an old overlap
    worst = std::max(worst, row->is_bounce ? std::abs(error) : error);
    Normal& normal = normals_[count_];
    std::fill_n(normal.a, 12, 0.0);
    if (row->ia >= 0) std::copy_n(row->a(0), 6, normal.a);
    if (row->ib >= 0) std::copy_n(row->b(0), 6, normal.b);
    normal.W = row->W[0];
    normal.wanted = is_swept ? error : std::min(error, cap);
    normal.lambda = 0.0;
    normal.is_bounce = row->is_bounce;
    if (runs_.empty() || runs_.back().a != row->ia || runs_.back().b != row->ib) {
      runs_.push_back({row->ia, row->ib, count_, count_});
      for (const int body : {row->ia, row->ib}) {
        if (body >= 0) has_moved_[static_cast<std::size_t>(body)] = 0;
      }
    }
    runs_.back().end = ++count_;
    const bool is_to_visit = normal.wanted > 0.0 || normal.is_bounce;
    if (is_to_visit && (visited_.empty() || visited_.back() != runs_.size() - 1)) visited_.push_back(runs_.size() - 1);
  }
  return worst;
}

/// The runs to visit next, in their order.
void PositionCorrection::take_moved() {
  const char* has_moved = has_moved_.data();
  const auto slot = [last = has_moved_.size() - 1](int body) {
    return body >= 0 ? static_cast<std::size_t>(body) : last;
  };
  visited_.clear();
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    if ((has_moved[slot(runs_[i].a)] | has_moved[slot(runs_[i].b)]) != 0) visited_.push_back(i);
  }
  for (const std::size_t i : visited_) has_moved_[slot(runs_[i].a)] = has_moved_[slot(runs_[i].b)] = 0;
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
  for (std::size_t i = run.first; i < run.end; ++i) {
    Normal& normal = normals_[i];
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

double PositionCorrection::sweep(const Sweep& sweep, double* shift) {
  double largest = 0.0;
  for (const std::size_t i : visited_) {
    const Run& run = runs_[i];
    const double change = visit(run, sweep, shift);
    largest = std::max(largest, change);
    if (change <= sweep.least) continue;
    for (const int body : {run.a, run.b}) {
      if (body >= 0) has_moved_[static_cast<std::size_t>(body)] = 1;
    }
  }
  return largest;
}

void PositionCorrection::run(const StepSettings& settings, const Row* first, const Row* end, const Contact* contacts,
                             const double* u, bool is_infeasible, double* shift) noexcept {
  const double worst = find_errors(settings, first, end, contacts, u);
  if (worst <= settings.position_slop) return;
  const bool is_heap = runs_.size() > kHeap;
  const double least = std::max(0.1 * settings.position_slop, is_heap ? kPrecision * worst : 0.0);
  const int most = is_infeasible || worst <= kLarge ? kSweeps : kMostSweeps;
  double change = 0.0;
  for (int i = 0; i < kSweeps || (change > kCoarse && i < most); ++i) {
    change = sweep({i < kSweeps, is_heap && i >= kPlainSweeps ? kRelaxation : 1.0, least}, shift);
    if (change <= least) break;
    take_moved();
  }
}

}  // namespace snug::physics::internal
