// SceneSearch: on the mean cost without derivatives, on residuals with differences.
#include "snug/identification/internal/scene_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "snug/core/rng.hpp"
#include "snug/identification/internal/scene_motion.hpp"
#include "snug/numerics/bounded_search.hpp"
#include "snug/numerics/dense.hpp"

namespace snug::identification::internal {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kRescuePoints = 20;       // scattered for each free parameter when a fit fails
constexpr double kFirstSubplex = 0.05;  // of the span
constexpr double kAlways = std::numeric_limits<double>::infinity();
constexpr std::array kHorizons = {0.125, 0.25, 0.5, 0.75};  // of a recording, fitted before all of it
constexpr int kRounds = 4;                                  // over all of it, at most
constexpr double kSettled = 1.0, kSettledLast = 0.1;        // of a sum of squares, where a search ends
constexpr double kStepDeviations = 3.0;                     // of differences, in standard errors
constexpr double kLeastStep = 1e-3;                         // of the step that a task names
constexpr double kMostStep = 0.05;                          // of the span
constexpr double kMoreRows = 1.02;                          // of those of the last round, for another one
constexpr double kLarger = 6.0;                             // steps, where what they do is rough
constexpr double kLongSimulation = 1000.0;                  // s, for one difference of each parameter: then secants
constexpr int kSecantSteps = 10;                            // of a search with secants, a simulation each
constexpr double kGoodEnough = 1.2;                         // misfit, for no other start to be tried

std::string identity_of(const SceneExperiment& experiment) {
  const model::SceneTask& task = experiment.task();
  std::string what = task.text;
  for (const RecordedMotion& motion : experiment.motions()) {
    what += motion.name;
    for (const RecordedBody& body : motion.tracked)
      for (const record::PoseSample& pose : body.poses)
        what.append(reinterpret_cast<const char*>(pose.p.data()), sizeof(double) * 3);
  }
  return what;
}

}  // namespace

std::vector<MotionError> evaluate_all(const SceneExperiment& experiment, const Eigen::VectorXd& values) {
  const std::vector<Eigen::VectorXd> points{values};
  const std::size_t count = experiment.motions().size();
  std::vector<SceneExperiment::Job> jobs(count);
  for (std::size_t m = 0; m < count; ++m) jobs[m].motion = m;
  std::vector<MotionError> now = experiment.evaluate(points, jobs);
  const Eigen::VectorXd deviation = experiment.own_deviation();
  if (deviation.size() == 0) return now;
  // Levenberg-Marquardt of each recording alone, all recordings in step.
  constexpr int kIterations = 8;
  constexpr double kSettled = 1e-9;  // of a sum of squares
  numerics::BatchedProblem problem;
  std::vector<Eigen::VectorXd> own;
  for (std::size_t m = 0; m < count; ++m) {
    problem.terms.push_back(experiment.term_of(m));
    own.push_back(problem.terms.back().own);
  }
  const auto errors_of = [&](const std::vector<numerics::BatchedProblem::Job>& batch) {
    std::vector<SceneExperiment::Job> jobs_of_batch;
    for (const numerics::BatchedProblem::Job& job : batch) jobs_of_batch.push_back({0, job.term, job.own});
    return experiment.evaluate(points, jobs_of_batch);
  };
  problem.evaluate = [&](const std::vector<numerics::BatchedProblem::Job>& batch) {
    std::vector<Eigen::VectorXd> residuals;
    for (MotionError& error : errors_of(batch)) residuals.push_back(std::move(error.residuals));
    return residuals;
  };
  std::vector<double> damping(count, 1e-3);
  bool is_settled = false;
  for (int iteration = 0; iteration < kIterations && !is_settled; ++iteration) {
    const numerics::BatchedDerivatives at = numerics::differentiate(problem, {}, own);
    std::vector<numerics::BatchedProblem::Job> tried;
    for (std::size_t m = 0; m < count; ++m) {
      tried.push_back({m, {}, own[m]});
      const Eigen::MatrixXd& J = at.jacobians[m];
      if (J.cols() == 0) continue;
      Eigen::MatrixXd normal = numerics::transposed_product(J, J);
      normal.diagonal() *= 1.0 + damping[m];
      tried[m].own -= numerics::solve_symmetric(normal, numerics::transposed_product(J, at.residuals[m])).col(0);
    }
    std::vector<MotionError> then = errors_of(tried);
    is_settled = true;
    for (std::size_t m = 0; m < count; ++m) {
      const double before = now[m].residuals.squaredNorm(), after = then[m].residuals.squaredNorm();
      const bool is_better = then[m].failure.empty() && now[m].failure.empty() && after < before;
      damping[m] *= is_better ? 0.1 : 10.0;
      is_settled = is_settled && std::abs(before - after) <= kSettled * before;
      if (!is_better) continue;
      own[m] = tried[m].own;
      now[m] = std::move(then[m]);
    }
  }
  return now;
}

