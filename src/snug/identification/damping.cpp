// identify_damping: output error: the damping whose simulated swings come nearest to the recorded ones.
#include "snug/identification/damping.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "snug/core/input_error.hpp"
#include "snug/cup/law.hpp"
#include "snug/identification/free_swing.hpp"
#include "snug/identification/internal/stiffness_form.hpp"
#include "snug/numerics/least_squares.hpp"
#include "snug/numerics/outliers.hpp"

namespace snug::identification {
namespace {

using internal::Form;

constexpr double kPriorWidth = 1000.0;  // times the prior's own size
constexpr double kRejects = 3.29;       // deviations of chi-square by which releases contradict: about 1 in 1000

/// Which numbers are looked for, and where they stay when the data do not know them.
struct Unknowns {
  std::vector<Matrix6> damping;
  std::vector<Matrix6> stiffness;
  Eigen::VectorXd prior;  ///< damping first
  Eigen::VectorXd scale;
  std::vector<std::string> names, units;
};

Unknowns make_unknowns(const DampingOptions& options, const Matrix6& K) {
  const Form& form = internal::form_of(StiffnessForm::Symmetric);
  const Matrix6 D = cup::as_matrix(options.prior);
  Unknowns unknowns;
  std::vector<double> prior, scale;
  const auto add = [&](std::vector<Matrix6>& bases, const Matrix6& matrix, std::size_t i, std::string name,
                       std::string unit) {
    bases.push_back(form.numbers[i].basis);
    prior.push_back(form.numbers_of(matrix)[static_cast<Eigen::Index>(i)]);
    scale.push_back(form.scale_in(matrix)[static_cast<Eigen::Index>(i)]);
    unknowns.names.push_back(std::move(name));
    unknowns.units.push_back(std::move(unit));
  };
  const char* names[] = {"d_lat", "d_ax", "d_bend", "d_tors", "d_c"};
  const char* units[] = {"Ns/m", "Ns/m", "Nms/rad", "Nms/rad", "Ns/rad"};
  for (std::size_t i = 0; i < (options.with_coupling ? 5U : 4U); ++i) add(unknowns.damping, D, i, names[i], units[i]);
  for (std::size_t i = 0; options.with_stiffness && i < form.numbers.size(); ++i)
    add(unknowns.stiffness, K, i, form.numbers[i].name, form.numbers[i].unit);
  unknowns.prior = Eigen::Map<const Eigen::VectorXd>(prior.data(), static_cast<Eigen::Index>(prior.size()));
  unknowns.scale = Eigen::Map<const Eigen::VectorXd>(scale.data(), static_cast<Eigen::Index>(scale.size()));
  return unknowns;
}

/// Sum of bases times numbers from `first` on.
Matrix6 sum_of(const std::vector<Matrix6>& bases, const Eigen::VectorXd& theta, Eigen::Index first) {
  Matrix6 sum = Matrix6::Zero();
  for (std::size_t i = 0; i < bases.size(); ++i) sum += theta[first + static_cast<Eigen::Index>(i)] * bases[i];
  return sum;
}

/// One release against its simulation.
class ReleaseModel {
 public:
  ReleaseModel(const Release& release, const Unknowns& unknowns, const DampingOptions& options, bool is_moving)
      : release_(release), unknowns_(unknowns), is_moving_(is_moving) {
    swing_.load_S = release.load_S;
    swing_.R_WE = release.R_WE;
    swing_.frames = release.frames;
    swing_.gravity_W = release.gravity_W;
    swing_.K = release.K.value_or(options.K);
    coupling_ = cup::as_matrix({.coupling = options.with_coupling ? 0.0 : options.prior.coupling});
    directions_.damping = unknowns.damping;
    directions_.stiffness = unknowns.stiffness;
    directions_.by_start = true;
    directions_.by_velocity = is_moving;
    to_S_ = cup::wrench_transform(release.frames.X_SS1).transpose().inverse();
    const MeasurementNoise least;
    position_ = std::max(release.noise.position, 1e-6 * least.position);
    rotation_ = std::max(release.noise.rotation, 1e-6 * least.rotation);
  }

  [[nodiscard]] Eigen::Index own() const { return is_moving_ ? 12 : 6; }

  /// Rows after those of the samples: what is known of the start.
  [[nodiscard]] Eigen::Index more_rows() const { return release_.X_ES_start ? 6 : 0; }

