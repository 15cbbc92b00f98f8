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

constexpr double kRescue = 2.0;         // chi2 per degree of freedom: worth looking elsewhere before saying so
constexpr double kUnknownError = 0.25;  // of what the bounds span: a uniform draw within them has a deviation of 0.29
constexpr double kShareNamed = 0.3;     // of a direction's length: what is smaller has less than a tenth of its square
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

std::string advice_of(const model::TaskParameter& parameter, Verdict verdict, bool is_at_bound, bool is_refused,
                      bool is_unexplained) {
  if (is_refused)
    return "these recordings do not determine it, or a combination with others: record motions that it changes, or fix "
           "it";
  if (is_at_bound) return "it ended at its bound: widen the bounds, or look for another error";
  if (verdict == Verdict::Identified) return "";
  if (is_unexplained)
    return "the simulation misses the recordings by more than the declared noise: the noise is larger, or the scenario "
           "lacks something";
  return "more recordings, or motions that " + parameter.name + " changes more";
}

void judge_all(const SceneSearch& search, const Sensed& sensed, SceneFit& fit) {
  const bool is_unexplained = fit.is_systematic || fit.chi2_per_dof > kExplained;
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
      parameter.standard_error = std::numeric_limits<double>::quiet_NaN();
      parameter.advice = "held fixed by the task";
      fit.parameters.push_back(parameter);
      continue;
    }
    const bool is_refused = std::find(sensed.known.begin(), sensed.known.end(), i) == sensed.known.end();
    const bool is_at_bound = std::min(parameter.value - of.low, of.high - parameter.value) <= kAtBound * span;
    const double variance = fit.covariance(at, at);
    parameter.standard_error = is_refused       ? std::numeric_limits<double>::infinity()
                               : variance > 0.0 ? std::sqrt(variance)
                                                : std::numeric_limits<double>::quiet_NaN();
    const double scale = std::max(std::abs(parameter.value), kVerdictSpan * span);
    parameter.verdict = is_refused || !fit.is_trusted || !(parameter.standard_error > 0.0)
                            ? Verdict::NotIdentifiable
                            : judge(parameter.standard_error, scale);
    const bool is_doubtful = is_at_bound || is_unexplained;
    if (is_doubtful && parameter.verdict == Verdict::Identified) parameter.verdict = Verdict::Weak;
    parameter.advice = fit.is_trusted ? advice_of(of, parameter.verdict, is_at_bound, is_refused, is_unexplained)
                                      : "the simulation misses these recordings by far more than noise: try another "
                                        "start or a wider search, or add what the scenario lacks";
    fit.parameters.push_back(parameter);
  }
}

/// What least squares came to, and what can be told there.
struct Found {
  SceneSearch::Kept kept;
  Sensed sensed;
  std::string message;
};

bool has_all(const std::vector<std::size_t>& list, const std::vector<std::size_t>& wanted) {
  return std::ranges::all_of(wanted, [&](std::size_t one) { return std::ranges::find(list, one) != list.end(); });
}

/// Least squares from the search's best() of what can be told there; what cannot is where the task has it. Where that
/// ends it is judged anew: what can be told there joins, what cannot goes back.
Found fit_near(SceneSearch& search, const std::vector<std::size_t>& free, Sensed sensed, bool may_rescue) {
  constexpr int kRounds = 4;
  const Eigen::VectorXd start = search.experiment().start();
  Found found;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::VectorXd values = search.best();
    for (const std::size_t one : free)
      if (!has_all(sensed.known, {one})) values[static_cast<Eigen::Index>(one)] = start[static_cast<Eigen::Index>(one)];
    search.move_to(values);
    search.restrict_to(sensed.known);
    if (!sensed.known.empty())
      found.message = may_rescue && round == 0 ? search.search_squares(kRescue) : search.search_near();
    found.kept = search.keep();
    search.restrict_to(free);
    Sensed there = sense(search);
    search.go_back(found.kept);
    const bool is_same = there.known == sensed.known;
    if (!is_same && round + 1 == kRounds) {
      there.known = sensed.known;  // it goes to and fro: what was fitted last, with the error it has there
    }
    found.sensed = there;
    if (is_same) break;
    sensed = std::move(there);
  }
  return found;
}

/// Whether `a` is the better answer: by its misfit where that differs by more than chance may, else by what it tells.
bool is_better(const Found& a, const Found& b) {
  constexpr double kSame = 0.05;  // of the misfit
  if (a.kept.misfit < (1.0 - kSame) * b.kept.misfit) return true;
  return a.kept.misfit <= (1.0 + kSame) * b.kept.misfit && a.sensed.known.size() > b.sensed.known.size();
}