SceneSearch::SceneSearch(const SceneExperiment& experiment, const SceneFitOptions& options,
                         std::vector<std::size_t> free)
    : experiment_(experiment),
      options_(options),
      free_(std::move(free)),
      best_(experiment.start()),
      best_cost_(std::numeric_limits<double>::infinity()),
      log_(options.log, options.log.empty() ? std::string() : identity_of(experiment)) {
  const auto each = static_cast<std::size_t>(experiment.task().search.held_back);
  const std::size_t count = experiment.motions().size();
  holds_ends_ = each > 0 && count < each && experiment.task().loss == model::TaskLoss::Squares &&
                !experiment.task().only_final_state;
  for (std::size_t m = 0; m < count; ++m)
    (each > 0 && count >= each && m % each == each - 1 ? held_ : fitted_).push_back(m);
  std::vector<double> ends;
  for (const std::size_t m : fitted_) {
    const std::vector<double>& times = experiment.motions()[m].times;
    ends.push_back(holds_ends_ ? times.back() - (times.back() - times.front()) / static_cast<double>(each) : kAlways);
  }
  fitted_rows_ = rows_until(experiment, fitted_, ends);
  restrict_to(std::vector<std::size_t>(free_));
}

void SceneSearch::restrict_to(const std::vector<std::size_t>& free) {
  free_ = free;
  const auto n = static_cast<Eigen::Index>(free_.size());
  lower_.resize(n), upper_.resize(n), step_.resize(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const model::TaskParameter& parameter = experiment_.task().parameters[free_[static_cast<std::size_t>(j)]];
    lower_[j] = parameter.low, upper_[j] = parameter.high, step_[j] = parameter.step;
  }
}

Eigen::VectorXd SceneSearch::full(const Eigen::VectorXd& free_values) const {
  Eigen::VectorXd values = best_;
  for (std::size_t j = 0; j < free_.size(); ++j)
    values[static_cast<Eigen::Index>(free_[j])] = free_values[static_cast<Eigen::Index>(j)];
  return values;
}

Eigen::VectorXd SceneSearch::free_of(const Eigen::VectorXd& values) const {
  Eigen::VectorXd result(static_cast<Eigen::Index>(free_.size()));
  for (std::size_t j = 0; j < free_.size(); ++j)
    result[static_cast<Eigen::Index>(j)] = values[static_cast<Eigen::Index>(free_[j])];
  return result;
}

SceneSearch::Fitted SceneSearch::unfitted(const Eigen::VectorXd& start) const {
  Fitted at;
  at.x = start;
  at.step = step_;
  for (const std::size_t m : fitted_) at.own.push_back(experiment_.term_of(m).own);
  at.rows = at.straight = fitted_rows_;
  return at;
}

