// Contact Newton: solves the contacts of islands on which Gauss-Seidel converges slowly. docs/theory/contact.md,
// section 4.
#include "snug/physics/internal/contact_newton.hpp"

#include <algorithm>
#include <cmath>

#include "snug/physics/internal/panel_kernels.hpp"

namespace snug::physics::internal {
namespace {

// Chosen on some 550 problems on which sweeps fail (a settling pile of 300 boxes, random drops at mass ratios to 1000,
// a wall): least time among those with which all of them are solved.
constexpr int kCycles = 4;             ///< generalized steps that are tried in any case
constexpr int kSweepsPerCycle = 2;     ///< of Gauss-Seidel after each
constexpr int kSweepsAnew = 20;        ///< before the steps of a second try
constexpr double kPenalty = 600.0;     ///< of generalized steps, in units of 1 / W of each contact
constexpr double kFlipCut = 5.0;       ///< of the penalty of a contact whose status changes from step to step
constexpr double kFlipRecovery = 1.5;  ///< of the penalty of one whose status stays
constexpr double kLeastFlipPenalty = 1.0;
/// Of contacts whose status stays in islands that are solved and at rest: what a step leaves of a slow mode is 1 / p.
constexpr double kSolvedPenalty = 3e4;
constexpr double kSolvedGrowth = 30.0;

constexpr int kLeastClustered = 30;        ///< rows, of islands that are looked at in parts
constexpr int kClusterRounds = 20;         ///< parts solved, each time with one more ring of bodies around them
constexpr double kClusterResidual = 0.5;   ///< of the tolerance, to which parts are solved
constexpr int kCyclesWithoutClusters = 1;  ///< generalized steps where more than half is unsolved

constexpr int kMaxPatchRows = 8;  ///< whose products are made at once

constexpr double kFirstPenalty = 30.0;  ///< of the augmented Lagrangian, in units of 1 / W
constexpr double kLeastPenalty = 0.3;
constexpr double kLargestPenalty = 1e8;
constexpr double kGrowth = 3.0;  ///< of the penalty after a solved stage, and its cut after a failed one
constexpr int kMaxStageIterations = 20;
constexpr int kTriedAgain = 2;  ///< generalized steps after a stage that gains much

/// How thoroughly the augmented Lagrangian is solved.
struct Care {
  double stage_error;  ///< of the residual, to which a stage is solved
  int max_halvings;
  int max_iterations;
  double gain;  ///< of the residual by a stage, after which generalized steps are tried again
};
constexpr Care kQuick{0.1, 3, 150, 0.3};
constexpr Care kThorough{0.01, 6, 300, 0.0};  ///< where that fails
constexpr Care kLast{0.001, 12, 300, 0.0};    ///< where that ends near the tolerance
constexpr double kNear = 10.0;                ///< of the tolerance

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// M += the block whose columns lie behind each other at `stride`.
void add_block(const PanelBlock& M, const double* block, std::ptrdiff_t stride) {
  if (M.is_transposed) {
    for (int j = 0; j < 6; ++j, block += stride) {
      for (int i = 0; i < 6; ++i) M.data[j + i * M.stride] += block[i];
    }
    return;
  }
  double* column = M.data;
  for (int j = 0; j < 6; ++j, column += M.stride, block += stride) {
    for (int i = 0; i < 6; i += 2) store(column + i, load(column + i) + load(block + i));
  }
}

/// slope * rows.
void multiply(const double (&slope)[9], const double (&rows)[3][6], double* out) {
  for (int i = 0; i < 3; ++i) {
    const Pair s0{slope[3 * i], slope[3 * i]}, s1{slope[3 * i + 1], slope[3 * i + 1]},
        s2{slope[3 * i + 2], slope[3 * i + 2]};
    for (int k = 0; k < 6; k += 2) {
      store(out + 6 * i + k, load(rows[0] + k) * s0 + load(rows[1] + k) * s1 + load(rows[2] + k) * s2);
    }
  }
}

/// Of the normal axis, 1/kg. Turning rows have none; the largest penalty then makes the law of their known impulse.
double rigid_mobility(const Row& row) { return std::max(row.W[0] - row.gamma, 1e-30); }

/// J u without what kinematic bodies bring in.
void change_of_velocity(const Row& row, const double* u, double (&xi)[3]) {
  contact_velocity(row, u, xi);
  for (int k = 0; k < 3; ++k) xi[k] -= row.bias[k];
}

ContactStatus open_law(AugmentedLaw& law) {
  std::fill_n(law.slope, 9, 0.0);
  std::fill_n(law.lambda, 3, 0.0);
  return ContactStatus::Open;
}

/// Law of one step of Alart and Curnier's generalized Newton method: the status is that of the natural map, the law of
/// that status is linearised about the present impulse and velocity. law.lambda is its answer at xi.
ContactStatus generalized_law(const Row& row, double penalty, const double (&xi)[3], AugmentedLaw& law) {
  (void)open_law(law);
  const double* lambda = row.lambda;
  const double normal = xi[0] - row.target + row.gamma * lambda[0];
  const double z0 = lambda[0] - normal / row.W[0];
  if (z0 <= 0.0) return ContactStatus::Open;
  const double rigid = penalty / rigid_mobility(row);
  const double c = rigid / (1.0 + rigid * row.gamma);
  law.lambda[0] = lambda[0] - c * normal;
  law.slope[0] = c;
  const double z1 = lambda[1] - row.step_t * xi[1], z2 = lambda[2] - row.step_t * xi[2];
  const double limit = row.mu * std::max(lambda[0], z0), square = z1 * z1 + z2 * z2;
  if (square <= limit * limit) {
    const double t = penalty * row.step_t;
    law.lambda[1] = lambda[1] - t * xi[1], law.lambda[2] = lambda[2] - t * xi[2];
    law.slope[4] = law.slope[8] = t;
    return ContactStatus::Sticks;
  }
  // Along z the friction is at its limit. Across, lambda = limit/|z| (lambda - s xi) is solved for lambda.
  const double length = std::sqrt(square);
  const double d1 = z1 / length, d2 = z2 / length;
  const double share = std::min(limit / length, 1.0 - 1.0 / penalty);
  const double s = share * row.step_t / (1.0 - share);
  const double across = s * (d1 * xi[2] - d2 * xi[1]);
  law.lambda[1] = row.mu * law.lambda[0] * d1 + across * d2;
  law.lambda[2] = row.mu * law.lambda[0] * d2 - across * d1;
  law.slope[3] = row.mu * d1 * c, law.slope[6] = row.mu * d2 * c;
  law.slope[4] = s * d2 * d2;
  law.slope[5] = law.slope[7] = -s * d1 * d2;
  law.slope[8] = s * d1 * d1;
  return ContactStatus::Slides;
}

/// One island: its rows, the velocities of its bodies, scratch. The impulses with the least residual are kept.
class IslandProblem {
 public:
  IslandProblem(const Residuals& residuals, Row* first, Row* end, double* u, NewtonScratch& work)
      : tolerance_(residuals.accepted), wanted_(residuals.wanted), first_(first), end_(end), u_(u), work_(work) {}