  /// Six numbers a sample, in units of the noise: place in E, turn in S. `own`: body twist of S1 from the start as
  /// known (or the first measured pose) to the true one, in units of millimetre and milliradian, and first velocity of
  /// S1.
  void evaluate(const Eigen::VectorXd& theta, const Eigen::VectorXd& own, std::size_t samples, Eigen::VectorXd& r,
                Eigen::MatrixXd* J) const {
    FreeSwing swing = swing_;
    const auto count = static_cast<Eigen::Index>(unknowns_.damping.size());
    swing.D = sum_of(unknowns_.damping, theta, 0) + coupling_;
    if (!unknowns_.stiffness.empty()) swing.K = sum_of(unknowns_.stiffness, theta, count);
    const Vector6 shift = to_S_ * (kOwnScale * own.head<6>());
    const Pose& measured = release_.X_ES_start ? *release_.X_ES_start : release_.X_ES.front();
    const Pose start{measured.R * exp_rotation(shift.tail<3>()), measured.p + measured.R * shift.head<3>()};
    const Vector6 velocity = is_moving_ ? Vector6(own.tail<6>()) : Vector6(Vector6::Zero());
    const std::vector<double> times(release_.times.begin(),
                                    release_.times.begin() + static_cast<std::ptrdiff_t>(samples));
    const std::vector<SwingSample> simulated =
        simulate_swing(swing, start, velocity, times, J != nullptr ? directions_ : SwingDirections{});
    for (std::size_t i = 0; i < samples; ++i) {
      const auto row = 6 * static_cast<Eigen::Index>(i);
      const Pose& X_ES = simulated[i].X_ES;
      const Vector3 turn = log_rotation(release_.X_ES[i].R.transpose() * X_ES.R);
      r.segment<3>(row) = (X_ES.p - release_.X_ES[i].p) / position_;
      r.segment<3>(row + 3) = turn / rotation_;
      if (J == nullptr) continue;
      J->middleRows<3>(row) = X_ES.R * simulated[i].by_what.topRows<3>() / position_;
      J->middleRows<3>(row + 3) = (Matrix3::Identity() + 0.5 * skew(turn) + skew(turn) * skew(turn) / 12.0) *
                                  simulated[i].by_what.bottomRows<3>() / rotation_;
    }
    if (J != nullptr) J->middleCols(theta.size(), 6) *= kOwnScale;
    if (more_rows() == 0 || r.size() == 6 * static_cast<Eigen::Index>(samples)) return;
    Vector6 weight;
    weight << Vector3::Constant(kKnownBetter / position_), Vector3::Constant(kKnownBetter / rotation_);
    r.tail<6>() = weight.cwiseProduct(shift);
    if (J == nullptr) return;
    J->bottomRows<6>().setZero();
    J->bottomRows<6>().middleCols(theta.size(), 6) = kOwnScale * weight.asDiagonal() * to_S_;
  }

  [[nodiscard]] double position_noise() const { return position_; }
  [[nodiscard]] double rotation_noise() const { return rotation_; }

 private:
  static constexpr double kOwnScale = 1e-3;
  static constexpr double kKnownBetter = 20.0;  // a start held for a second at 360 Hz: the mean of 400 samples

  const Release& release_;
  const Unknowns& unknowns_;
  bool is_moving_;
  FreeSwing swing_;
  Matrix6 coupling_;
  SwingDirections directions_;
  Matrix6 to_S_;
  double position_ = 1.0, rotation_ = 1.0;
};

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
         r = (x - prior.cwiseQuotient(scale)) / kPriorWidth;
         if (J != nullptr) *J = Eigen::MatrixXd::Identity(x.size(), x.size()) / kPriorWidth;
       }});
  const numerics::LeastSquaresResult found =
      numerics::solve_least_squares(terms, start.cwiseQuotient(scale), {.tolerance = 1e-8, .max_iterations = 50});
  solution.failure = found.has_converged ? "" : found.message;
  solution.theta = scale.cwiseProduct(found.x);
  const Eigen::VectorXd inverse = scale.cwiseInverse();
  solution.information = inverse.asDiagonal() * found.information * inverse.asDiagonal();
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
  const Form& form = internal::form_of(StiffnessForm::Symmetric);
  std::vector<Parameter> parameters;
  const auto judge_all = [&](const std::vector<Matrix6>& bases, Eigen::Index first) {
    const Eigen::VectorXd scale = form.scale_in(sum_of(bases, theta, first));
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
  Problem problem{releases, options, make_unknowns(options, K), {}, is_moving};
  for (const Release& release : releases) problem.is_used.emplace_back(release.times.size(), char{1});
  return problem;
}

void check_input(const std::vector<Release>& releases, const DampingOptions& options) {
  if (releases.empty()) throw InputError("command line", "", "no releases", "one or more");
  for (const Release& release : releases) {
    if (Eigen::LLT<Matrix6>(release.K.value_or(options.K)).info() != Eigen::Success)
      throw InputError(release.name, "K", "a stiffness that is not positive definite", "the cup's, identified before");
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
  fit.covariance = inflation * solution.information.inverse();
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
  double alone = 0.0;
  int alone_freedom = 0;
  for (const std::size_t k : all) {
    const Solution one = solve(problem, {k}, solution.theta, {solution.own[k]});
    alone += one.chi2;
    alone_freedom += one.degrees_of_freedom;
    fit.releases.push_back(describe(problem, k, one, one.own.front()));
    const double enlarged = std::max(1.0, fit.releases.back().chi2_per_dof);
    fit.releases.back().parameters = make_parameters(problem.unknowns, one.theta, enlarged * one.information.inverse());
  }
  const double more = static_cast<double>(problem.unknowns.scale.size()) * static_cast<double>(releases.size() - 1);
  const double noise = std::max(1.0, alone / alone_freedom);
  fit.releases_agree = solution.chi2 - alone <= noise * (more + kRejects * std::sqrt(2.0 * more));
  if (!fit.releases_agree) {
    for (Parameter& parameter : fit.parameters) {
      parameter.verdict = Verdict::NotIdentifiable;
      parameter.advice =
          "the releases contradict each other: one damping does not fit them all; identify them one by one";
    }
  }
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
