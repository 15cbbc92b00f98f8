// SceneSearch: least squares over longer and longer parts of the recordings (docs/theory/scene-identification.md, 1).
#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "snug/identification/internal/scene_search.hpp"
#include "snug/numerics/dense.hpp"

namespace snug::identification::internal {
namespace {

// Chosen on recorded programs: the decision records named say on which, and what other values did.
constexpr int kRescuePoints = 20;  // scattered for each free parameter when a fit fails (0075)
constexpr std::array kHorizons = {0.125, 0.25, 0.375, 0.5, 0.75};  // of a recording, fitted before all of it (0032)
constexpr int kRounds = 2;                                         // of a stage, at most; of the last twice as many
constexpr double kFiner = 0.2;                                     // of a step: derivatives are computed anew (0051)
// Of a sum of squares, where a search ends: a rise by 1 is one standard error, by 0.1 a third of one. With half and
// twice the first, as with half and twice kMostStep and kGoodEnough, 17 fits of scene_fit_test keep their tolerances
// (2026-11).
constexpr double kSettled = 1.0, kSettledLast = 0.1;
constexpr double kStepDeviations = 3.0;  // of differences, in standard errors (0032)
constexpr double kLeastStep = 0.4;  // of the step that a task names: with 0.1 one of seven seeds had a standard error a
                                    // thirtieth of its error (0051)
constexpr double kMostStep = 0.05;  // of the span: chosen; see kSettled
constexpr double kLarger = 6.0;     // steps, where what they do is rough (0032)
constexpr double kLongSimulation = 100.0;  // s, for one difference of each parameter: then the Jacobian stays (0051)
// Of a search with it, a simulation each: a Jacobian of five numbers takes eleven.
constexpr int kFixedJacobianSteps = 10;
constexpr int kProfileIterations = 10;
constexpr double kGoodEnough = 1.2;  // misfit, for no other start to be tried: 1 is that of noise alone; see kSettled

}  // namespace

SceneSearch::Fitted SceneSearch::unfitted(const Eigen::VectorXd& start) const {
  Fitted at;
  at.x = start;
  at.step = step_;
  for (const std::size_t m : fitted_) at.own.push_back(experiment_.term_of(m).own);
  at.rows = at.straight = fitted_rows_;
  at.weights = equal_weights(experiment_, fitted_);
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
  problem.evaluate = [this, until, prior, rows = at.rows, weights = at.weights,
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
      weigh(experiment_, fitted_[job.term], rows[job.term], weights[job.term], r);
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
  Straight found{look_around(at, until), within, at.weights};
  if (std::ranges::any_of(found.around.middle, [](const Eigen::VectorXd& r) { return r.size() == 0; })) return found;
  std::vector<bool> is_bent;
  found.rows = find_straight(experiment_, fitted_, found.around, within, is_bent, found.weights);
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
  Straight at_large{std::move(wide), within, at.weights};
  at_large.rows = find_straight(experiment_, fitted_, at_large.around, within, is_bent, at_large.weights);
  if (total(at_large.rows) <= total(found.rows)) return found;
  at.step = wider.step;
  return at_large;
}

SceneSearch::Derivatives SceneSearch::differentiate() const {
  Fitted start = unfitted(free_of(best_));
  Straight straight = find_straight_rows(kAlways, fitted_rows_, false, start);
  start.rows = std::move(straight.rows);
  start.weights = std::move(straight.weights);
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

numerics::BatchedResult SceneSearch::solve_explained(double until, const Eigen::VectorXd& prior,
                                                     const numerics::BatchedOptions& options,
                                                     const std::optional<RowCounts>& before, Fitted& at) const {
  constexpr int kAttempts = 4;
  for (int attempt = 1;; ++attempt) {
    numerics::BatchedResult found = numerics::solve_batched(problem(at, until, prior), options);
    if (!before || found.information.size() == 0 || attempt == kAttempts) return found;
    const RowCounts explained = find_explained(experiment_, fitted_, found.at.residuals, at.misfit);
    const RowCounts kept = fewer(at.rows, more(explained, *before));
    if (kept == at.rows) return found;
    at.rows = kept;
  }
}

bool SceneSearch::solve_stage(double horizon, bool is_last, Eigen::MatrixXd& covariance, Fitted& at) const {
  const std::optional<RowCounts> before = covariance.size() > 0 ? std::optional(at.rows) : std::nullopt;
  std::vector<double> ends;
  for (const std::size_t m : fitted_) {
    const std::vector<double>& times = experiment_.motions()[m].times;
    ends.push_back(is_last ? kAlways : times.front() + horizon * (times.back() - times.front()));
  }
  const double until = *std::max_element(ends.begin(), ends.end());
  const auto [around, straight, weights] = find_straight_rows(
      until, fewer(fitted_rows_, rows_until(experiment_, fitted_, ends)), covariance.size() == 0, at);
  at.straight = straight;
  at.weights = weights;
  if (std::ranges::any_of(around.middle, [](const Eigen::VectorXd& r) { return r.size() == 0; })) return false;
  // What nothing is known of yet may be far off and still come near.
  at.rows =
      covariance.size() > 0 ? fewer(at.straight, find_followed(experiment_, fitted_, around, covariance)) : at.straight;
  const Eigen::VectorXd prior = is_last ? Eigen::VectorXd() : Eigen::VectorXd(0.5 * (upper_ - lower_));
  numerics::BatchedOptions options;
  const auto each = static_cast<int>(2 * free_.size() + 1);
  options.max_iterations = std::max(1, experiment_.task().search.local / each);
  options.tolerance =
      (is_last ? kSettledLast : kSettled) / std::max(1.0, total(experiment_, fitted_, at.rows, at.weights));
  // Unknown paths cost many simulations for each Jacobian: before the last stage one is enough.
  options.fixed_jacobian =
      each * std::min(until, experiment_.longest()) > kLongSimulation || (!is_last && experiment_.path_unknowns() > 0);
  if (options.fixed_jacobian) options.max_iterations = std::max(options.max_iterations, kFixedJacobianSteps);
  const numerics::BatchedResult found = solve_explained(until, prior, options, before, at);
  at.message = found.message;
  if (found.information.size() == 0) return false;
  at.x = found.x;
  at.own.assign(found.own.begin(), found.own.begin() + static_cast<std::ptrdiff_t>(fitted_.size()));
  at.derivatives = found.at;
  at.misfit = std::max(1.0, found.cost / std::max(1.0, total(experiment_, fitted_, at.rows, at.weights)));
  const auto scale = step_.asDiagonal();  // units differ by orders
  covariance = at.misfit * (scale * numerics::invert_symmetric(scale * found.information * scale) * scale);
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
  // A stage is fitted again where it ends further away, or knows its parameters much better, than derivatives were for.
  const auto fit = [&](double horizon, bool is_last, int rounds) {
    for (int round = 0; round < rounds; ++round) {
      const Eigen::VectorXd x = at.x, step = at.step;
      if (!solve_stage(horizon, is_last, covariance, at)) return false;
      const bool is_near = ((at.x - x).cwiseAbs().array() <= at.step.array()).all();
      if (is_near && (at.step.array() >= kFiner * step.array()).all()) break;
    }
    return true;
  };
  if (!experiment_.task().only_final_state) {
    for (const double horizon : kHorizons)
      if (!fit(horizon, false, kRounds)) return at;
  }
  if (!fit(1.0, true, 2 * kRounds)) return at;
  // That a few rows are not what all others say is told (unpredictable); that most are not is a misfit.
  if (2.0 * total(at.rows) >= total(at.straight)) at.straight = at.rows;
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
    weigh(experiment_, fitted_[i], at.straight[i], at.weights[i], errors[i].residuals);
    sum += errors[i].residuals.cwiseAbs2().cwiseMin(kMost).sum();
  }
  return sum / std::max(1.0, total(experiment_, fitted_, at.straight, at.weights));
}

std::string SceneSearch::search_near() {
  Fitted found = least_squares_from(free_of(best_));
  misfit_ = found.is_solved ? bounded_misfit(found) : std::numeric_limits<double>::infinity();
  if (!found.is_solved) return "no simulation from there: " + found.message;
  best_ = full(found.x);
  const std::string message = found.message;
  result_ = std::move(found);
  return message;
}

std::vector<double> SceneSearch::profile(std::size_t index, const std::vector<double>& values) {
  std::vector<double> rises(values.size(), std::numeric_limits<double>::quiet_NaN());
  if (!result_) return rises;
  const Kept kept = keep();
  std::vector<std::size_t> others = free_;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(index));
  const auto cost_at = [&](double value) {
    Fitted at = *kept.result;
    const Eigen::VectorXd step = at.step;
    best_ = kept.best;
    best_[static_cast<Eigen::Index>(kept.free[index])] = value;
    restrict_to(others);
    at.x = free_of(best_);
    at.step.resize(at.x.size());
    for (std::size_t j = 0, k = 0; j < kept.free.size(); ++j)
      if (j != index) at.step[static_cast<Eigen::Index>(k++)] = step[static_cast<Eigen::Index>(j)];
    const numerics::BatchedProblem there = problem(at, kAlways, {});
    if (others.empty() && experiment_.own_deviation().size() == 0) {
      double sum = 0.0;
      for (const Eigen::VectorXd& r : numerics::differentiate(there, at.x, at.own).residuals)
        sum += r.size() == 0 ? std::numeric_limits<double>::quiet_NaN() : r.squaredNorm();
      return sum;
    }
    numerics::BatchedOptions options;
    options.max_iterations = kProfileIterations;
    options.tolerance = kSettledLast / std::max(1.0, total(experiment_, fitted_, at.rows, at.weights));
    return numerics::solve_batched(there, options).cost;
  };
  const double least = cost_at(kept.best[static_cast<Eigen::Index>(kept.free[index])]);
  for (std::size_t k = 0; k < values.size(); ++k) rises[k] = cost_at(values[k]) - least;
  go_back(kept);
  return rises;
}

std::string SceneSearch::search_squares(double rescue) {
  const model::SearchSettings& settings = experiment_.task().search;
  const Eigen::VectorXd start = free_of(best_);
  double& least = misfit_ = std::numeric_limits<double>::infinity();
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

Eigen::MatrixXd SceneSearch::clock_covariance(const Fitted& at, const numerics::BatchedDerivatives& found) const {
  const auto n = static_cast<Eigen::Index>(free_.size());
  const double rate = experiment_.task().clock_rate;
  if (rate == 0.0 || experiment_.task().program) return Eigen::MatrixXd::Zero(n, n);
  std::vector<SceneExperiment::Job> jobs;
  for (const double of_job : {0.0, rate})
    for (std::size_t i = 0; i < fitted_.size(); ++i) jobs.push_back({0, fitted_[i], at.own[i], of_job});
  std::vector<MotionError> errors = experiment_.evaluate(std::vector<Eigen::VectorXd>{full(at.x)}, jobs);
  std::vector<Eigen::VectorXd> changes;
  for (std::size_t i = 0; i < fitted_.size(); ++i) {
    Eigen::VectorXd &exact = errors[i].residuals, &fast = errors[fitted_.size() + i].residuals;
    if (exact.size() != fast.size()) return Eigen::MatrixXd::Zero(n, n);
    fast -= exact;
    weigh(experiment_, fitted_[i], at.rows[i], at.weights[i], fast);
    changes.push_back(std::move(fast));
  }
  const Eigen::VectorXd step = numerics::shared_step(found, changes, n);
  return step * step.transpose();
}

}  // namespace snug::identification::internal