numerics::BatchedProblem SceneSearch::problem(const Fitted& at, double until, const Eigen::VectorXd& prior) const {
  numerics::BatchedProblem problem;
  problem.start = at.x;
  problem.lower = lower_, problem.upper = upper_, problem.step = at.step;
  for (std::size_t i = 0; i < fitted_.size(); ++i) {
    problem.terms.push_back(experiment_.term_of(fitted_[i]));
    problem.terms.back().own = at.own[i];
  }
  if (prior.size() > 0) problem.terms.push_back({prior.size(), {}, {}, {}});
  problem.evaluate = [this, until, prior, rows = at.rows,
                      start = at.x](const std::vector<numerics::BatchedProblem::Job>& batch) {
    std::vector<Eigen::VectorXd> points;
    std::vector<SceneExperiment::Job> jobs;
    for (const numerics::BatchedProblem::Job& job : batch) {
      if (job.term >= fitted_.size()) continue;
      // Jobs of one point stand near each other.
      const Eigen::VectorXd values = full(job.shared);
      std::size_t place = points.size();
      for (std::size_t back = 1; back <= std::min<std::size_t>(3, points.size()); ++back)
        if (points[points.size() - back] == values) place = points.size() - back;
      if (place == points.size() && !points.empty() && points.front() == values) place = 0;
      if (place == points.size()) points.push_back(values);
      jobs.push_back({place, fitted_[job.term], job.own});
    }
    evaluations_ += static_cast<int>(points.size());
    if (options_.progress) options_.progress({evaluations_, best_cost_, "least squares"});
    std::vector<MotionError> errors = experiment_.evaluate(points, jobs, until);
    std::vector<Eigen::VectorXd> residuals;
    std::size_t next = 0;
    for (const numerics::BatchedProblem::Job& job : batch) {
      if (job.term >= fitted_.size()) {
        residuals.emplace_back((job.shared - start).cwiseQuotient(prior));
        continue;
      }
      Eigen::VectorXd& r = errors[next++].residuals;
      keep_rows(experiment_, fitted_[job.term], rows[job.term], r);
      residuals.push_back(std::move(r));
    }
    return residuals;
  };
  return problem;
}

Neighbourhood SceneSearch::look_around(const Fitted& at, double until) const {
  Neighbourhood found;
  const auto n = static_cast<std::size_t>(at.x.size());
  found.span.resize(at.x.size());
  found.up.resize(n), found.down.resize(n), found.is_between.resize(n);
  std::vector<std::size_t> all(n);
  std::iota(all.begin(), all.end(), std::size_t{0});
  look(at, until, all, found);
  return found;
}

void SceneSearch::look(const Fitted& at, double until, const std::vector<std::size_t>& along,
                       Neighbourhood& found) const {
  std::vector<Eigen::VectorXd> points{full(at.x)};
  for (const std::size_t k : along) {
    const auto j = static_cast<Eigen::Index>(k);
    const double up = std::min(at.x[j] + at.step[j], upper_[j]), down = std::max(at.x[j] - at.step[j], lower_[j]);
    found.span[j] = up - down;
    found.is_between[k] = up > at.x[j] && down < at.x[j];
    for (const double value : {up, down}) {
      Eigen::VectorXd x = at.x;
      x[j] = value;
      points.push_back(full(x));
    }
  }
  std::vector<SceneExperiment::Job> jobs;
  for (std::size_t p = 0; p < points.size(); ++p)
    for (std::size_t i = 0; i < fitted_.size(); ++i) jobs.push_back({p, fitted_[i], at.own[i]});
  evaluations_ += static_cast<int>(points.size());
  if (options_.progress) options_.progress({evaluations_, best_cost_, "least squares"});
  std::vector<MotionError> errors = experiment_.evaluate(points, jobs, until);
  const auto take = [&](std::size_t point) {
    std::vector<Eigen::VectorXd> residuals;
    for (std::size_t i = 0; i < fitted_.size(); ++i)
      residuals.push_back(std::move(errors[point * fitted_.size() + i].residuals));
    return residuals;
  };
  found.middle = take(0);
  for (std::size_t k = 0; k < along.size(); ++k) {
    found.up[along[k]] = take(1 + 2 * k);
    found.down[along[k]] = take(2 + 2 * k);
  }
}

SceneSearch::Straight SceneSearch::find_straight_rows(double until, const RowCounts& within, bool may_widen,
                                                      Fitted& at) const {
  Straight found{look_around(at, until), within};
  if (std::ranges::any_of(found.around.middle, [](const Eigen::VectorXd& r) { return r.size() == 0; })) return found;
  std::vector<bool> is_bent;
  found.rows = find_straight(experiment_, fitted_, found.around, within, is_bent);
  if (!may_widen) return found;
  // What is rough from near may be straight at large.
  Fitted wider = at;
  std::vector<std::size_t> along;
  for (std::size_t k = 0; k < is_bent.size(); ++k) {
    const auto j = static_cast<Eigen::Index>(k);
    const double most = kMostStep * (upper_[j] - lower_[j]);
    if (!is_bent[k] || at.step[j] >= most) continue;
    wider.step[j] = std::min(kLarger * at.step[j], most);
    along.push_back(k);
  }
  if (along.empty()) return found;
  Neighbourhood wide = found.around;
  look(wider, until, along, wide);
  const RowCounts rows = find_straight(experiment_, fitted_, wide, within, is_bent);
  if (total(rows) <= total(found.rows)) return found;
  at.step = wider.step;
  return {std::move(wide), rows};
}