/// From the start, and where that leaves parameters untold or the recordings unexplained, from the best of points
/// spread over all bounds: a wall that the first simulation does not reach is reached from there.
Found fit_everywhere(SceneSearch& search, const std::vector<std::size_t>& free) {
  constexpr int kPoints = 20;  // for each parameter (docs/decisions/0075)
  constexpr std::size_t kStarts = 3;
  constexpr double kLong = 300.0;  // s, of simulation for a look around: then only the start counts
  const Eigen::VectorXd start = search.best();
  const Sensed at_start = sense(search);
  const bool tells_all = at_start.known.size() == free.size();
  Found best = fit_near(search, free, at_start, tells_all);
  const double look = static_cast<double>(2 * free.size() + 1) * search.experiment().longest();
  const bool is_done = best.sensed.known.size() == free.size() && best.kept.misfit <= kRescue;
  if (tells_all || is_done || look > kLong) return best;
  search.move_to(start);
  search.restrict_to(free);
  for (const Eigen::VectorXd& point : search.spread_points(kPoints * static_cast<int>(free.size()), kStarts)) {
    search.move_to(point);
    search.restrict_to(free);
    const Sensed there = sense(search);
    if (best.kept.misfit <= kRescue && has_all(best.sensed.known, there.known)) continue;
    Found found = fit_near(search, free, there, false);
    if (is_better(found, best)) best = std::move(found);
  }
  search.go_back(best.kept);
  return best;
}

/// What parameters that are not told may be off by, uniform within their bounds, goes on to those that were fitted.
void add_untold(SceneSearch& search, const std::vector<std::size_t>& free, SceneFit& fit) {
  const SceneSearch::Kept kept = search.keep();
  if (kept.free.size() == free.size()) return;
  search.restrict_to(free);
  const Eigen::MatrixXd H = search.differentiate().information;
  search.go_back(kept);
  std::vector<Eigen::Index> told, untold;  // of `free`
  for (std::size_t j = 0; j < free.size(); ++j)
    (std::ranges::find(kept.free, free[j]) != kept.free.end() ? told : untold).push_back(static_cast<Eigen::Index>(j));
  const std::vector<model::TaskParameter>& parameters = search.experiment().task().parameters;
  const auto index = [&](Eigen::Index j) { return static_cast<Eigen::Index>(free[static_cast<std::size_t>(j)]); };
  const auto span = [&](Eigen::Index j) {
    const model::TaskParameter& one = parameters[free[static_cast<std::size_t>(j)]];
    return one.high - one.low;
  };
  // In units of the spans, where a direction that nothing tells is one of small numbers.
  const auto block = [&](const std::vector<Eigen::Index>& rows, const std::vector<Eigen::Index>& columns) {
    Eigen::MatrixXd part(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(columns.size()));
    for (Eigen::Index i = 0; i < part.rows(); ++i)
      for (Eigen::Index j = 0; j < part.cols(); ++j) {
        const Eigen::Index r = rows[static_cast<std::size_t>(i)], c = columns[static_cast<std::size_t>(j)];
        part(i, j) = H(r, c) * span(r) * span(c);
      }
    return part;
  };
  Eigen::MatrixXd remains = block(untold, untold);
  Eigen::MatrixXd G(static_cast<Eigen::Index>(told.size()), static_cast<Eigen::Index>(untold.size()));
  if (!told.empty()) {
    const Eigen::MatrixXd across = block(told, untold);
    G = -numerics::solve_symmetric(block(told, told), across);
    remains += numerics::transposed_product(across, G);
  }
  remains.diagonal().array() += 12.0;  // a uniform distribution's variance is a twelfth of its span squared
  const Eigen::MatrixXd spread = numerics::invert_symmetric(remains);
  const Eigen::MatrixXd cross = numerics::product(G, spread);
  const Eigen::MatrixXd more = numerics::product(cross, G.transpose());
  for (std::size_t i = 0; i < told.size(); ++i) {
    for (std::size_t j = 0; j < told.size(); ++j)
      fit.covariance(index(told[i]), index(told[j])) +=
          more(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) * span(told[i]) * span(told[j]);
    for (std::size_t j = 0; j < untold.size(); ++j) {
      const double value =
          cross(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) * span(told[i]) * span(untold[j]);
      fit.covariance(index(told[i]), index(untold[j])) = fit.covariance(index(untold[j]), index(told[i])) = value;
    }
  }
  for (std::size_t i = 0; i < untold.size(); ++i)
    for (std::size_t j = 0; j < untold.size(); ++j)
      fit.covariance(index(untold[i]), index(untold[j])) =
          spread(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) * span(untold[i]) * span(untold[j]);
}

/// Where the rise crosses `level`, from the middle outwards; its root is nearly linear.
double find_crossing(const std::vector<double>& values, const std::vector<double>& rises, double middle, double level) {
  double before = middle, root_before = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (std::isnan(rises[k])) break;
    const double root = std::sqrt(std::max(0.0, rises[k])), wanted = std::sqrt(level);
    if (root >= wanted)
      return before + (values[k] - before) * (wanted - root_before) / std::max(root - root_before, 1e-300);
    before = values[k];
    root_before = root;
  }
  return std::numeric_limits<double>::infinity();
}

