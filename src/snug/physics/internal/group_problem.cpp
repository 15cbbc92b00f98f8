// Group problem: Newton's method on one group of rows. docs/theory/contact.md, section 4.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "snug/physics/internal/chunks.hpp"
#include "snug/physics/internal/contact_newton.hpp"
#include "snug/physics/internal/packed_sweeps.hpp"

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
constexpr double kClusterResidual = 0.5;   ///< of the tolerance, to which parts are solved
constexpr int kCyclesWithoutClusters = 1;  ///< generalized steps where more than half is unsolved

// Large groups: least time on 37 problems of settling piles of 300 and 1000 boxes.
constexpr int kLargeGroup = 400;   ///< rows
constexpr int kFirstSweeps = 120;  ///< with momentum, in place of generalized steps
/// Sweeps for each row of the group, where these are more: large heaps are deep, and Newton's method on what too few
/// sweeps leave takes long (docs/decisions/0146). Beyond the most, contacts that slide only swing (0148).
constexpr double kSweepsPerRow = 0.03;
constexpr int kMostFirstSweeps = 320;
constexpr double kFewUnsolved = 0.01;   ///< of its rows: then these sweeps end, since clusters are quicker
constexpr int kSweepsAround = 12;       ///< after clusters
constexpr double kMostClustered = 0.5;  ///< of the rows, in any case

/// How clusters of a group are looked for. Where they would be too large, sweeps come again.
struct ClusterSearch {
  int rounds;        ///< parts solved, each time with one more ring of bodies around them
  int again;         ///< times that sweeps come where clusters would be larger than `most`
  double most;       ///< of the rows of the group
  std::size_t each;  ///< rows of a cluster that grows; 0: rings are the same for all
};
constexpr ClusterSearch kSearch{20, 0, kMostClustered, 0}, kSearchLarge{20, 2, 0.1, 0};
/// Chosen on heaps of 3000 boxes.
constexpr ClusterSearch kSearchVast{60, 10, 0.1, 600};
constexpr int kVastGroup = 6000;  ///< rows
constexpr int kRoundsARun = 6;    ///< of clusters in such a group; the last has kFirstSweeps for the smooth error
constexpr int kCalmSweeps = 30;   ///< with little momentum, of a long run in such a group
/// Rows from which on factors of the whole would take minutes.
constexpr int kHugeGroup = 16000;
/// Sweeps from velocities that are made of the impulses again, with momentum from zero on: what many sweeps round off,
/// or leave swinging, passes the tolerance. A long run in such a group ends with them (docs/decisions/0152); a run in a
/// part consists of them (0153).
constexpr int kFreshSweeps = 20;
constexpr double kMostMomentum = 0.97;
/// Of the tolerance: large groups at rest are solved as far as sweeps in single precision go.
constexpr double kSingleResidual = 0.1;
constexpr double kStillSweep = 0.3;  ///< of the residual wanted: a change after which a sweep is the last

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
constexpr Care kLast{0.001, 20, 1000, 0.0};   ///< where that ends near the tolerance
constexpr double kNear = 100.0;               ///< of the tolerance

/// Penalty, in units of 1 / W, under which the least violation of all contacts is looked for: its impulses cancel on
/// each body to about 1 / penalty where they are a proof.
constexpr double kProofPenalty = 1e6;
/// A proof holds for velocities up to this many times those at hand: wedges that escape faster count as stuck.
constexpr double kFastEscape = 100.0;
constexpr double kProved = 10.0;  ///< of the tolerance: the least violation that a proof shows

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// J u without what kinematic bodies bring in.
void change_of_velocity(const Row& row, const double* u, double (&xi)[3]) {
  contact_velocity(row, u, xi);
  for (int k = 0; k < 3; ++k) xi[k] -= row.bias[k];
}

/// One group: its rows, the velocities of its bodies, scratch. The impulses with the least residual are kept.
class GroupProblem {
 public:
  GroupProblem(const Residuals& residuals, std::span<Row> rows, double* u, GroupScratch& work, OpenGroup* open_group)
      : tolerance_(residuals.accepted),
        wanted_(residuals.wanted),
        first_(rows.data()),
        end_(rows.data() + rows.size()),
        u_(u),
        work_(work),
        steps_(*work.steps),
        open_group_(open_group),
        threads_(std::ssize(rows) >= kSharedGroup ? work.threads : nullptr) {}