SceneSearch::Derivatives SceneSearch::differentiate() const {
  Fitted start = unfitted(free_of(best_));
  start.rows = find_straight_rows(kAlways, fitted_rows_, false, start).rows;
  const numerics::BatchedDerivatives found = numerics::differentiate(problem(start, kAlways, {}), start.x, start.own);
  const Eigen::Index n = start.x.size();
  Derivatives result{numerics::shared_information(found, n), Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
  const model::SceneTask& task = experiment_.task();
  const int positions = task.use_position ? 3 : 0;
  double samples = 0.0;
  for (std::size_t i = 0; i < found.jacobians.size(); ++i) {
    const Eigen::MatrixXd& J = found.jacobians[i];
    if (J.cols() < n) continue;
    const std::vector<SceneExperiment::BodyRows> bodies = experiment_.rows_of(fitted_[i]);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      for (Eigen::Index row = 0; row < start.rows[i][b]; ++row) {
        Eigen::VectorXd& sum = row % bodies[b].each < positions ? result.position_rms : result.rotation_rms;
        sum += J.row(bodies[b].first + row).head(n).transpose().cwiseAbs2();
      }
      samples += count_samples(fitted_[i], b, 0, start.rows[i][b]);
    }
  }
  const double rotation_noise = task.position_noise / task.rotation_position_ratio;
  result.position_rms = task.position_noise * (result.position_rms / std::max(1.0, samples)).cwiseSqrt();
  result.rotation_rms = rotation_noise * (result.rotation_rms / std::max(1.0, samples)).cwiseSqrt();
  return result;
}

double SceneSearch::count_samples(std::size_t motion, std::size_t body, Eigen::Index begin, Eigen::Index end) const {
  const SceneExperiment::BodyRows rows = experiment_.rows_of(motion)[body];
  double count = 0.0;
  for (Eigen::Index row = begin; row < end; row += rows.each)
    count += averaged_at(experiment_.motions()[motion].tracked[body],
                         (*rows.samples)[static_cast<std::size_t>(row / rows.each)]);
  return count;
}

void SceneSearch::take(const Eigen::VectorXd& free_values, double cost, const char* phase) {
  if (cost < best_cost_) {
    best_ = full(free_values);
    best_cost_ = cost;
  }
  if (options_.progress) options_.progress({evaluations_, best_cost_, phase});
}

std::vector<double> SceneSearch::costs(const std::vector<Eigen::VectorXd>& points, const char* phase) {
  std::vector<double> result(points.size(), kNaN);
  std::vector<std::size_t> open;
  std::vector<Eigen::VectorXd> values;
  std::vector<SceneExperiment::Job> jobs;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::VectorXd all = full(points[i]);
    if (const auto known = log_.find(all)) {
      result[i] = *known;
      continue;
    }
    for (const std::size_t m : fitted_) jobs.push_back({values.size(), m, {}});
    open.push_back(i);
    values.push_back(all);
  }
  const std::vector<MotionError> errors = experiment_.evaluate(values, jobs);
  for (std::size_t k = 0; k < open.size(); ++k) {
    double sum = 0.0;
    for (std::size_t m = 0; m < fitted_.size(); ++m) sum += experiment_.cost_of(errors[k * fitted_.size() + m]);
    result[open[k]] = sum / static_cast<double>(fitted_.size());
    log_.add(values[k], result[open[k]]);
  }
  evaluations_ += static_cast<int>(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) take(points[i], result[i], phase);
  return result;
}

double SceneSearch::cost(const Eigen::VectorXd& point, const char* phase) { return costs({point}, phase).front(); }

