// identify_scene: sensitivity, search, least squares, and what the result is worth.
#include "snug/identification/scene_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "snug/identification/internal/scene_search.hpp"
#include "snug/numerics/bounded_search.hpp"
#include "snug/numerics/dense.hpp"

namespace snug::identification {
namespace {

using internal::SceneSearch;

constexpr double kMisfit = 9.0;         // chi2 per degree of freedom: three times the noise is no noise
constexpr double kRescue = 2.0;         // the same: worth looking elsewhere before saying so
constexpr double kUnknownError = 0.25;  // of what the bounds span: the data do not say where in them
constexpr double kShareNamed = 0.3;     // of a direction's length, for a parameter to be named in it
constexpr double kVerdictSpan = 0.25;   // of the bounds: what a parameter near zero is judged against
constexpr double kAtBound = 1e-6;       // of the span

/// The parameters that are fitted, as indices into the task's.
std::vector<std::size_t> free_parameters(const model::SceneTask& task) {
  std::vector<std::size_t> list;
  for (std::size_t i = 0; i < task.parameters.size(); ++i)
    if (!task.parameters[i].is_fixed) list.push_back(i);
  return list;
}

struct Sensed {
  std::vector<Sensitivity> rows;
  std::vector<UnknownDirection> unknown;
  std::vector<std::size_t> known;  ///< parameters of the task that can be fitted
};

Sensed sense(const SceneSearch& search) {
  const SceneExperiment& experiment = search.experiment();
  const std::vector<model::TaskParameter>& parameters = experiment.task().parameters;
  const std::vector<std::size_t>& free = search.free();
  const auto n = static_cast<Eigen::Index>(free.size());
  const SceneSearch::Derivatives at = search.differentiate();
  Eigen::VectorXd span(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const model::TaskParameter& parameter = parameters[free[static_cast<std::size_t>(j)]];
    span[j] = parameter.high - parameter.low;
  }
  const numerics::Eigenpairs eigen = numerics::symmetric_eigenpairs(numerics::scaled(at.information, span));
  const double least = 1.0 / (kUnknownError * kUnknownError);
  Sensed sensed;
  std::vector<bool> is_unknown(free.size(), false);
  for (Eigen::Index k = 0; k < n; ++k) {
    const double value = eigen.values[k];
    if (value >= least) continue;
    UnknownDirection direction;
    direction.error = value > 0.0 ? 1.0 / std::sqrt(value) : std::numeric_limits<double>::infinity();
    for (Eigen::Index j = 0; j < n; ++j) {
      const double share = eigen.vectors(j, k);
      if (std::abs(share) < kShareNamed) continue;
      direction.shares.emplace_back(parameters[free[static_cast<std::size_t>(j)]].name, share);
      is_unknown[static_cast<std::size_t>(j)] = true;
    }
    sensed.unknown.push_back(std::move(direction));
  }
  const Eigen::VectorXd variance = eigen.values.unaryExpr([](double v) { return v > 1e-12 ? 1.0 / v : 1e24; });
  const Eigen::MatrixXd inverse = numerics::scaled(numerics::congruence(eigen.vectors, variance.asDiagonal()), span);
  for (Eigen::Index j = 0; j < n; ++j) {
    const std::size_t index = free[static_cast<std::size_t>(j)];
    Sensitivity row;
    row.name = parameters[index].name;
    row.step = parameters[index].step;
    row.position_mm = 1e3 * row.step * at.position_rms[j];
    row.rotation_deg = 180.0 / std::numbers::pi * row.step * at.rotation_rms[j];
    row.error_alone =
        at.information(j, j) > 0.0 ? 1.0 / std::sqrt(at.information(j, j)) : std::numeric_limits<double>::infinity();
    row.error_together = std::sqrt(inverse(j, j));
    sensed.rows.push_back(row);
    if (!is_unknown[static_cast<std::size_t>(j)]) sensed.known.push_back(index);
  }
  return sensed;
}

std::string advice_of(const model::TaskParameter& parameter, Verdict verdict, bool is_at_bound, bool is_refused) {
  if (is_refused)
    return "it or a combination with others does not show in these recordings: record motions that it changes, or fix "
           "it";
  if (is_at_bound) return "it ended at its bound: widen the bounds, or something else is wrong";
  if (verdict == Verdict::Identified) return "";
  return "more recordings, or motions that " + parameter.name + " changes more";
}

void judge_all(const SceneSearch& search, const Sensed& sensed, SceneFit& fit) {
  const std::vector<model::TaskParameter>& parameters = search.experiment().task().parameters;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const model::TaskParameter& of = parameters[i];
    const auto at = static_cast<Eigen::Index>(i);
    const double span = of.high - of.low;
    Parameter parameter;
    parameter.name = of.name;
    parameter.value = fit.values[at];
    if (of.is_fixed) {
      parameter.verdict = Verdict::NotIdentifiable;
      parameter.advice = "held fixed by the task";
      fit.parameters.push_back(parameter);
      continue;
    }
    const bool is_refused = std::find(sensed.known.begin(), sensed.known.end(), i) == sensed.known.end();
    const bool is_at_bound = std::min(parameter.value - of.low, of.high - parameter.value) <= kAtBound * span;
    parameter.standard_error =
        is_refused ? std::numeric_limits<double>::infinity() : std::sqrt(std::max(0.0, fit.covariance(at, at)));
    const double scale = std::max(std::abs(parameter.value), kVerdictSpan * span);
    parameter.verdict = is_refused || !fit.is_trusted || !(parameter.standard_error > 0.0)
                            ? Verdict::NotIdentifiable
                            : judge(parameter.standard_error, scale);
    if (is_at_bound && parameter.verdict == Verdict::Identified) parameter.verdict = Verdict::Weak;
    parameter.advice = fit.is_trusted ? advice_of(of, parameter.verdict, is_at_bound, is_refused)
                                      : "the simulation misses these recordings by far more than noise: another start, "
                                        "a wider search, or what the scenario leaves out";
    fit.parameters.push_back(parameter);
  }
}

}  // namespace

SceneFit identify_scene(const SceneExperiment& experiment, const SceneFitOptions& options) {
  const model::SceneTask& task = experiment.task();
  SceneSearch search(experiment, options, free_parameters(task));
  SceneFit fit;
  fit.values = experiment.start();
  fit.covariance = Eigen::MatrixXd::Zero(fit.values.size(), fit.values.size());
  fit.before = search.errors_at(fit.values).fitted;
  Sensed sensed;
  if (!search.free().empty()) {
    sensed = sense(search);
    fit.sensitivity = sensed.rows;
    fit.unknown = sensed.unknown;
    search.restrict_to(sensed.known);
  }
  if (!search.free().empty()) {
    fit.message = task.loss == model::TaskLoss::Distance ? search.search_distance() : search.search_squares(kRescue);
    fit.values = search.best();
    if (options.with_errors) fit.covariance = search.covariance();
  }
  const internal::SplitErrors errors = search.errors_at(fit.values);
  fit.fitted = errors.fitted;
  fit.held_back = errors.held_back;
  fit.held_back_error = errors.held_back_error;
  fit.chi2_per_dof = errors.chi2_per_dof;
  fit.unpredictable = search.unpredictable();
  fit.is_trusted = task.loss == model::TaskLoss::Distance || fit.chi2_per_dof <= kMisfit;
  fit.evaluations = search.evaluations();
  judge_all(search, sensed, fit);
  return fit;
}

std::vector<MotionError> evaluate_scene(const SceneExperiment& experiment, const Eigen::VectorXd& values) {
  return internal::evaluate_all(experiment, values);
}

}  // namespace snug::identification
