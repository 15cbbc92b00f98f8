// identify_damping: output error: the damping whose simulated swings come nearest to the recorded ones.
#include "snug/identification/damping.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "snug/core/input_error.hpp"
#include "snug/cup/law.hpp"
#include "snug/identification/free_swing.hpp"
#include "snug/identification/internal/compliance.hpp"
#include "snug/identification/internal/release_model.hpp"
#include "snug/identification/internal/stiffness_form.hpp"
#include "snug/numerics/dense.hpp"
#include "snug/numerics/least_squares.hpp"
#include "snug/numerics/outliers.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::identification {
namespace {

using internal::ReleaseModel;
using internal::Unknowns;

constexpr double kRejects = 3.29;  // deviations of chi-square by which releases contradict: about 1 in 1000

/// A set of releases, the samples of each that count, and how they start.
struct Problem {
  const std::vector<Release>& releases;
  const DampingOptions& options;
  Unknowns unknowns;
  std::vector<std::vector<char>> is_used;  ///< samples; shorter than the release: the rest is not simulated
  bool is_moving = false;
};

struct Solution {
  Eigen::VectorXd theta;
  Eigen::MatrixXd information;
  std::vector<Eigen::VectorXd> own;
  double chi2 = 0.0;
  int degrees_of_freedom = 1;
  int iterations = 0;
  std::string failure;  ///< why the fit has not converged, or empty
};

void require_convergence(const Solution& solution, const Release& release) {
  if (solution.failure.empty()) return;
  throw InputError(release.name, "", "a fit that does not converge: " + solution.failure,
                   "free oscillations after a release, with the load's mass, inertia and stiffness of the cup");
}

int count_used(const std::vector<char>& is_used) {
  return static_cast<int>(std::count(is_used.begin(), is_used.end(), char{1}));
}

Solution solve(const Problem& problem, const std::vector<std::size_t>& which, const Eigen::VectorXd& start,
               const std::vector<Eigen::VectorXd>& own_start = {}) {
  const Eigen::VectorXd& scale = problem.unknowns.scale;
  std::vector<ReleaseModel> models;
  models.reserve(which.size());
  std::vector<numerics::LeastSquaresTerm> terms;
  Solution solution;
  for (std::size_t n = 0; n < which.size(); ++n) {
    const std::size_t k = which[n];
    models.emplace_back(problem.releases[k], problem.unknowns, problem.options, problem.is_moving);
    const ReleaseModel& model = models.back();
    const std::vector<char>& is_used = problem.is_used[k];
    const Eigen::Index rows = 6 * static_cast<Eigen::Index>(is_used.size()) + model.more_rows();
    solution.degrees_of_freedom +=
        6 * count_used(is_used) + static_cast<int>(model.more_rows()) - static_cast<int>(model.own());
    Eigen::VectorXd own = Eigen::VectorXd::Zero(model.own());
    if (!own_start.empty())
      own.head(std::min(own.size(), own_start[n].size())) =
          own_start[n].head(std::min(own.size(), own_start[n].size()));
    terms.push_back({rows, own,
                     [&model, &is_used, &scale](const Eigen::VectorXd& x, const Eigen::VectorXd& mine,
                                                Eigen::VectorXd& r, Eigen::MatrixXd* J) {
                       model.evaluate(scale.cwiseProduct(x), mine, is_used.size(), r, J);
                       if (J != nullptr) J->leftCols(scale.size()) *= scale.asDiagonal();
                       for (std::size_t i = 0; i < is_used.size(); ++i) {
                         if (is_used[i] != 0) continue;
                         r.segment<6>(6 * static_cast<Eigen::Index>(i)).setZero();
                         if (J != nullptr) J->middleRows<6>(6 * static_cast<Eigen::Index>(i)).setZero();
                       }
                     }});
  }
  const Eigen::VectorXd prior = problem.unknowns.prior;
  terms.push_back(
      {scale.size(),
       {},
       [&scale, prior](const Eigen::VectorXd& x, const Eigen::VectorXd&, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
         r = (x - prior.cwiseQuotient(scale)) / internal::kPriorWidth;
         if (J != nullptr) *J = Eigen::MatrixXd::Identity(x.size(), x.size()) / internal::kPriorWidth;
       }});
  const numerics::LeastSquaresResult found =
      numerics::solve_least_squares(terms, start.cwiseQuotient(scale), {.tolerance = 1e-8, .max_iterations = 50});
  solution.failure = found.has_converged ? "" : found.message;
  solution.theta = scale.cwiseProduct(found.x);
  solution.information = numerics::scaled(found.information, scale.cwiseInverse());
  solution.own = found.own;
  solution.chi2 = found.cost;
  solution.degrees_of_freedom -= 1 + static_cast<int>(scale.size());
  solution.degrees_of_freedom = std::max(1, solution.degrees_of_freedom);
  solution.iterations = found.iterations;
  return solution;
}

/// Residuals of one release under a solution, over as many samples as asked for.
Eigen::VectorXd residuals_of(const Problem& problem, std::size_t release, const Eigen::VectorXd& theta,
                             const Eigen::VectorXd& own, std::size_t samples) {
  const ReleaseModel model(problem.releases[release], problem.unknowns, problem.options, problem.is_moving);
  Eigen::VectorXd r(6 * static_cast<Eigen::Index>(samples));
  model.evaluate(theta, own, samples, r, nullptr);
  return r;
}

std::vector<std::size_t> all_of(const Problem& problem) {
  std::vector<std::size_t> which(problem.releases.size());
  std::iota(which.begin(), which.end(), 0U);
  return which;
}

/// Takes out the samples that no noise of the others explains; says whether there were any.
bool drop_outliers(Problem& problem, const Solution& solution) {
  bool has_dropped = false;
  for (std::size_t k = 0; k < problem.releases.size(); ++k) {
    std::vector<char>& is_used = problem.is_used[k];
    const Eigen::VectorXd r = residuals_of(problem, k, solution.theta, solution.own[k], is_used.size());
    std::vector<double> sizes;
    for (std::size_t i = 0; i < is_used.size(); ++i)
      sizes.push_back(r.segment<6>(6 * static_cast<Eigen::Index>(i)).norm());
    for (const std::size_t i : numerics::find_outliers(sizes, 6, 1.0)) {  // what the noise declared explains stays in
      has_dropped = has_dropped || is_used[i] != 0;
      is_used[i] = 0;
    }
  }
  return has_dropped;
}

const char* advice_for(const std::string& name) {
  if (name == "d_ax")
    return "an axial pluck: pull the load 3 to 5 mm along the cup's axis, gripper straight down, and let go (snug "
           "identify pluck shows one)";
  if (name == "d_lat")
    return "a load whose centre of mass is near the lip, pushed sideways by 5 mm and let go (snug identify pluck "
           "--direction lateral)";
  if (name == "d_bend")
    return "a load tilted by 5 degrees or more about its lip and let go (snug identify pluck --direction bend)";
  if (name == "d_tors")
    return "a load turned by 5 degrees or more about the cup's axis and let go (snug identify pluck --direction "
           "torsion)";
  if (name == "d_c") return "swings of loads with the centre of mass near and far from the lip";
  return "static poses (snug identify stiffness)";
}

std::vector<Parameter> make_parameters(const Unknowns& unknowns, const Eigen::VectorXd& theta,
                                       const Eigen::MatrixXd& covariance) {
  const internal::Form& form = internal::form_of(StiffnessForm::Symmetric);
  std::vector<Parameter> parameters;
  const auto judge_all = [&](const std::vector<Matrix6>& bases, Eigen::Index first) {
    const Eigen::VectorXd scale = form.scale_in(internal::sum_of(bases, theta, first));
    for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(bases.size()); ++i) {
      const auto at = static_cast<std::size_t>(first + i);
      const double error = std::sqrt(std::max(0.0, covariance(first + i, first + i)));
      const Verdict verdict = judge(error, scale[i]);
      parameters.push_back({unknowns.names[at], theta[first + i], error, unknowns.units[at], verdict,
                            verdict == Verdict::Identified ? "" : advice_for(unknowns.names[at])});
    }
  };
  judge_all(unknowns.damping, 0);
  if (!unknowns.stiffness.empty()) judge_all(unknowns.stiffness, static_cast<Eigen::Index>(unknowns.damping.size()));
  return parameters;
}