  /// False: the linear system fills beyond memory.
  bool start();
  int solve();

 private:
  template <class Visit>
  void each_row(Visit&& visit) {
    NewtonRow* newton = work_.rows.get();
    for (Row* row = first_; row != end_; ++row, ++newton) visit(*row, *newton);
  }
  [[nodiscard]] Eigen::Map<const Vector6> error_of(int body) const {
    return Eigen::Map<const Vector6>(work_.error.data() + 6 * body);
  }
  [[nodiscard]] bool is_solved() const { return best_ <= tolerance_; }
  void apply_impulses();
  void measure();
  void keep_best();
  void restore_best();
  void assemble();
  void add_patch(const NewtonPatch& patch);
  void solve_system();
  void take_linear_impulses();

  void solve_from_here();
  void start_anew();
  void run_cycles(int count);
  void solve_clusters();
  void linearise();

  void augment(const Care& care);
  bool solve_stage(double penalty, double tolerance, const Care& care);
  double evaluate(double penalty);
  double search_line(double penalty, double error, int max_halvings);

  double tolerance_, wanted_;
  Row* first_;
  Row* end_;
  double* u_;
  NewtonScratch& work_;
  double residual_ = 0.0, best_ = 0.0;
  int iterations_ = 0;
  int sweeps_ = 0;
};

bool IslandProblem::start() {
  for (const int body : work_.active) work_.local[at(body)] = -1;  // of the island before
  work_.active.clear();
  for (const Row* row = first_; row != end_; ++row) {
    for (const int body : {row->ia, row->ib}) {
      if (body < 0 || work_.local[at(body)] >= 0) continue;
      work_.local[at(body)] = static_cast<int>(work_.active.size());
      work_.active.push_back(body);
      std::copy_n(u_ + 6 * body, 6, work_.u_free.data() + 6 * body);
    }
  }
  work_.solver.begin(static_cast<int>(work_.active.size()));
  work_.patches.clear();
  const Row* last = nullptr;
  each_row([&](Row& row, NewtonRow& newton) {
    const double d[3] = {-row.lambda[0], -row.lambda[1], -row.lambda[2]};
    apply(row, d, work_.u_free.data());
    if (last == nullptr || last->ia != row.ia || last->ib != row.ib || work_.patches.back().count == kMaxPatchRows) {
      const bool is_pair = row.ia >= 0 && row.ib >= 0;
      const int connection = is_pair ? work_.solver.connect(work_.local[at(row.ia)], work_.local[at(row.ib)]) : -1;
      work_.patches.push_back({static_cast<int>(&row - first_), 0, connection, {}, {}, {}, {}});
    }
    ++work_.patches.back().count;
    last = &row;
    newton.penalty = kPenalty;
    newton.status = ContactStatus::Unknown;
    std::copy_n(row.lambda, 3, newton.best);
    row.is_changed = true;
  });
  residual_ = best_ = worst_residual(first_, end_, u_);
  if (!work_.solver.analyze()) return false;
  for (NewtonPatch& patch : work_.patches) {
    const Row& row = first_[patch.first];
    if (row.ia >= 0) patch.aa = work_.solver.diagonal(work_.local[at(row.ia)]);
    if (row.ib >= 0) patch.bb = work_.solver.diagonal(work_.local[at(row.ib)]);
    if (patch.connection < 0) continue;
    const BlockSolver::Coupling coupling = work_.solver.coupling(patch.connection);
    patch.ab = coupling.ij, patch.ba = coupling.ji;
  }
  return true;
}

/// u from the impulses of the rows.
void IslandProblem::apply_impulses() {
  for (const int body : work_.active) std::copy_n(work_.u_free.data() + 6 * body, 6, u_ + 6 * body);
  for (const Row* row = first_; row != end_; ++row) apply(*row, row->lambda, u_);
}

void IslandProblem::measure() {
  residual_ = 0.0;
  each_row([&](const Row& row, NewtonRow& newton) {
    newton.residual = natural_map(row, u_);
    residual_ = std::max(residual_, newton.residual);
  });
  keep_best();
}

void IslandProblem::keep_best() {
  if (!(residual_ < best_)) return;
  best_ = residual_;
  each_row([](const Row& row, NewtonRow& newton) { std::copy_n(row.lambda, 3, newton.best); });
}

void IslandProblem::restore_best() {
  if (residual_ <= best_) return;
  each_row([](Row& row, const NewtonRow& newton) { std::copy_n(newton.best, 3, row.lambda); });
  apply_impulses();
  residual_ = best_;
}

/// I + sum (J T)^T slope (J T), in blocks of the island's bodies.
void IslandProblem::assemble() {
  work_.solver.set_identity();
  for (const NewtonPatch& patch : work_.patches) add_patch(patch);
  work_.solver.factorize();
}

/// What the contacts of one pair of bodies bring in: [a b]^T slope a and [a b]^T slope b, each one product.
void IslandProblem::add_patch(const NewtonPatch& patch) {
  alignas(64) double left[3 * kMaxPatchRows * 12], force_a[3 * kMaxPatchRows * 6], force_b[3 * kMaxPatchRows * 6];
  alignas(64) double product[12 * 6];
  const Row* row = first_ + patch.first;
  const NewtonRow* newton = work_.rows.get() + patch.first;
  const bool is_pair = patch.connection >= 0;
  const int width = is_pair ? 12 : 6;
  int depth = 0;
  for (int i = 0; i < patch.count; ++i, ++row, ++newton) {
    const double(&slope)[9] = newton->law.slope;
    if (slope[0] <= 0.0) continue;
    const double(&own)[3][6] = row->ia >= 0 ? row->a : row->b;
    double* to = left + depth * width;
    for (int k = 0; k < 3; ++k, to += width) {
      std::copy_n(own[k], 6, to);
      if (is_pair) std::copy_n(row->b[k], 6, to + 6);
    }
    multiply(slope, own, force_a + 6 * depth);
    if (is_pair) multiply(slope, row->b, force_b + 6 * depth);
    depth += 3;
  }
  if (depth == 0) return;
  set_product({width, depth, left, width, force_a, 1, 6, product, width});
  if (!is_pair) return add_block(first_[patch.first].ia >= 0 ? patch.aa : patch.bb, product, width);
  add_block(patch.aa, product, width);
  add_block(patch.ba, product + 6, width);
  set_product({width, depth, left, width, force_b, 1, 6, product, width});
  add_block(patch.ab, product, width);
  add_block(patch.bb, product + 6, width);
}

/// step = A^-1 error.
void IslandProblem::solve_system() {
  const std::size_t count = work_.active.size();
  for (std::size_t i = 0; i < count; ++i) {
    std::copy_n(work_.error.data() + 6 * work_.active[i], 6, work_.right.data() + 6 * i);
  }
  work_.solver.solve(work_.right.data());
  for (std::size_t i = 0; i < count; ++i) {
    std::copy_n(work_.right.data() + 6 * i, 6, work_.step.data() + 6 * work_.active[i]);
  }
}

/// Residuals of the present state, laws about it, and the momentum error that these leave.
void IslandProblem::linearise() {
  for (const int body : work_.active) {
    for (int k = 6 * body; k < 6 * body + 6; ++k) work_.error[at(k)] = work_.u_free[at(k)] - u_[k];
  }
  residual_ = 0.0;
  each_row([&](const Row& row, NewtonRow& newton) {
    double xi[3] = {};
    const bool is_open = stays_open(row, u_);
    if (!is_open) contact_velocity(row, u_, xi);
    newton.residual = is_open ? 0.0 : natural_map(row, xi, row.lambda);
    residual_ = std::max(residual_, newton.residual);
    const ContactStatus before = newton.status;
    newton.status = is_open ? open_law(newton.law) : generalized_law(row, newton.penalty, xi, newton.law);
    if (before != ContactStatus::Unknown) {
      if (before != newton.status) {
        newton.penalty = std::max(kLeastFlipPenalty, std::min(kPenalty, newton.penalty) / kFlipCut);
        if (!is_open) (void)generalized_law(row, newton.penalty, xi, newton.law);
      } else {
        newton.penalty = is_solved() ? std::min(kSolvedPenalty, newton.penalty * kSolvedGrowth)
                                     : std::min(kPenalty, newton.penalty * kFlipRecovery);
      }
    }
    if (!is_open) apply(row, newton.law.lambda, work_.error.data());
  });
  keep_best();
}

/// Impulses of the linear laws for work_.step, cut to the cone, and u from them.
void IslandProblem::take_linear_impulses() {
  for (const int body : work_.active) std::copy_n(work_.u_free.data() + 6 * body, 6, u_ + 6 * body);
  each_row([&](Row& row, const NewtonRow& newton) {
    const double(&slope)[9] = newton.law.slope;
    double* lambda = row.lambda;
    std::fill_n(lambda, 3, 0.0);
    if (slope[0] <= 0.0) return;
    double xi[3];
    change_of_velocity(row, work_.step.data(), xi);
    const double normal = newton.law.lambda[0] - slope[0] * xi[0];
    if (normal <= 0.0) return;
    lambda[0] = normal;
    for (int i = 1; i < 3; ++i) {
      lambda[i] = newton.law.lambda[i] - (slope[3 * i] * xi[0] + slope[3 * i + 1] * xi[1] + slope[3 * i + 2] * xi[2]);
    }
    project_to_disc(row.mu * normal, lambda[1], lambda[2]);
    apply(row, row.lambda, u_);
  });
}

/// Generalized Newton steps with sweeps between them, which mend what the steps leave near single contacts.
void IslandProblem::run_cycles(int count) {
  for (int i = 0; i < count && best_ > wanted_; ++i) {
    linearise();
    if (best_ <= wanted_) return;
    ++iterations_;
    assemble();
    solve_system();
    take_linear_impulses();
    for (int k = 0; k < kSweepsPerCycle; ++k) (void)sweep_rows(first_, end_, u_, sweeps_++ % 2 == 0);
  }
  measure();
}

/// Momentum error u - u_free - sum (J T)^T lambda(u) of every body at work.u; returns its norm.
double IslandProblem::evaluate(double penalty) {
  for (const int body : work_.active) {
    for (int k = 6 * body; k < 6 * body + 6; ++k) work_.error[at(k)] = work_.u[at(k)] - work_.u_free[at(k)];
  }
  each_row([&](const Row& row, NewtonRow& newton) {
    double xi[3];
    contact_velocity(row, work_.u.data(), xi);
    augmented_law(row, penalty / rigid_mobility(row), penalty * row.step_t, newton.center, xi, newton.law);
    if (newton.law.lambda[0] <= 0.0) return;
    const double d[3] = {-newton.law.lambda[0], -newton.law.lambda[1], -newton.law.lambda[2]};
    apply(row, d, work_.error.data());
  });
  double square = 0.0;
  for (const int body : work_.active) square += error_of(body).squaredNorm();
  return std::sqrt(square);
}

/// Moves along the Newton step until the momentum error shrinks. Returns the new error, negative when it does not.
double IslandProblem::search_line(double penalty, double error, int max_halvings) {
  for (const int body : work_.active) std::copy_n(work_.u.data() + 6 * body, 6, work_.u_start.data() + 6 * body);
  double length = 1.0;
  for (int halving = 0; halving < max_halvings; ++halving, length *= 0.5) {
    for (const int body : work_.active) {
      for (int k = 6 * body; k < 6 * body + 6; ++k) work_.u[at(k)] = work_.u_start[at(k)] - length * work_.step[at(k)];
    }
    const double next = evaluate(penalty);
    if (next < (1.0 - 1e-4 * length) * error) return next;
  }
  return -1.0;
}

/// Newton's method for the augmented law with the present centres and penalty.
bool IslandProblem::solve_stage(double penalty, double tolerance, const Care& care) {
  double error = evaluate(penalty);
  for (int i = 0; i < kMaxStageIterations; ++i) {
    if (error <= tolerance) return true;
    ++iterations_;
    assemble();
    solve_system();
    error = search_line(penalty, error, care.max_halvings);
    if (error < 0.0) return false;
  }
  return error <= tolerance;
}

/// The augmented Lagrangian: slower, and the one that always worked. Where a stage gains much, statuses are nearly
/// right, and generalized steps end it.
void IslandProblem::augment(const Care& care) {
  double mobility = 0.0;  // turns momentum errors into velocities
  each_row([&](const Row& row, NewtonRow&) {
    mobility = std::max({mobility, row.W[0] - row.gamma, row.W[3], row.W[5]});
  });
  const int last = iterations_ + care.max_iterations;
  for (double penalty = kFirstPenalty; iterations_ < last && penalty > kLeastPenalty && !is_solved();) {
    each_row([](const Row& row, NewtonRow& newton) { std::copy_n(row.lambda, 3, newton.center); });
    for (const int body : work_.active) std::copy_n(u_ + 6 * body, 6, work_.u.data() + 6 * body);
    if (!solve_stage(penalty, std::min(0.1 * tolerance_, care.stage_error * residual_) / std::sqrt(mobility), care)) {
      penalty /= kGrowth;
      continue;
    }
    each_row([](Row& row, const NewtonRow& newton) { std::copy_n(newton.law.lambda, 3, row.lambda); });
    apply_impulses();
    const double before = best_;
    measure();
    penalty = std::min(kLargestPenalty, penalty * kGrowth);
    if (is_solved() || best_ >= care.gain * before) continue;
    restore_best();
    run_cycles(kTriedAgain);
    restore_best();
  }
  restore_best();
}

/// A few contacts keep changing their status while all others are solved: these are solved among themselves, then a
/// generalized step carries what that changes to the rest.
void IslandProblem::solve_clusters() {
  ClusterScratch& clusters = *work_.clusters;
  const Residuals residuals{kClusterResidual * tolerance_, kClusterResidual * tolerance_};
  int rings = 0;
  for (int round = 0; round < kClusterRounds && !is_solved(); ++round) {
    if (!clusters.rows.find(first_, work_.rows.get(), work_.patches, tolerance_, rings)) {
      run_cycles(kCyclesWithoutClusters);
      rings = std::max(0, rings - 1);
      continue;
    }
    ++rings;
    for (std::size_t i = 0; i < clusters.rows.count(); ++i) {
      const std::span<Row> rows = clusters.rows[i];
      (void)newton_rows(residuals, rows.data(), rows.data() + rows.size(), u_, clusters.newton);
    }
    clusters.rows.put_back(first_);
    measure();
    if (!is_solved()) run_cycles(1);
  }
}

/// Back to no impulses and a few sweeps: where steps cycle without end depends on where they began.
void IslandProblem::start_anew() {
  each_row([](Row& row, NewtonRow& newton) {
    std::fill_n(row.lambda, 3, 0.0);
    newton.penalty = kPenalty;
    newton.status = ContactStatus::Unknown;
  });
  apply_impulses();
  for (int i = 0; i < kSweepsAnew; ++i) (void)sweep_rows(first_, end_, u_, i % 2 == 0);
}

/// What solves nearly all problems.
void IslandProblem::solve_from_here() {
  run_cycles(kCycles);
  if (!is_solved() && work_.clusters && end_ - first_ >= kLeastClustered) solve_clusters();
  restore_best();
  if (!is_solved()) augment(kQuick);
}

int IslandProblem::solve() {
  if (!std::isfinite(best_)) return 0;  // the caller says so
  solve_from_here();
  if (!is_solved()) {
    start_anew();
    solve_from_here();
  }
  if (!is_solved()) augment(kThorough);
  if (!is_solved() && best_ <= kNear * tolerance_) augment(kLast);
  return iterations_;
}

}  // namespace

NewtonScratch::NewtonScratch(std::size_t bodies, std::size_t row_capacity, int levels)
    : solver(bodies, row_capacity), rows(new NewtonRow[row_capacity]) {
  if (levels > 0) {
    clusters.reset(new ClusterScratch{{bodies, row_capacity}, {bodies, row_capacity, levels - 1}});
  }
  for (std::vector<double>* v : {&u, &u_free, &u_start, &error, &step, &right}) v->assign(6 * bodies, 0.0);
  local.assign(bodies, -1);
  active.reserve(bodies);
  patches.reserve(row_capacity);
}

NewtonScratch::~NewtonScratch() = default;
NewtonScratch::NewtonScratch(NewtonScratch&&) noexcept = default;

int newton_rows(const Residuals& residuals, Row* first, Row* end, double* u, NewtonScratch& work) noexcept {
  IslandProblem problem(residuals, first, end, u, work);
  if (!problem.start()) return 0;
  return problem.solve();
}

}  // namespace snug::physics::internal
