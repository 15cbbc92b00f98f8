// PositionCorrection: errors of the rigid contacts of an island, sweeps over those that matter.
#include "snug/physics/internal/position_correction.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace

PositionCorrection::PositionCorrection(std::size_t bodies, std::size_t rows)
    : normals_(new Normal[rows]), bodies_(new Bodies[rows]), has_moved_(bodies + 1) {
  visited_.reserve(rows);
}

double PositionCorrection::find_errors(const StepSettings& settings, const Row* first, const Row* end,
                                       const Contact* contacts, const double* u) {
  const double dt = settings.dt;
  double worst = 0.0;
  count_ = 0;
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
    std::copy_n(row->a(0), 6, normal.a);
    std::copy_n(row->b(0), 6, normal.b);
    normal.W = row->W[0];
    normal.wanted = is_swept ? error : std::min(error, cap);
    normal.lambda = 0.0;
    normal.is_bounce = row->is_bounce;
    bodies_[count_] = {row->ia, row->ib};
    for (const int body : {row->ia, row->ib}) {
      if (body >= 0) has_moved_[static_cast<std::size_t>(body)] = 0;
    }
    if (normal.wanted > 0.0 || normal.is_bounce) visited_.push_back(count_);
    ++count_;
  }
  return worst;
}

/// The normals to visit next, in their order.
void PositionCorrection::take_moved() {
  const char* has_moved = has_moved_.data();
  const auto slot = [last = has_moved_.size() - 1](int body) {
    return body >= 0 ? static_cast<std::size_t>(body) : last;
  };
  visited_.clear();
  for (std::size_t i = 0; i < count_; ++i) {
    if ((has_moved[slot(bodies_[i].a)] | has_moved[slot(bodies_[i].b)]) != 0) visited_.push_back(i);
  }
  for (const std::size_t i : visited_) has_moved_[slot(bodies_[i].a)] = has_moved_[slot(bodies_[i].b)] = 0;
}

/// Returns the change of the normal's displacement, m.
double PositionCorrection::visit(std::size_t i, bool is_bounce_pulled, double* shift) {
  Normal& normal = normals_[i];
  double* a = bodies_[i].a >= 0 ? shift + 6 * bodies_[i].a : nullptr;
  double* b = bodies_[i].b >= 0 ? shift + 6 * bodies_[i].b : nullptr;
  Pair moved{};
  if (a != nullptr) moved = dot(normal.a, a);
  if (b != nullptr) moved += dot(normal.b, b);
  double lambda = normal.lambda + (normal.wanted - (moved[0] + moved[1])) / normal.W;
  if (!normal.is_bounce || !is_bounce_pulled) lambda = std::max(0.0, lambda);
  const double d = lambda - normal.lambda;
  if (d == 0.0) return 0.0;
  normal.lambda = lambda;
  const Pair d2{d, d};
  for (int k = 0; k < 6; k += 2) {
    if (a != nullptr) store(a + k, load(a + k) + load(normal.a + k) * d2);
    if (b != nullptr) store(b + k, load(b + k) + load(normal.b + k) * d2);
  }
  return std::abs(d) * normal.W;
}

double PositionCorrection::sweep(bool is_bounce_pulled, double least, double* shift) {
  double largest = 0.0;
  for (const std::size_t i : visited_) {
    const double change = visit(i, is_bounce_pulled, shift);
    largest = std::max(largest, change);
    if (change <= least) continue;
    for (const int body : {bodies_[i].a, bodies_[i].b}) {
      if (body >= 0) has_moved_[static_cast<std::size_t>(body)] = 1;
    }
  }
  return largest;
}

void PositionCorrection::run(const StepSettings& settings, const Row* first, const Row* end, const Contact* contacts,
                             const double* u, double* shift) noexcept {
  const double worst = find_errors(settings, first, end, contacts, u);
  if (worst <= settings.position_slop) return;
  const double least = 0.1 * settings.position_slop;
  double change = 0.0;
  for (int i = 0; i < kSweeps || (worst > kLarge && change > kCoarse && i < kMostSweeps); ++i) {
    change = sweep(i < kSweeps, least, shift);
    if (change <= least) break;
    take_moved();
  }
}

}  // namespace snug::physics::internal