  int solve(bool is_nearly_solved);

 private:
  template <class Visit>
  void each_row(Visit&& visit) {
    NewtonRow* newton = work_.rows.get();
    for (Row* row = first_; row != end_; ++row, ++newton) visit(*row, *newton);
  }
  /// The same with what steps take the laws for.
  template <class Visit>
  void each_law(Visit&& visit) {
    NewtonLaw* law = steps_.laws.get();
    for (Row* row = first_; row != end_; ++row, ++law) visit(*row, *law);
  }
  [[nodiscard]] std::span<const int> bodies() const { return work_.system.bodies(); }
  [[nodiscard]] std::size_t row_count() const { return static_cast<std::size_t>(end_ - first_); }
  [[nodiscard]] bool is_solved() const { return best_ <= tolerance_; }
  void start();
  void add_row(Row& row);
  std::size_t wake();
  void apply_impulses();
  void measure();
  void measure_rows();
  void measure_round();
  void keep_best();
  void restore_best();
  bool take_step();
  void take_linear_impulses();

  void solve_from_here(bool is_nearly_solved);
  void start_anew();
  void run_cycles(int count);
  void run_sweeps(int count, double few);
  bool run_packed_sweeps(int count, double few);
  void take_momentum(double momentum);
  /// m/s, residual that sweeps in single precision are asked for
  [[nodiscard]] double within_reach() const { return std::max(wanted_, kSingleResidual * tolerance_); }
  /// Whether factors of the whole cost more than many sweeps.
  [[nodiscard]] bool is_large() const { return work_.clusters != nullptr && end_ - first_ >= kLargeGroup; }
  /// What generalized steps, sweeps and its own parts leave of it is left to the whole: the augmented Lagrangian would
  /// take longer than many sweeps of that.
  [[nodiscard]] bool is_large_part() const { return work_.is_part && end_ - first_ >= kLargeGroup; }
  /// Newton's method on the whole would take minutes: what clusters leave of it is left.
  [[nodiscard]] bool is_huge() const { return is_large() && end_ - first_ >= kHugeGroup && !presses(); }
  [[nodiscard]] int first_sweeps() const {
    return std::clamp(static_cast<int>(kSweepsPerRow * static_cast<double>(row_count())), kFirstSweeps,
                      kMostFirstSweeps);
  }
  /// Large groups are swept in halves, by any number of threads.
  [[nodiscard]] const Vector3* centres() const { return end_ - first_ >= kSharedGroup ? work_.centres : nullptr; }
  [[nodiscard]] WorkerPool* pool() const { return pool_of(threads_); }
  [[nodiscard]] bool find_clusters(const ClusterSearch& search, bool has_limits, int rings);
  void solve_clusters();
  void solve_each(const Residuals& residuals, ClusterScratch& clusters);
  void linearise();

  void augment(const Care& care);
  bool solve_stage(double penalty, double tolerance, const Care& care);
  void relax_law(const Row& row, NewtonLaw& newton, double penalty);
  double evaluate(double penalty);
  double search_line(double penalty, double error, int max_halvings);
  bool presses() const;
  bool is_infeasible();
  void share_violation();

  double tolerance_, wanted_;
  Row* first_;
  Row* end_;
  double* u_;
  GroupScratch& work_;
  StepScratch& steps_;
  OpenGroup* open_group_;
  const SolverThreads* threads_;  ///< that it may use, or nullptr: others are solved beside it
  double residual_ = 0.0, best_ = 0.0;
  bool has_room_ = true;   ///< for the linear system
  bool is_proof_ = false;  ///< only rigid contacts, without friction
  int iterations_ = 0;
  int sweeps_ = 0;
  std::ptrdiff_t packed_rows_ = 0;  ///< that steps_.packed holds; -1: it cannot
  std::int64_t packing_ = 0;        ///< in which it took them; later ones are of other groups
};

void GroupProblem::add_row(Row& row) {
  const std::size_t known = bodies().size();
  work_.system.add_row(row);
  for (const int body : bodies().subspan(known)) std::copy_n(u_ + 6 * body, 6, work_.u_free.data() + 6 * body);
  const double d[3] = {-row.lambda[0], -row.lambda[1], -row.lambda[2]};
  apply(row, d, work_.u_free.data());
  NewtonRow& newton = work_.rows[static_cast<std::size_t>(&row - first_)];
  newton.penalty = kPenalty;
  newton.status = ContactStatus::Unknown;
  std::copy_n(row.lambda, 3, newton.best);
}