std::vector<Eigen::VectorXd> SceneSearch::scattered(int count) const {
  Rng rng = Rng(experiment_.task().search.seed).split("scatter");
  std::vector<Eigen::VectorXd> points(static_cast<std::size_t>(count), Eigen::VectorXd(lower_.size()));
  for (Eigen::Index j = 0; j < lower_.size(); ++j) {
    std::vector<int> order(static_cast<std::size_t>(count));
    std::iota(order.begin(), order.end(), 0);
    for (int i = count - 1; i > 0; --i)
      std::swap(order[static_cast<std::size_t>(i)], order[static_cast<std::size_t>(rng.index(i + 1))]);
    for (std::size_t i = 0; i < points.size(); ++i)
      points[i][j] = lower_[j] + (upper_[j] - lower_[j]) * (order[i] + rng.uniform()) / count;
  }
  return points;
}

std::string SceneSearch::search_distance() {
  const model::SearchSettings& settings = experiment_.task().search;
  (void)cost(free_of(best_), "start");
  if (settings.scatter > 0) (void)costs(scattered(settings.scatter), "scatter");
  numerics::SearchOptions search;
  search.seed = settings.seed;
  std::string message = "nothing was searched";
  if (settings.global > 0) {
    search.method = numerics::SearchMethod::ControlledRandom;
    search.evaluations = settings.global;
    const auto global = [this](const Eigen::VectorXd& x) { return cost(x, "global"); };
    message = "global: " + numerics::minimize_bounded(global, free_of(best_), lower_, upper_, search).message;
  }
  if (settings.local > 0) {
    search.method = numerics::SearchMethod::Subplex;
    search.evaluations = settings.local;
    search.step = kFirstSubplex * (upper_ - lower_);
    const auto local = [this](const Eigen::VectorXd& x) { return cost(x, "local"); };
    const numerics::SearchResult found = numerics::minimize_bounded(local, free_of(best_), lower_, upper_, search);
    message = (settings.global > 0 ? message + "; local: " : "local: ") + found.message;
  }
  return message;
}

bool SceneSearch::solve_stage(double horizon, bool is_last, Eigen::MatrixXd& covariance, Fitted& at) const {
  std::vector<double> ends;
  for (const std::size_t m : fitted_) {
    const std::vector<double>& times = experiment_.motions()[m].times;
    ends.push_back(is_last ? kAlways : times.front() + horizon * (times.back() - times.front()));
  }
  const double until = *std::max_element(ends.begin(), ends.end());
  const auto [around, straight] =
      find_straight_rows(until, fewer(fitted_rows_, rows_until(experiment_, fitted_, ends)), true, at);
  at.straight = straight;
  if (std::ranges::any_of(around.middle, [](const Eigen::VectorXd& r) { return r.size() == 0; })) return false;
  // What nothing is known of yet may be far off and still come near.
  at.rows =
      covariance.size() > 0 ? fewer(at.straight, find_followed(experiment_, fitted_, around, covariance)) : at.straight;
  const Eigen::VectorXd prior = is_last ? Eigen::VectorXd() : Eigen::VectorXd(0.5 * (upper_ - lower_));
  numerics::BatchedOptions options;
  const auto each = static_cast<int>(2 * free_.size() + 1);
  options.max_iterations = std::max(1, experiment_.task().search.local / each);
  options.tolerance = (is_last ? kSettledLast : kSettled) / std::max(1.0, total(at.rows));
  options.secants = each * std::min(until, experiment_.longest()) > kLongSimulation;
  if (options.secants) options.max_iterations = std::max(options.max_iterations, kSecantSteps);
  const numerics::BatchedProblem from = problem(at, until, prior);
  const numerics::BatchedResult found = numerics::solve_batched(from, options);
  at.message = found.message;
  if (found.information.size() == 0) return false;
  at.x = found.x;
  at.own.assign(found.own.begin(), found.own.begin() + static_cast<std::ptrdiff_t>(fitted_.size()));
  at.derivatives = found.at;
  const double misfit = std::max(1.0, found.cost / std::max(1.0, total(at.rows)));
  const auto scale = step_.asDiagonal();  // units differ by orders
  covariance = misfit * (scale * numerics::invert_symmetric(scale * found.information * scale) * scale);
  const Eigen::VectorXd deviation = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  at.step = (kStepDeviations * deviation)
                .cwiseMax(kLeastStep * step_)
                .cwiseMin(step_.cwiseMax(kMostStep * (upper_ - lower_)));
  at.is_solved = true;
  return true;
}