void make_profiles(SceneSearch& search, double inflation, SceneFit& fit) {
  constexpr double kLevel = 3.841;  // chi-square of one number, 95 %
  const std::vector<model::TaskParameter>& parameters = search.experiment().task().parameters;
  for (std::size_t k = 0; k < search.free().size(); ++k) {
    const std::size_t i = search.free()[k];
    const model::TaskParameter& of = parameters[i];
    const double middle = fit.values[static_cast<Eigen::Index>(i)];
    const double error = std::sqrt(fit.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)));
    Profile profile;
    profile.name = of.name;
    std::vector<double> values[2], rises[2];
    for (const int side : {0, 1}) {
      const double bound = side == 0 ? of.low : of.high;
      for (const double z : {1.0, 1.5, 2.0, 2.5, 3.0, 4.0}) {
        const double value = middle + (side == 0 ? -z : z) * error;
        const bool is_beyond = side == 0 ? value <= bound : value >= bound;
        values[side].push_back(is_beyond ? bound : value);
        if (is_beyond) break;
      }
      rises[side] = search.profile(k, values[side]);
      for (double& rise : rises[side]) rise /= inflation;
    }
    profile.low = find_crossing(values[0], rises[0], middle, kLevel);
    if (std::isinf(profile.low)) profile.low = -profile.low;
    profile.high = find_crossing(values[1], rises[1], middle, kLevel);
    profile.values.assign(values[0].rbegin(), values[0].rend());
    profile.rises.assign(rises[0].rbegin(), rises[0].rend());
    profile.values.push_back(middle);
    profile.rises.push_back(0.0);
    profile.values.insert(profile.values.end(), values[1].begin(), values[1].end());
    profile.rises.insert(profile.rises.end(), rises[1].begin(), rises[1].end());
    fit.profiles.push_back(std::move(profile));
  }
}

}  // namespace

SceneFit identify_scene(const SceneExperiment& experiment, const SceneFitOptions& options) {
  const model::SceneTask& task = experiment.task();
  const bool is_squares = task.loss == model::TaskLoss::Squares;
  const std::vector<std::size_t> free = free_parameters(task);
  SceneSearch search(experiment, options, free);
  SceneFit fit;
  fit.values = experiment.start();
  fit.covariance = Eigen::MatrixXd::Zero(fit.values.size(), fit.values.size());
  const internal::SplitErrors at_start = search.errors_at(fit.values);
  fit.before = at_start.fitted;
  fit.held_back_before = at_start.held_back;
  Sensed sensed;
  if (!free.empty() && is_squares) {
    const Found found = fit_everywhere(search, free);
    sensed = found.sensed;
    fit.message = found.message;
  } else if (!free.empty()) {
    sensed = sense(search);
    search.restrict_to(sensed.known);
    if (!sensed.known.empty()) fit.message = search.search_distance();
  }
  fit.sensitivity = sensed.rows;
  fit.unknown = sensed.unknown;
  fit.values = search.best();
  const internal::SplitErrors errors = search.errors_at(fit.values);
  if (options.with_errors && !search.free().empty()) fit.covariance = search.covariance();
  if (options.with_errors && is_squares) add_untold(search, free, fit);
  if (options.with_errors && options.with_profile && is_squares) make_profiles(search, errors.inflation(), fit);
  fit.fitted = errors.fitted;
  fit.held_back = errors.held_back;
  fit.held_back_error = errors.held_back_error;
  fit.chi2_per_dof = errors.chi2_per_dof;
  fit.unpredictable = search.unpredictable();
  for (const RecordedMotion& motion : experiment.motions())
    for (const RecordedBody& body : motion.tracked)
      if (body.rejected > 0) fit.rejected.push_back({motion.name, body.body, body.rejected});
  for (std::size_t m = 0; m < experiment.motions().size(); ++m)
    for (const DrivenPath& path : experiment.driven_of(m))
      fit.smoothed.push_back({experiment.motions()[m].name, path.body, path.position_noise(), path.rotation_noise(),
                              path.position.bandwidth(), path.rotation.bandwidth()});
  fit.is_systematic = is_squares && errors.is_systematic();
  fit.is_trusted = !is_squares || fit.chi2_per_dof <= kMisfit;
  fit.evaluations = search.evaluations();
  judge_all(search, sensed, fit);
  return fit;
}

std::vector<MotionError> evaluate_scene(const SceneExperiment& experiment, const Eigen::VectorXd& values) {
  return internal::evaluate_all(experiment, values);
}

}  // namespace snug::identification