void GroupProblem::start() {
  work_.system.begin();
  for (Row* row = first_; row != end_; ++row) add_row(*row);
  residual_ = best_ = worst_residual(threads_, first_, end_, u_);
}

/// Takes in the idle contacts that close. Returns how many.
std::size_t GroupProblem::wake() {
  if (open_group_ == nullptr) return 0;
  const std::size_t count = open_group_->wake(u_, pool());
  for (std::size_t i = 0; i < count; ++i) add_row(*end_++);
  return count;
}

/// u from the impulses of the rows.
void GroupProblem::apply_impulses() {
  for (const int body : bodies()) std::copy_n(work_.u_free.data() + 6 * body, 6, u_ + 6 * body);
  internal::apply_impulses(first_, end_, u_, pool());
}

void GroupProblem::measure() {
  (void)wake();
  measure_rows();
}

/// Between rounds of clusters in a large group: rounding of velocities and idle contacts are looked at only where all
/// seems solved.
void GroupProblem::measure_round() {
  if (!is_large()) return measure();
  measure_rows();
  if (!is_solved()) return;
  apply_impulses();
  (void)wake();
  best_ = std::numeric_limits<double>::infinity();
  measure_rows();
}

void GroupProblem::measure_rows() {
  residual_ = largest_of_ranges(pool(), row_count(), [this](std::size_t first, std::size_t end) {
    double largest = 0.0;
    for (std::size_t i = first; i < end; ++i) {
      double& residual = work_.rows[i].residual;
      residual = natural_map(first_[i], u_);
      largest = std::max(largest, residual);
    }
    return largest;
  });
  keep_best();
}

void GroupProblem::keep_best() {
  if (!(residual_ < best_)) return;
  best_ = residual_;
  for_ranges(pool(), row_count(), [this](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) std::copy_n(first_[i].lambda, 3, work_.rows[i].best);
  });
}

void GroupProblem::restore_best() {
  if (residual_ <= best_) return;
  each_row([](Row& row, const NewtonRow& newton) { std::copy_n(newton.best, 3, row.lambda); });
  apply_impulses();
  residual_ = best_;
}

/// Residuals of the present state, laws about it, and the momentum error that these leave.
void GroupProblem::linearise() {
  (void)wake();
  for (const int body : bodies()) {
    for (int k = 6 * body; k < 6 * body + 6; ++k) steps_.error[at(k)] = work_.u_free[at(k)] - u_[k];
  }
  residual_ = 0.0;
  each_row([&](const Row& row, NewtonRow& newton) {
    LinearLaw& law = steps_.laws[static_cast<std::size_t>(&row - first_)].law;
    double xi[3] = {};
    const bool is_open = stays_open(row, u_);
    if (!is_open) contact_velocity(row, u_, xi);
    newton.residual = is_open ? 0.0 : natural_map(row, xi, row.lambda);
    residual_ = std::max(residual_, newton.residual);
    const ContactStatus before = newton.status;
    newton.status = is_open ? open_law(law) : generalized_law(row, newton.penalty, xi, law);
    if (before != ContactStatus::Unknown) {
      if (before != newton.status) {
        newton.penalty = std::max(kLeastFlipPenalty, std::min(kPenalty, newton.penalty) / kFlipCut);
        if (!is_open) (void)generalized_law(row, newton.penalty, xi, law);
      } else {
        newton.penalty = is_solved() ? std::min(kSolvedPenalty, newton.penalty * kSolvedGrowth)
                                     : std::min(kPenalty, newton.penalty * kFlipRecovery);
      }
    }
    if (!is_open) apply(row, law.lambda, steps_.error.data());
  });
  keep_best();
}

/// steps_.step from the laws and steps_.error. False: the system fills beyond memory.
bool GroupProblem::take_step() {
  ++iterations_;
  has_room_ = work_.system.factorize(first_, steps_.laws.get());
  if (has_room_) work_.system.solve(steps_.error.data(), steps_.step.data());
  return has_room_;
}