model::CupElasticity as_elasticity(const Eigen::VectorXd& theta, Eigen::Index first, Eigen::Index count) {
  return {theta[first], theta[first + 1], theta[first + 2], theta[first + 3], count > 4 ? theta[first + 4] : 0.0};
}

ReleaseFit describe(const Problem& problem, std::size_t k, const Solution& solution, const Eigen::VectorXd& own) {
  ReleaseFit fit;
  const Release& release = problem.releases[k];
  fit.name = release.name;
  fit.chi2_per_dof = solution.chi2 / solution.degrees_of_freedom;
  const std::vector<char>& is_used = problem.is_used[k];
  const Eigen::VectorXd r = residuals_of(problem, k, solution.theta, own, is_used.size());
  for (std::size_t i = 0; i < is_used.size(); ++i) {
    const auto row = 6 * static_cast<Eigen::Index>(i);
    if (is_used[i] == 0) {
      fit.outliers.push_back(static_cast<int>(i));
      continue;
    }
    fit.position += r.segment<3>(row).squaredNorm();
    fit.rotation += r.segment<3>(row + 3).squaredNorm();
  }
  const int used = std::max(1, count_used(is_used));
  fit.position = release.noise.position * std::sqrt(fit.position / used);
  fit.rotation = release.noise.rotation * std::sqrt(fit.rotation / used);
  return fit;
}