SceneSearch::Fitted SceneSearch::least_squares_from(const Eigen::VectorXd& start) const {
  Fitted at = unfitted(start);
  Eigen::MatrixXd covariance;
  if (!experiment_.task().only_final_state) {
    for (const double horizon : kHorizons)
      if (!solve_stage(horizon, false, covariance, at)) return at;
  }
  // More rows count as parameters come nearer, and steps are as small as what they are known to.
  for (int round = 0; round < kRounds; ++round) {
    const double before = total(at.rows);
    if (!solve_stage(1.0, true, covariance, at)) return at;
    if (round > 0 && total(at.rows) <= kMoreRows * before) break;
  }
  const auto [around, straight] = find_straight_rows(kAlways, fitted_rows_, false, at);
  at.straight = excused(experiment_, fitted_, around, fewer(at.rows, straight), fitted_rows_);
  return at;
}

double SceneSearch::bounded_misfit(const Fitted& at) const {
  constexpr double kMost = 100.0;  // of a number: what is farther off is off
  std::vector<SceneExperiment::Job> jobs;
  for (std::size_t i = 0; i < fitted_.size(); ++i) jobs.push_back({0, fitted_[i], at.own[i]});
  const std::vector<Eigen::VectorXd> points{full(at.x)};
  std::vector<MotionError> errors = experiment_.evaluate(points, jobs);
  double sum = 0.0;
  for (std::size_t i = 0; i < fitted_.size(); ++i) {
    if (!errors[i].failure.empty()) return std::numeric_limits<double>::infinity();
    keep_rows(experiment_, fitted_[i], at.straight[i], errors[i].residuals);
    sum += errors[i].residuals.cwiseAbs2().cwiseMin(kMost).sum();
  }
  return sum / std::max(1.0, total(at.straight));
}

std::string SceneSearch::search_squares(double rescue) {
  const model::SearchSettings& settings = experiment_.task().search;
  const Eigen::VectorXd start = free_of(best_);
  double least = std::numeric_limits<double>::infinity();
  std::string message;
  const auto go_from = [&](const Eigen::VectorXd& from) {
    Fitted found = least_squares_from(from);
    const double misfit = found.is_solved ? bounded_misfit(found) : std::numeric_limits<double>::infinity();
    if (message.empty()) message = found.is_solved ? found.message : "no simulation from there: " + found.message;
    if (!(misfit < least)) return;
    least = misfit;
    best_ = full(found.x);
    message = found.message;
    result_ = std::move(found);
  };
  go_from(start);
  int points = settings.scatter;
  if (points == 0 && least > rescue) points = kRescuePoints * static_cast<int>(free_.size());
  if (points == 0) return message;
  const Eigen::VectorXd after_first = best_;
  // The three best of the points scattered are starts of their own.
  const std::vector<Eigen::VectorXd> tried = scattered(points);
  best_cost_ = std::numeric_limits<double>::infinity();
  const std::vector<double> found = costs(tried, "scatter");
  std::vector<std::size_t> order(tried.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return found[a] < found[b]; });
  best_ = after_first;
  for (std::size_t k = 0; k < std::min<std::size_t>(3, order.size()) && least > kGoodEnough; ++k)
    go_from(tried[order[k]]);
  return message;
}

double SceneSearch::chi2_per_dof(const std::vector<MotionError>& errors) const {
  const RowCounts& rows = result_ ? result_->straight : fitted_rows_;
  double sum = 0.0;
  for (std::size_t i = 0; i < fitted_.size(); ++i) {
    const MotionError& error = errors[fitted_[i]];
    if (!error.failure.empty()) return std::numeric_limits<double>::infinity();
    Eigen::VectorXd r = error.residuals;
    keep_rows(experiment_, fitted_[i], rows[i], r);
    sum += r.squaredNorm();
  }
  return sum / std::max(1.0, total(rows) - static_cast<double>(free_.size()));
}

