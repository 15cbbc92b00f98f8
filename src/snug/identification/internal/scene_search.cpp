// SceneSearch: the mean cost of points, searches of it without derivatives, errors and covariance at what was found.
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
constexpr double kFirstSubplex = 0.05;  // of the span, as the largest step of the least squares (kMostStep)

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

namespace {

/// Sums of the residuals of one axis of one body over a 32nd of the recordings' rows, over all recordings.
struct AxisParts {
  static constexpr Eigen::Index kParts = 32;
  std::array<double, kParts> sum{}, count{};
};

/// By how many deviations a mean is off: that of all rows, of an eighth or of a 32nd of them, whichever is off most (a
/// body that starts aside is caught up with in few samples). 0 where none is off by a quarter of the noise of a sample:
/// what is smaller moves no number by more than its error says.
double find_drift(const AxisParts& axis) {
  constexpr double kFewest = 5.0, kLeast = 0.25;
  double drift = 0.0;
  for (const std::size_t length : {std::size_t{1}, axis.sum.size() / 8, axis.sum.size()}) {
    for (std::size_t first = 0; first < axis.sum.size(); first += length) {
      double sum = 0.0, count = 0.0;
      for (std::size_t e = first; e < first + length; ++e) {
        sum += axis.sum[e];
        count += axis.count[e];
      }
      if (count >= kFewest && std::abs(sum) >= kLeast * count)
        drift = std::max(drift, std::abs(sum) / std::sqrt(count));
    }
  }
  return drift;
}

}  // namespace

bool SplitErrors::is_systematic() const {
  constexpr double kChance = 4.0, kLeast = 0.05;
  constexpr double kDrift = 4.6;  // 41 means of six axes: one sound fit of a body in a thousand is more by chance
  return drift > kDrift || correlation > std::max(kLeast, kChance / std::sqrt(std::max(1.0, numbers)));
}

double SplitErrors::inflation() const {
  constexpr double kLongest = 0.98;  // correlation of neighbours: a hundred samples that err together
  const double chance = 4.0 * std::sqrt(2.0 / std::max(1.0, numbers));
  if (!is_systematic() && !(chi2_per_dof > 1.0 + chance)) return std::max(1.0, chi2_per_dof);
  // What noise does not explain has what correlation there is: so many neighbours say the same wrong thing.
  const double excess = std::max({0.0, chi2_per_dof - 1.0, correlation * chi2_per_dof});
  const double shared = excess > 0.0 ? std::clamp(correlation * chi2_per_dof / excess, 0.0, kLongest) : 0.0;
  return 1.0 + excess * (1.0 + shared) / (1.0 - shared);
}

void SceneSearch::judge_misfit(const std::vector<MotionError>& errors, SplitErrors& split) const {
  const RowCounts& rows = result_ ? result_->straight : fitted_rows_;
  const RowWeights weights = result_ ? result_->weights : equal_weights(experiment_, fitted_);
  double sum = 0.0, next = 0.0, of_samples = 0.0;
  std::vector<AxisParts> axes;  // of the bodies in the order of each recording's rows
  for (std::size_t i = 0; i < fitted_.size(); ++i) {
    const MotionError& error = errors[fitted_[i]];
    if (!error.failure.empty()) {
      split.chi2_per_dof = std::numeric_limits<double>::infinity();
      return;
    }
    Eigen::VectorXd r = error.residuals;
    weigh(experiment_, fitted_[i], rows[i], weights[i], r);
    sum += r.squaredNorm();
    std::size_t first_axis = 0;
    for (const SceneExperiment::BodyRows& body : experiment_.rows_of(fitted_[i])) {
      const auto each = static_cast<std::size_t>(body.each);
      axes.resize(std::max(axes.size(), first_axis + each));
      for (Eigen::Index k = 0; k < body.count; ++k) {
        const double value = r[body.first + k];
        if (value == 0.0) continue;  // not fitted
        AxisParts& axis = axes[first_axis + static_cast<std::size_t>(k % body.each)];
        const auto part = static_cast<std::size_t>(AxisParts::kParts * k / body.count);
        axis.sum[part] += value;
        axis.count[part] += 1.0;
      }
      first_axis += each;
      of_samples += r.segment(body.first, body.count).squaredNorm();
      for (Eigen::Index k = body.first; k + body.each < body.first + body.count; ++k) next += r[k] * r[k + body.each];
    }
  }
  split.numbers = total(experiment_, fitted_, rows, weights);
  split.correlation = of_samples > 0.0 ? next / of_samples : 0.0;
  for (const AxisParts& axis : axes) split.drift = std::max(split.drift, find_drift(axis));
  split.chi2_per_dof = sum / std::max(1.0, split.numbers - static_cast<double>(free_.size()));
}

void SceneSearch::move_to(const Eigen::VectorXd& values) {
  best_ = values;
  best_cost_ = misfit_ = std::numeric_limits<double>::infinity();
  result_.reset();
}

void SceneSearch::go_back(const Kept& kept) {
  restrict_to(std::vector<std::size_t>(kept.free));
  best_ = kept.best;
  result_ = kept.result;
  misfit_ = kept.misfit;
}

std::vector<Eigen::VectorXd> SceneSearch::spread_points(int count, std::size_t kept) {
  const Kept before = keep();
  const std::vector<Eigen::VectorXd> tried = scattered(count);
  const std::vector<double> found = costs(tried, "scatter");
  go_back(before);
  std::vector<std::size_t> order(tried.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return found[a] < found[b]; });
  std::vector<Eigen::VectorXd> points;
  for (std::size_t k = 0; k < std::min(kept, order.size()); ++k) points.push_back(full(tried[order[k]]));
  return points;
}

SplitErrors SceneSearch::errors_at(const Eigen::VectorXd& values) const {
  const bool is_fitted = result_ && values == best_;
  std::vector<MotionError> errors(experiment_.motions().size());
  if (!is_fitted || !held_.empty()) errors = evaluate_all(experiment_, values);
  if (is_fitted) {  // what they have of their own was fitted to the rows that can be predicted
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
  judge_misfit(errors, split);
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
    const SplitErrors errors = errors_at(best_);
    const double chi2 = errors.chi2_per_dof;
    const numerics::BatchedProblem there = problem(at, kAlways, {});
    const double counted = total(experiment_, fitted_, at.straight, at.weights);
    const double excess = (chi2 - 1.0) * counted - 2.0 * std::sqrt(2.0 * counted);  // more than chance, twice
    const numerics::BatchedDerivatives found = result_ ? at.derivatives : numerics::differentiate(there, at.x, at.own);
    of_free = numerics::squares_covariance(there, found, excess) * (std::isfinite(chi2) ? errors.inflation() : 1.0) +
              clock_covariance(at, found);
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
  // (docs/theory/scene-identification.md, 1). In units of the steps h.
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