Problem make_problem(const std::vector<Release>& releases, const DampingOptions& options, bool is_moving) {
  const Matrix6 K = releases.front().K.value_or(options.K);
  Problem problem{releases, options, internal::make_unknowns(options, K), {}, is_moving};
  for (const Release& release : releases) problem.is_used.emplace_back(release.times.size(), char{1});
  return problem;
}

void check_input(const std::vector<Release>& releases, const DampingOptions& options) {
  if (releases.empty()) throw InputError("command line", "", "no releases", "one or more");
  for (const Release& release : releases) {
    if (!is_positive_definite(release.K.value_or(options.K)))
      throw InputError(release.name, "K", "a stiffness that is not positive definite", "the cup's, identified before");
  }
}

/// Each release by itself, and whether all of them together say the same.
void add_each_alone(const Problem& problem, const Solution& solution, DampingFit& fit) {
  double alone = 0.0;
  int alone_freedom = 0;
  for (const std::size_t k : all_of(problem)) {
    const Solution one = solve(problem, {k}, solution.theta, {solution.own[k]});
    alone += one.chi2;
    alone_freedom += one.degrees_of_freedom;
    fit.releases.push_back(describe(problem, k, one, one.own.front()));
    const double enlarged = std::max(1.0, fit.releases.back().chi2_per_dof);
    fit.releases.back().parameters =
        make_parameters(problem.unknowns, one.theta, enlarged * numerics::invert(one.information));
  }
  const double more =
      static_cast<double>(problem.unknowns.scale.size()) * static_cast<double>(problem.releases.size() - 1);
  const double noise = std::max(1.0, alone / alone_freedom);
  fit.releases_agree = solution.chi2 - alone <= noise * (more + kRejects * std::sqrt(2.0 * more));
  if (!fit.releases_agree) {
    for (Parameter& parameter : fit.parameters) {
      parameter.verdict = Verdict::NotIdentifiable;
      parameter.advice =
          "the releases contradict each other: one damping does not fit them all; identify them one by one";
    }
  }
}

}  // namespace