SplitErrors SceneSearch::errors_at(const Eigen::VectorXd& values) const {
  std::vector<MotionError> errors = evaluate_all(experiment_, values);
  if (result_ && values == best_) {  // what they have of their own was fitted to the rows that can be predicted
    std::vector<SceneExperiment::Job> jobs;
    for (std::size_t i = 0; i < fitted_.size(); ++i) jobs.push_back({0, fitted_[i], result_->own[i]});
    std::vector<MotionError> fitted = experiment_.evaluate(std::vector<Eigen::VectorXd>{values}, jobs);
    for (std::size_t i = 0; i < fitted_.size(); ++i) errors[fitted_[i]] = std::move(fitted[i]);
  }
  const auto pick = [&](const std::vector<std::size_t>& list) {
    std::vector<MotionError> some;
    for (const std::size_t m : list) some.push_back(errors[m]);
    return experiment_.summarize(some);
  };
  SplitErrors split;
  split.fitted = pick(fitted_);
  split.held_back_error = kNaN;
  if (!held_.empty()) {
    split.held_back = pick(held_);
    split.held_back_error = split.held_back.cost;
  } else if (holds_ends_) {
    double sum = 0.0, samples = 0.0;
    for (std::size_t i = 0; i < fitted_.size(); ++i) {
      const Eigen::VectorXd& r = errors[fitted_[i]].residuals;
      const std::vector<SceneExperiment::BodyRows> bodies = experiment_.rows_of(fitted_[i]);
      for (std::size_t b = 0; b < bodies.size() && r.size() > 0; ++b) {
        const Eigen::Index begin = fitted_rows_[i][b], count = bodies[b].count - begin;
        sum += r.segment(bodies[b].first + begin, count).squaredNorm();
        samples += count_samples(fitted_[i], b, begin, bodies[b].count);
      }
    }
    split.held_back_error = 1e3 * experiment_.task().position_noise * std::sqrt(sum / std::max(1.0, samples));
  }
  split.chi2_per_dof = chi2_per_dof(errors);
  return split;
}

std::vector<Unpredictable> SceneSearch::unpredictable() const {
  std::vector<Unpredictable> list;
  for (std::size_t i = 0; result_ && i < fitted_.size(); ++i) {
    const RecordedMotion& motion = experiment_.motions()[fitted_[i]];
    const std::vector<SceneExperiment::BodyRows> bodies = experiment_.rows_of(fitted_[i]);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const Eigen::Index used = result_->straight[i][b];
      if (used < fitted_rows_[i][b])
        list.push_back({motion.name, motion.tracked[b].body,
                        motion.times[(*bodies[b].samples)[static_cast<std::size_t>(used / bodies[b].each)]]});
    }
  }
  return list;
}