/// Impulses of the linear laws for steps_.step, cut to the cone, and u from them.
void GroupProblem::take_linear_impulses() {
  for (const int body : bodies()) std::copy_n(work_.u_free.data() + 6 * body, 6, u_ + 6 * body);
  each_law([&](Row& row, const NewtonLaw& newton) {
    const double(&slope)[9] = newton.law.slope;
    double* lambda = row.lambda;
    std::fill_n(lambda, 3, 0.0);
    if (slope[0] <= 0.0) return;
    double xi[3];
    change_of_velocity(row, steps_.step.data(), xi);
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
void GroupProblem::run_cycles(int count) {
  for (int i = 0; i < count && best_ > wanted_ && has_room_; ++i) {
    linearise();
    if (best_ <= wanted_ || !take_step()) return;
    take_linear_impulses();
    for (int k = 0; k < kSweepsPerCycle; ++k) (void)sweep_rows(first_, end_, u_, sweeps_++ % 2 == 0);
  }
  measure();
}

/// Moves the velocities on by what the last sweep changed of them: these are linear in the impulses.
void GroupProblem::take_momentum(double momentum) {
  for (const int body : bodies()) {
    for (int k = 6 * body; k < 6 * body + 6; ++k) {
      const double now = u_[k];
      u_[k] = now + momentum * (now - steps_.u_start[at(k)]);
      steps_.u_start[at(k)] = now;
    }
  }
}

/// False where too many rows share a body.
bool GroupProblem::run_packed_sweeps(int count, double few) {
  if (packed_rows_ < 0) return false;
  if (packed_rows_ != end_ - first_ || packing_ != steps_.packings) {
    packing_ = ++steps_.packings;
    const bool is_packed = steps_.packed->pack(first_, work_.system.patches(), bodies(), centres(), pool());
    packed_rows_ = is_packed ? end_ - first_ : -1;
    if (!is_packed) return false;
  }
  const auto run = [&](int sweeps, int calm) {
    return steps_.packed->run(first_, u_, {sweeps, kMostMomentum, within_reach(), few, kLanes, calm}, pool());
  };
  if (work_.is_part && count > kSweepsAround) {
    for (int left = count; left > 0 && run(kFreshSweeps, 0) == kFreshSweeps; left -= kFreshSweeps) apply_impulses();
  } else if (count <= kSweepsAround || row_count() < kVastGroup) {
    (void)run(count, 0);
  } else if (row_count() < kHugeGroup) {
    (void)run(count, kCalmSweeps);
  } else if (run(count - kFreshSweeps, 0) == count - kFreshSweeps) {
    apply_impulses();
    (void)run(kFreshSweeps, 0);
  }
  return true;
}

/// Forward sweeps with Nesterov's momentum, which starts anew where a sweep goes back on it. `few`: the fraction of
/// rows that may stay unsolved.
void GroupProblem::run_sweeps(int count, double few) {
  if (run_packed_sweeps(count, few)) {
    if (count == kSweepsAround) {
      steps_.packed->add_change(bodies(), u_);
      return measure_round();
    }
    apply_impulses();
    return measure();
  }
  double* before = steps_.before.get();
  for (const Row* row = first_; row != end_; ++row, before += 3) std::copy_n(row->lambda, 3, before);
  for (const int body : bodies()) std::copy_n(u_ + 6 * body, 6, steps_.u_start.data() + 6 * body);
  double t = 1.0, momentum = 0.0;
  for (int i = 0; i < count; ++i) {
    take_momentum(momentum);
    double uphill = 0.0;
    const double change = sweep_with_momentum(first_, end_, u_, momentum, steps_.before.get(), uphill);
    if (change <= kStillSweep * wanted_) break;
    const double next = 0.5 * (1.0 + std::sqrt(1.0 + 4.0 * t * t));
    momentum = uphill > 0.0 ? 0.0 : std::min(kMostMomentum, (t - 1.0) / next);
    t = uphill > 0.0 ? 1.0 : next;
  }
  apply_impulses();  // without the rounding of all sweeps
  measure();
}

/// The augmented law at steps_.u.
void GroupProblem::relax_law(const Row& row, NewtonLaw& newton, double penalty) {
  if (is_proof_ && !(row.is_rigid && row.kind == RowKind::Contact)) {
    (void)open_law(newton.law);
    return;
  }
  double xi[3];
  contact_velocity(row, steps_.u.data(), xi);
  const double tangential = is_proof_ ? 0.0 : penalty * row.step_t;
  augmented_law(row, penalty / rigid_mobility(row), tangential, newton.center, xi, newton.law);
}

/// Momentum error u - u_free - sum (J T)^T lambda(u) of every body at steps_.u; returns its norm.
double GroupProblem::evaluate(double penalty) {
  for (const int body : bodies()) {
    for (int k = 6 * body; k < 6 * body + 6; ++k) steps_.error[at(k)] = steps_.u[at(k)] - work_.u_free[at(k)];
  }
  each_law([&](const Row& row, NewtonLaw& newton) {
    relax_law(row, newton, penalty);
    if (newton.law.lambda[0] <= 0.0) return;
    const double d[3] = {-newton.law.lambda[0], -newton.law.lambda[1], -newton.law.lambda[2]};
    apply(row, d, steps_.error.data());
  });
  double square = 0.0;
  for (const int body : bodies()) square += Eigen::Map<const Vector6>(steps_.error.data() + 6 * body).squaredNorm();
  return std::sqrt(square);
}

/// Moves along the Newton step until the momentum error shrinks. Returns the new error, negative when it does not.
double GroupProblem::search_line(double penalty, double error, int max_halvings) {
  for (const int body : bodies()) std::copy_n(steps_.u.data() + 6 * body, 6, steps_.u_start.data() + 6 * body);
  double length = 1.0;
  for (int halving = 0; halving < max_halvings; ++halving, length *= 0.5) {
    for (const int body : bodies()) {
      for (int k = 6 * body; k < 6 * body + 6; ++k)
        steps_.u[at(k)] = steps_.u_start[at(k)] - length * steps_.step[at(k)];
    }
    const double next = evaluate(penalty);
    if (next < (1.0 - 1e-4 * length) * error) return next;
  }
  return -1.0;
}

/// Newton's method for the augmented law with the present centres and penalty.
bool GroupProblem::solve_stage(double penalty, double tolerance, const Care& care) {
  double error = evaluate(penalty);
  for (int i = 0; i < kMaxStageIterations; ++i) {
    if (error <= tolerance) return true;
    if (!take_step()) return false;
    error = search_line(penalty, error, care.max_halvings);
    if (error < 0.0) return false;
  }
  return error <= tolerance;
}

/// Whether a body that the solver does not move presses on a rigid contact: without, bodies at rest (but for bounces)
/// are a solution of the normal laws.
bool GroupProblem::presses() const {
  return std::any_of(first_, end_, [&](const Row& row) {
    return row.is_rigid && row.kind == RowKind::Contact &&
           row.bias[0] < std::min(0.0, row.target) - kProved * tolerance_;
  });
}

/// Proves that no velocities satisfy the normal laws: u of the least violation is found; its impulses lambda >= 0 have
/// `J^T lambda = g`, nearly zero, and `lambda . (target - bias) = s`. Then for all u within |u| <= U the sum of lambda
/// times violations is at least `s - |g| U`, so one is at least that over the sum of lambda (Farkas' lemma).
bool GroupProblem::is_infeasible() {
  if (!presses()) return false;
  is_proof_ = true;
  double mobility = 0.0, fastest = 0.0;
  each_law([&](const Row& row, NewtonLaw& newton) {
    std::fill_n(newton.center, 3, 0.0);
    mobility = std::max(mobility, rigid_mobility(row));
    fastest = std::max(fastest, std::abs(row.bias[0] - row.target) / std::sqrt(rigid_mobility(row)));
  });
  for (const int body : bodies()) std::copy_n(u_ + 6 * body, 6, steps_.u.data() + 6 * body);
  (void)solve_stage(kProofPenalty, 1e-3 * tolerance_ / std::sqrt(mobility), kThorough);
  (void)evaluate(kProofPenalty);
  double gap = 0.0, free = 0.0, found = 0.0;  // squares
  for (const int body : bodies()) {
    for (int k = 6 * body; k < 6 * body + 6; ++k) {
      const double u = steps_.u[at(k)], u_free = work_.u_free[at(k)], g = u - u_free - steps_.error[at(k)];
      gap += g * g, free += u_free * u_free, found += u * u;
    }
  }
  double sum = 0.0, scaled = 0.0;
  each_law([&](const Row& row, const NewtonLaw& newton) {
    sum += newton.law.lambda[0];
    if (newton.law.lambda[0] > 0.0) scaled += newton.law.lambda[0] * (row.target - row.bias[0]);
  });
  is_proof_ = false;
  const double speed = kFastEscape * std::max({std::sqrt(free), std::sqrt(found), fastest});
  return scaled - std::sqrt(gap) * speed > kProved * tolerance_ * sum;
}

/// What an infeasible group is left with: contacts as stiff dampers, which share what is violated.
void GroupProblem::share_violation() {
  each_law([](const Row&, NewtonLaw& newton) { std::fill_n(newton.center, 3, 0.0); });
  for (const int body : bodies()) std::copy_n(u_ + 6 * body, 6, steps_.u.data() + 6 * body);
  (void)solve_stage(kFirstPenalty, 0.1 * tolerance_, kQuick);  // the best is kept in any case
  each_law([](Row& row, const NewtonLaw& newton) { std::copy_n(newton.law.lambda, 3, row.lambda); });
  apply_impulses();
  measure();
}

/// The augmented Lagrangian: slower, and the one that always worked. Where a stage gains much, statuses are nearly
/// right, and generalized steps end it.
void GroupProblem::augment(const Care& care) {
  double mobility = 0.0;  // turns momentum errors into velocities
  each_row([&](const Row& row, NewtonRow&) {
    mobility = std::max({mobility, row.W[0] - row.gamma, row.W[3], row.W[5]});
  });
  const int last = iterations_ + care.max_iterations;
  for (double penalty = kFirstPenalty; iterations_ < last && penalty > kLeastPenalty && has_room_ && !is_solved();) {
    each_law([](const Row& row, NewtonLaw& newton) { std::copy_n(row.lambda, 3, newton.center); });
    for (const int body : bodies()) std::copy_n(u_ + 6 * body, 6, steps_.u.data() + 6 * body);
    if (!solve_stage(penalty, std::min(0.1 * tolerance_, care.stage_error * residual_) / std::sqrt(mobility), care)) {
      if (!has_room_) break;
      penalty /= kGrowth;
      continue;
    }
    each_law([](Row& row, const NewtonLaw& newton) { std::copy_n(newton.law.lambda, 3, row.lambda); });
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

/// Clusters share no body: each can be solved by any thread.
void GroupProblem::solve_each(const Residuals& residuals, ClusterScratch& clusters) {
  const auto solve = [&](int i, int worker) {
    GroupScratch& group = worker == 0 ? clusters.group : threads_->scratches[at(worker)]->group.clusters->group;
    (void)solve_group(residuals, clusters.rows[at(i)], u_, group, nullptr, false);
  };
  const int count = static_cast<int>(clusters.rows.count());
  if (pool() != nullptr) return pool()->run(count, solve);
  for (int i = 0; i < count; ++i) solve(i, 0);
}

bool GroupProblem::find_clusters(const ClusterSearch& search, bool has_limits, int rings) {
  RowClusters& clusters = work_.clusters->rows;
  const auto of_rows = [&](double share) { return static_cast<std::size_t>(share * static_cast<double>(row_count())); };
  const std::size_t most = of_rows(has_limits ? search.most : kMostClustered);
  const auto patches = work_.system.patches();
  if (search.each == 0) return clusters.find(first_, work_.rows.get(), patches, tolerance_, rings, most, pool());
  return clusters.find_growing(first_, work_.rows.get(), patches, tolerance_, {most, has_limits ? search.each : most},
                               pool());
}

/// A few contacts keep changing their status while all others are solved: these are solved among themselves, then a
/// generalized step, or in large groups a few sweeps, carry what that changes to the rest.
void GroupProblem::solve_clusters() {
  ClusterScratch& clusters = *work_.clusters;
  const Residuals residuals{kClusterResidual * tolerance_, kClusterResidual * tolerance_};
  const ClusterSearch& search = !is_large() ? kSearch : row_count() < kVastGroup ? kSearchLarge : kSearchVast;
  clusters.rows.forget();
  int rings = is_large() ? 1 : 0, again = 0;
  for (int round = 0; round < search.rounds && !is_solved() && has_room_; ++round) {
    if (!find_clusters(search, again < search.again, rings)) {
      ++again;
      is_large() ? run_sweeps(first_sweeps(), kFewUnsolved) : run_cycles(kCyclesWithoutClusters);
      rings = std::max(0, rings - 1);
      continue;
    }
    ++rings;
    solve_each(residuals, clusters);
    clusters.rows.put_back(first_);
    measure_round();
    if (is_solved()) continue;
    const bool is_run = row_count() >= kVastGroup && round % kRoundsARun == kRoundsARun - 1;
    is_large() ? run_sweeps(is_run ? kFirstSweeps : kSweepsAround, 0.0) : run_cycles(1);
  }
}

/// Back to no impulses and a few sweeps: where steps cycle without end depends on where they began.
void GroupProblem::start_anew() {
  each_row([](Row& row, NewtonRow& newton) {
    std::fill_n(row.lambda, 3, 0.0);
    newton.penalty = kPenalty;
    newton.status = ContactStatus::Unknown;
  });
  apply_impulses();
  for (int i = 0; i < kSweepsAnew; ++i) (void)sweep_rows(first_, end_, u_, i % 2 == 0);
}

/// What solves nearly all problems.
void GroupProblem::solve_from_here(bool is_nearly_solved) {
  const bool has_parts = work_.clusters != nullptr && end_ - first_ >= kLeastClustered;
  const bool is_swept = is_large() && !presses();
  if ((is_nearly_solved && has_parts) || (is_swept && best_ <= within_reach())) {
    measure();
  } else if (is_swept) {
    run_sweeps(first_sweeps(), kFewUnsolved);
  } else {
    run_cycles(kCycles);
  }
  if (is_swept && !is_solved()) {
    solve_clusters();
    restore_best();
    // Factors of a very large group take more time and memory than to look for its clusters again.
    if (!is_solved() && !is_large_part() && row_count() < kVastGroup) run_cycles(kCycles);
  }
  work_.is_infeasible = !is_solved() && has_room_ && is_infeasible();
  if (work_.is_infeasible) share_violation();
  if (!is_solved() && !work_.is_infeasible && has_parts) solve_clusters();
  restore_best();
  if (!is_solved() && !work_.is_infeasible && !is_large_part() && !is_huge()) augment(kQuick);
}

int GroupProblem::solve(bool is_nearly_solved) {
  work_.is_infeasible = false;
  start();
  if (!std::isfinite(best_)) return 0;  // the caller says so
  solve_from_here(is_nearly_solved);
  if (is_solved() || work_.is_infeasible || is_large_part()) return iterations_;
  if (is_huge()) {
    run_sweeps(first_sweeps(), kFewUnsolved);
    solve_clusters();
    restore_best();
    return iterations_;
  }
  if (has_room_) {
    start_anew();
    solve_from_here(false);
  }
  if (!is_solved()) augment(kThorough);
  if (!is_solved() && best_ <= kNear * tolerance_) augment(kLast);
  return iterations_;
}

}  // namespace

StepScratch::StepScratch(std::size_t bodies, std::size_t rows)
    : factors(std::make_shared<FactorStore>(bodies)),
      laws(new NewtonLaw[rows]),
      before(new double[3 * rows]),
      packed(std::make_unique<PackedSweeps>(bodies, rows)) {
  for (std::vector<double>* v : {&u, &u_start, &error, &step}) v->assign(6 * bodies, 0.0);
}

StepScratch::~StepScratch() = default;

GroupScratch::GroupScratch(std::size_t bodies, std::size_t row_capacity, std::shared_ptr<StepScratch> shared,
                           int levels)
    : steps(std::move(shared)),
      system(bodies, row_capacity, steps->factors),
      rows(new NewtonRow[row_capacity]),
      u_free(6 * bodies),
      is_part(levels < kLevels) {
  if (levels > 0) clusters.reset(new ClusterScratch{{bodies, row_capacity}, {bodies, row_capacity, steps, levels - 1}});
}

GroupScratch::~GroupScratch() = default;
GroupScratch::GroupScratch(GroupScratch&&) noexcept = default;

int solve_group(const Residuals& residuals, std::span<Row> rows, double* u, GroupScratch& work, OpenGroup* open_group,
                bool is_nearly_solved) noexcept {
  GroupProblem problem(residuals, rows, u, work, open_group);
  return problem.solve(is_nearly_solved);
}

}  // namespace snug::physics::internal