DampingFit identify_damping(const std::vector<Release>& releases, const DampingOptions& options) {
  check_input(releases, options);
  Problem problem = make_problem(releases, options, options.start == ReleaseStart::Moving);
  const std::vector<std::size_t> all = all_of(problem);
  DampingFit fit;
  Solution solution = solve(problem, all, problem.unknowns.prior);
  fit.iterations = solution.iterations;
  if (options.start == ReleaseStart::Auto) {
    // Six more numbers a release must pay: by more than their chi-square explains by chance.
    Problem moving = problem;
    moving.is_moving = true;
    const Solution free = solve(moving, all, solution.theta, solution.own);
    const double more = 6.0 * static_cast<double>(all.size());
    const double noise = std::max(1.0, free.chi2 / free.degrees_of_freedom);
    if (solution.chi2 - free.chi2 > noise * (more + kRejects * std::sqrt(2.0 * more))) {
      problem.is_moving = true;
      solution = free;
    }
    fit.iterations += free.iterations;
  }
  if (drop_outliers(problem, solution)) {
    solution = solve(problem, all, solution.theta, solution.own);
    fit.iterations += solution.iterations;
  }
  require_convergence(solution, releases.front());  // outliers may have kept the fits before from it
  fit.start = problem.is_moving ? ReleaseStart::Moving : ReleaseStart::Rest;
  fit.chi2_per_dof = solution.chi2 / solution.degrees_of_freedom;
  fit.degrees_of_freedom = solution.degrees_of_freedom;
  const double inflation = std::max(1.0, fit.chi2_per_dof);
  fit.covariance = inflation * numerics::invert(solution.information);
  fit.parameters = make_parameters(problem.unknowns, solution.theta, fit.covariance);
  const auto damping_count = static_cast<Eigen::Index>(problem.unknowns.damping.size());
  fit.damping = as_elasticity(solution.theta, 0, damping_count);
  if (!options.with_coupling) fit.damping.coupling = options.prior.coupling;
  if (options.with_stiffness) fit.stiffness = as_elasticity(solution.theta, damping_count, 5);

  if (releases.size() == 1) {
    fit.releases.push_back(describe(problem, 0, solution, solution.own.front()));
    fit.releases.back().parameters = fit.parameters;
    return fit;
  }
  add_each_alone(problem, solution, fit);
  return fit;
}

HeldBackError compute_held_back_error(const std::vector<Release>& releases, const DampingOptions& options,
                                      const DampingFit& fit) {
  Problem problem = make_problem(releases, options, fit.start == ReleaseStart::Moving);
  for (std::size_t k = 0; k < releases.size(); ++k) {
    problem.is_used[k].resize(2 * releases[k].times.size() / 3);
    for (const int index : fit.releases[k].outliers)
      if (static_cast<std::size_t>(index) < problem.is_used[k].size())
        problem.is_used[k][static_cast<std::size_t>(index)] = 0;
  }
  HeldBackError error;
  int count = 0;
  const auto predict = [&](const Solution& solution, const std::vector<std::size_t>& which) {
    for (std::size_t n = 0; n < which.size(); ++n) {
      const std::size_t k = which[n];
      const std::vector<int>& outliers = fit.releases[k].outliers;
      const Eigen::VectorXd r = residuals_of(problem, k, solution.theta, solution.own[n], releases[k].times.size());
      for (std::size_t i = problem.is_used[k].size(); i < releases[k].times.size(); ++i) {
        if (std::find(outliers.begin(), outliers.end(), static_cast<int>(i)) != outliers.end()) continue;
        const auto row = 6 * static_cast<Eigen::Index>(i);
        ++count;
        error.relative += r.segment<6>(row).squaredNorm();
        error.position += std::pow(releases[k].noise.position, 2) * r.segment<3>(row).squaredNorm();
        error.rotation += std::pow(releases[k].noise.rotation, 2) * r.segment<3>(row + 3).squaredNorm();
      }
    }
  };
  const std::vector<std::size_t> all = all_of(problem);
  predict(solve(problem, all, problem.unknowns.prior), all);
  error.relative = std::sqrt(error.relative / (6.0 * count));
  error.position = std::sqrt(error.position / count);
  error.rotation = std::sqrt(error.rotation / count);
  return error;
}

}  // namespace snug::identification