Eigen::MatrixXd SceneSearch::covariance() {
  Eigen::MatrixXd of_free;
  if (experiment_.task().loss == model::TaskLoss::Distance) {
    of_free = distance_covariance();
  } else {
    const Fitted at = result_ ? *result_ : unfitted(free_of(best_));
    const double chi2 = errors_at(best_).chi2_per_dof;
    const numerics::BatchedProblem there = problem(at, kAlways, {});
    of_free =
        numerics::squares_covariance(there, result_ ? at.derivatives : numerics::differentiate(there, at.x, at.own)) *
        std::max(1.0, std::isfinite(chi2) ? chi2 : 1.0);
  }
  const auto all = static_cast<Eigen::Index>(experiment_.task().parameters.size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(all, all);
  for (std::size_t i = 0; i < free_.size(); ++i)
    for (std::size_t j = 0; j < free_.size(); ++j)
      result(static_cast<Eigen::Index>(free_[i]), static_cast<Eigen::Index>(free_[j])) =
          of_free(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  return result;
}

Eigen::VectorXd SceneSearch::curvature_steps(const Eigen::VectorXd& middle) {
  // The cost is rough, and its curvature is seen only where it rises by more than that: steps double until it does.
  constexpr double kRise = 0.05;  // of the cost
  Eigen::VectorXd h = (5.0 * step_).cwiseMin(0.25 * (upper_ - lower_));
  const Eigen::VectorXd most = 0.25 * (upper_ - lower_);
  const double least = cost(middle, "standard errors");
  for (bool grows = true; grows;) {
    std::vector<Eigen::VectorXd> points;
    for (Eigen::Index i = 0; i < h.size(); ++i) {
      for (const double sign : {1.0, -1.0}) {
        points.push_back(middle);
        points.back()[i] = std::clamp(points.back()[i] + sign * h[i], lower_[i], upper_[i]);
      }
    }
    const std::vector<double> found = costs(points, "standard errors");
    grows = false;
    for (Eigen::Index i = 0; i < h.size(); ++i) {
      const auto at = static_cast<std::size_t>(2 * i);
      if (0.5 * (found[at] + found[at + 1]) - least >= kRise * least || h[i] >= most[i]) continue;
      h[i] = std::min(2.0 * h[i], most[i]);
      grows = true;
    }
  }
  return h;
}

Eigen::MatrixXd SceneSearch::distance_covariance() {
  // An M-estimate: C = H^-1 S H^-1 / N, S the scatter of the recordings' slopes, H the curvature of the mean
  // (docs/theory/identification.md, 9). In units of the steps h.
  const Eigen::VectorXd found = best_;  // what is tried here is no search
  const Eigen::VectorXd h = curvature_steps(free_of(found));
  best_ = found;
  const Eigen::VectorXd x = free_of(found).cwiseMax(lower_ + h).cwiseMin(upper_ - h);  // all points are within bounds
  const auto n = x.size();
  const auto count = static_cast<Eigen::Index>(fitted_.size());
  std::vector<Eigen::VectorXd> points{full(x)};
  const auto add = [&](Eigen::Index i, Eigen::Index j, double sign) {
    Eigen::VectorXd y = x;
    y[i] += sign * h[i];
    if (j != i) y[j] += sign * h[j];
    points.push_back(full(y));
  };
  for (Eigen::Index i = 0; i < n; ++i)
    for (const double sign : {1.0, -1.0}) add(i, i, sign);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < i; ++j)
      for (const double sign : {1.0, -1.0}) add(i, j, sign);
  std::vector<SceneExperiment::Job> jobs;
  for (std::size_t p = 0; p < points.size(); ++p)
    for (const std::size_t m : fitted_) jobs.push_back({p, m, {}});
  evaluations_ += static_cast<int>(points.size());
  const std::vector<MotionError> errors = experiment_.evaluate(points, jobs);
  const auto cost_at = [&](Eigen::Index point, Eigen::Index motion) {
    return experiment_.cost_of(errors[static_cast<std::size_t>(point * count + motion)]);
  };
  Eigen::MatrixXd slopes(count, n), H(n, n);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(points.size()));
  for (Eigen::Index p = 0; p < mean.size(); ++p)
    for (Eigen::Index m = 0; m < count; ++m) mean[p] += cost_at(p, m) / static_cast<double>(count);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index m = 0; m < count; ++m) slopes(m, i) = 0.5 * (cost_at(1 + 2 * i, m) - cost_at(2 + 2 * i, m));
    H(i, i) = mean[1 + 2 * i] - 2.0 * mean[0] + mean[2 + 2 * i];
  }
  Eigen::Index p = 1 + 2 * n;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < i; ++j, p += 2) {
      // f(+,+) + f(-,-) - f(+i) - f(-i) - f(+j) - f(-j) + 2 f = 2 H_ij
      const double sum =
          mean[p] + mean[p + 1] - mean[1 + 2 * i] - mean[2 + 2 * i] - mean[1 + 2 * j] - mean[2 + 2 * j] + 2.0 * mean[0];
      H(i, j) = H(j, i) = 0.5 * sum;
    }
  }
  slopes.rowwise() -= slopes.colwise().mean().eval();
  const Eigen::MatrixXd S =
      numerics::transposed_product(slopes, slopes) / std::max(1.0, static_cast<double>(count - 1));
  // A direction with less than a tenth of the curvature of the axes is not seen above the roughness: it gets that much.
  const numerics::Eigenpairs eigen = numerics::symmetric_eigenpairs(H);
  const double least = std::max(0.1 * H.diagonal().cwiseMax(0.0).mean(), 1e-12);
  const Eigen::VectorXd inverse = eigen.values.unaryExpr([least](double v) { return 1.0 / std::max(v, least); });
  const Eigen::MatrixXd H_inverse = numerics::congruence(eigen.vectors, inverse.asDiagonal());
  return numerics::scaled(numerics::congruence(H_inverse, S), h) / static_cast<double>(count);
}

}  // namespace snug::identification::internal
