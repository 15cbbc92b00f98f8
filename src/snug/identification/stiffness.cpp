// identify_stiffness: three estimators on the same balances, and what can be said about their result.
#include "snug/identification/stiffness.hpp"

#include <algorithm>
#include <cmath>

#include "snug/core/input_error.hpp"
#include "snug/cup/law.hpp"
#include "snug/identification/internal/compliance.hpp"
#include "snug/identification/internal/pose_misfit.hpp"
#include "snug/identification/internal/sensor_bias.hpp"
#include "snug/numerics/dense.hpp"
#include "snug/numerics/least_squares.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::identification {
namespace {

using internal::Balance;
using internal::Form;
using internal::LinearEstimate;
using internal::NoiseAtS1;
using numerics::congruence;
using numerics::invert_symmetric;
using numerics::product;
using numerics::scaled;
using numerics::solve_symmetric;
using numerics::transposed_product;

constexpr std::size_t kFewest = 4;        // poses; 24 numbers against 5 or 21
constexpr std::size_t kForSymmetry = 10;  // poses; fewer leave the test of 16 conditions without power
constexpr int kFolds = 5;  // of poses held back in turn: a fit of four fifths has 1.1 times the errors of all
constexpr double kWeakNumber = 0.25;  // of a number: its error from which it is weak
constexpr double kBiased = 38.0;      // chi-square of 6 degrees of freedom: one in a million
constexpr double kConstant = 2.0;  // chi2 per number of what a bias leaves of sensor less gravity: 1 is noise, and at
                                   // 1.5 nothing is called identified any more (kExplained)
constexpr std::size_t kForBias = 10;  // poses: 60 numbers against 11
constexpr const char* kNotExplained =
    "the law of the cup with the noise declared does not explain these poses: more noise, a sensor that is not tared, "
    "or another cup";

/// Everything that a fit needs, made once for all choices of poses.
struct Setup {
  const StaticPoses& poses;
  const Form& form;
  Matrix6 prior;
  StiffnessMethod method;
  NoiseAtS1 noise;
  std::vector<Balance> balances;
  std::vector<internal::CompliancePose> linear;
};

WrenchSource choose_source(const StaticPoses& poses, const StiffnessOptions& options) {
  if (options.wrench) return *options.wrench;
  const bool has_sensor = std::all_of(poses.poses.begin(), poses.poses.end(),
                                      [](const StaticPose& pose) { return pose.wrench_S.has_value(); });
  return has_sensor ? WrenchSource::Sensor : WrenchSource::Gravity;
}

Setup make_setup(const StaticPoses& poses, const StiffnessOptions& options, WrenchSource source) {
  Setup setup{poses,
              internal::form_of(options.form),
              cup::as_matrix(options.prior),
              options.method,
              internal::carry_noise(poses.noise, poses.frames),
              internal::make_balances(poses, source),
              {}};
  setup.linear = internal::make_compliance_poses(setup.balances);
  return setup;
}

/// Of a fit: numbers of K.
struct Estimate {
  Matrix6 K;
  Eigen::MatrixXd covariance;
};

void check_definite(const Setup& setup, const Matrix6& K) {
  if (is_positive_definite(K) && K.allFinite()) return;
  throw InputError(setup.poses.source, "", "wrenches that pull against the deformation: no positive stiffness fits",
                   "the wrench of the cup on the package, in S about the lip (a hanging box: fz of the cup negative, z "
                   "of S into the box)");
}

/// The compliance fit, which the other methods start from.
struct Start {
  Estimate estimate;
  /// Directions of the numbers of K, in units of the prior, that the data say nothing about: kept as they are.
  Eigen::MatrixXd unknown;
};

Start fit_by_compliance(const Setup& setup, const std::vector<double>& weight) {
  const LinearEstimate found = internal::fit_compliance(setup.linear, weight, setup.noise, setup.form, setup.prior);
  const Matrix6 C = setup.form.matrix(found.theta);
  check_definite(setup, C);
  const Matrix6 K = inverse(C);
  const Eigen::MatrixXd J = setup.form.inverse_jacobian(K);
  Start start{{K, congruence(J, found.covariance)}, {}};
  start.unknown = product(setup.form.scale_in(setup.prior).cwiseInverse().asDiagonal(), product(J, found.unknown));
  start.unknown.colwise().normalize();
  return start;
}

/// Along unknown directions the error is the compliance fit's, that is the prior's width.
void widen(const Setup& setup, const Start& start, Estimate& estimate) {
  if (start.unknown.cols() == 0) return;
  const Eigen::VectorXd scale = setup.form.scale_in(setup.prior);
  const Eigen::Index n = scale.size();
  const Eigen::MatrixXd U =
      product(start.unknown, numerics::solve_by_qr(start.unknown, Eigen::MatrixXd::Identity(n, n)));
  const Eigen::MatrixXd in_units = scaled(start.estimate.covariance, scale.cwiseInverse());
  estimate.covariance += scaled(congruence(U, in_units), scale);  // U projects on them
}

/// Information that keeps the unknown directions where they are, in units of the prior.
constexpr double kKept = 1e8;

/// Wrenches at the measured poses are linear in K.
Estimate fit_by_wrench(const Setup& setup, const std::vector<double>& weight, const Start& start) {
  const Form& form = setup.form;
  const Eigen::VectorXd scale = form.scale_in(setup.prior);
  const Eigen::VectorXd kept = form.numbers_of(start.estimate.K).cwiseQuotient(scale);
  const Matrix6 W = inverse(setup.noise.wrench);
  // Everything in units of the prior.
  Eigen::MatrixXd N = kKept * product(start.unknown, start.unknown.transpose());
  Eigen::VectorXd b = product(N, kept);
  N.diagonal().array() += 1.0 / (internal::kPriorWidth * internal::kPriorWidth);
  b += form.numbers_of(setup.prior).cwiseQuotient(scale) / (internal::kPriorWidth * internal::kPriorWidth);
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(form.size(), form.size());
  for (std::size_t i = 0; i < setup.balances.size(); ++i) {
    if (weight[i] == 0.0) continue;
    const Balance& balance = setup.balances[i];
    Eigen::Matrix<double, 6, Eigen::Dynamic> A(6, form.size());
    for (Eigen::Index j = 0; j < form.size(); ++j)
      A.col(j) = scale[j] * cup::spring_wrench(balance.H, form.numbers[static_cast<std::size_t>(j)].basis);
    N += transposed_product(A, product(W, A));
    b += transposed_product(A, W * balance.wanted(balance.H));
    // The noise of the residual, with the compliance fit's K: its size is all that is asked for.
    const Matrix6 T = cup::spring_tangent(balance.H, start.estimate.K) - balance.wanted_tangent(balance.H);
    Matrix6 covariance = T * setup.noise.pose * T.transpose();
    if (!balance.is_gravity) covariance += setup.noise.wrench;
    const Eigen::MatrixXd WA = product(W, A);
    scatter += transposed_product(WA, product(covariance, WA));
  }
  const Eigen::VectorXd solved = solve_symmetric(N, b);
  Estimate estimate{form.matrix(scale.cwiseProduct(solved)), {}};
  check_definite(setup, estimate.K);
  estimate.covariance = scaled(congruence(invert_symmetric(N), scatter), scale);
  widen(setup, start, estimate);
  return estimate;
}

/// Maximum likelihood over K and all true poses and wrenches, the latter eliminated pose by pose.
Estimate fit_by_likelihood(const Setup& setup, const std::vector<double>& weight, const Start& from) {
  const Form& form = setup.form;
  const Eigen::VectorXd scale = form.scale_in(setup.prior);  // unknowns in units of the prior
  const Eigen::VectorXd prior = form.numbers_of(setup.prior).cwiseQuotient(scale);
  const Eigen::VectorXd start = form.numbers_of(from.estimate.K).cwiseQuotient(scale);
  std::vector<numerics::LeastSquaresTerm> terms;
  for (std::size_t i = 0; i < setup.balances.size(); ++i) {
    if (weight[i] == 0.0) continue;
    terms.push_back({6,
                     {},
                     [&setup, &form, &scale, i](const Eigen::VectorXd& x, const Eigen::VectorXd&, Eigen::VectorXd& r,
                                                Eigen::MatrixXd* J) {
                       const Matrix6 K = form.matrix(scale.cwiseProduct(x));
                       const internal::Misfit misfit = internal::compute_misfit(
                           setup.balances[i], K, setup.noise, setup.poses.frames, J != nullptr ? &form : nullptr);
                       r = misfit.residual;
                       if (J != nullptr) *J = product(misfit.jacobian, scale.asDiagonal());
                     }});
  }
  terms.push_back({form.size(),
                   {},
                   [&prior](const Eigen::VectorXd& x, const Eigen::VectorXd&, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
                     r = (x - prior) / internal::kPriorWidth;
                     if (J != nullptr) *J = Eigen::MatrixXd::Identity(x.size(), x.size()) / internal::kPriorWidth;
                   }});
  if (from.unknown.cols() > 0)
    terms.push_back(
        {from.unknown.cols(),
         {},
         [&from, &start](const Eigen::VectorXd& x, const Eigen::VectorXd&, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
           r = std::sqrt(kKept) * transposed_product(from.unknown, x - start);
           if (J != nullptr) *J = std::sqrt(kKept) * from.unknown.transpose();
         }});
  const numerics::LeastSquaresResult found =
      numerics::solve_least_squares(terms, start, {.tolerance = 1e-10, .max_iterations = 50});
  if (!found.has_converged)
    throw InputError(setup.poses.source, "", "a fit that does not converge: " + found.message,
                     "poses of one cup with their wrenches, or the method compliance");
  Estimate estimate{form.matrix(scale.cwiseProduct(found.x)), {}};
  check_definite(setup, estimate.K);
  estimate.covariance = scaled(numerics::invert(found.information), scale);
  widen(setup, from, estimate);
  return estimate;
}

Estimate fit(const Setup& setup, const std::vector<double>& weight) {
  const Start start = fit_by_compliance(setup, weight);
  switch (setup.method) {
    case StiffnessMethod::Wrench:
      return fit_by_wrench(setup, weight, start);
    case StiffnessMethod::Compliance:
      return start.estimate;
    case StiffnessMethod::ErrorsInVariables:
      return fit_by_likelihood(setup, weight, start);
  }
  return {};
}

const char* advice_for(const Form::Number& number) {
  if (number.row == 2 && number.column == 2)
    return "heavy loads hanging straight down and standing straight up: the cup must stretch by several millimetres";
  if (number.row == 5 && number.column == 5)
    return "loads whose centre of mass is 30 mm or more off the cup's axis, gripper tilted by 60 to 90 degrees, turned "
           "about its axis";
  if (number.row < 3 && number.column < 3)
    return "gripper tilted by 60 to 90 degrees with heavy loads whose centre of mass is near the lip: shear without "
           "bending";
  if (number.row >= 3 && number.column >= 3)
    return "gripper tilted by 30 to 90 degrees with the centre of mass 50 mm or more from the lip: bending";
  return "tilted poses with the same load near and far from the lip: shear and bending in different proportions";
}

std::vector<Parameter> make_parameters(const Form& form, const Matrix6& K, const Eigen::MatrixXd& covariance,
                                       double chi2) {
  const Eigen::VectorXd theta = form.numbers_of(K), scale = form.scale_in(K);
  std::vector<Parameter> parameters;
  for (Eigen::Index i = 0; i < form.size(); ++i) {
    const Form::Number& number = form.numbers[static_cast<std::size_t>(i)];
    const double error = std::sqrt(std::max(0.0, covariance(i, i)));
    Verdict verdict = judge(error, scale[i]);
    // The scale says whether the cup's behaviour is known, not whether this number is: 5 +- 4.9 is no number.
    const bool is_of_any_cup = number.row == number.column || number.row + number.column == 4;
    if (verdict == Verdict::Identified && is_of_any_cup && error > kWeakNumber * std::abs(theta[i]))
      verdict = Verdict::Weak;
    if (verdict == Verdict::Identified && chi2 > kExplained) verdict = Verdict::Weak;
    if (chi2 > kMisfit) verdict = Verdict::NotIdentifiable;
    parameters.push_back({number.name, theta[i], error, number.unit, verdict,
                          verdict == Verdict::Identified ? ""
                          : chi2 > kExplained            ? kNotExplained
                                                         : advice_for(number)});
  }
  return parameters;
}

/// Chance that chi-square with an even number of degrees of freedom exceeds `x`: a finite sum.
double chi_square_tail(double x, int even_degrees) {
  double term = std::exp(-0.5 * x), sum = term;
  for (int k = 1; k < even_degrees / 2; ++k) sum += term *= 0.5 * x / k;
  return std::min(1.0, sum);
}

SymmetryTest test_symmetry(const Setup& setup, const std::vector<double>& weight, double inflation) {
  const Form& full = internal::form_of(StiffnessForm::Full);
  const LinearEstimate found = internal::fit_compliance(setup.linear, weight, setup.noise, full, setup.prior);
  // On the compliance, where the fit is linear; both have the same symmetry.
  const internal::SymmetryConditions& conditions = internal::symmetry_conditions();
  const Eigen::VectorXd scale = full.scale_in(inverse(setup.prior));
  const Eigen::MatrixXd rows = conditions.rows;
  // Each condition in units of its own size.
  const Eigen::VectorXd size = product(rows.cwiseAbs(), scale).cwiseInverse();
  const Eigen::VectorXd sums = product(rows, found.theta), missed = size.cwiseProduct(sums);
  const Eigen::MatrixXd covariance = inflation * scaled(congruence(rows, found.covariance), size);
  SymmetryTest test;
  test.statistic = missed.dot(solve_symmetric(covariance, missed).col(0));
  test.p_value = chi_square_tail(test.statistic, static_cast<int>(rows.rows()));
  test.is_supported = test.p_value >= 0.01;
  // Told in stiffnesses, for people.
  const Matrix6 K = inverse(full.matrix(found.theta));
  const Eigen::MatrixXd J = product(rows, full.inverse_jacobian(K));
  const Eigen::VectorXd value = product(rows, full.numbers_of(K));
  const Eigen::VectorXd error = (inflation * congruence(J, found.covariance)).diagonal().cwiseSqrt();
  Eigen::Index worst = 0;
  value.cwiseAbs().cwiseQuotient(error).maxCoeff(&worst);
  char text[120];
  std::snprintf(text, sizeof text, "%s = %.4g +- %.2g", conditions.names[static_cast<std::size_t>(worst)].c_str(),
                value[worst], error[worst]);
  test.worst = text;
  return test;
}

std::vector<double> weights_without(std::size_t count, const std::vector<int>& outliers) {
  std::vector<double> weight(count, 1.0);
  for (const int index : outliers) weight[static_cast<std::size_t>(index)] = 0.0;
  return weight;
}

}  // namespace

const char* name_of(StiffnessMethod method) {
  switch (method) {
    case StiffnessMethod::Wrench:
      return "wrench";
    case StiffnessMethod::Compliance:
      return "compliance";
    case StiffnessMethod::ErrorsInVariables:
      return "errors-in-variables";
  }
  return "";
}

const char* name_of(WrenchSource source) { return source == WrenchSource::Sensor ? "sensor" : "gravity"; }

namespace {

struct Sum {
  double chi2 = 0.0;
  int poses = 0;
};

Sum sum_misfit(const Setup& setup, const std::vector<double>& weight, const Matrix6& K) {
  Sum sum;
  for (std::size_t i = 0; i < weight.size(); ++i) {
    if (weight[i] == 0.0) continue;
    ++sum.poses;
    sum.chi2 +=
        internal::compute_misfit(setup.balances[i], K, setup.noise, setup.poses.frames, nullptr).residual.squaredNorm();
  }
  return sum;
}

/// The bias as an unknown beside the numbers of the cup: a step, a fit of what that leaves, and again.
SensorBias fit_bias(const StaticPoses& poses, const StiffnessOptions& options, const std::vector<double>& weight,
                    const Matrix6& K_start) {
  constexpr int kSteps = 5;
  SensorBias found;
  Matrix6 K = K_start;
  double before = 0.0;
  for (int step = 0; step < kSteps; ++step) {
    const StaticPoses unbiased = internal::without_bias(poses, found.bias);
    const Setup setup = make_setup(unbiased, options, WrenchSource::Sensor);
    if (step > 0) K = fit(setup, weight).K;
    const double chi2 = sum_misfit(setup, weight, K).chi2;
    if (step == 0) before = chi2;
    found.statistic = std::max(0.0, before - chi2);
    const internal::BiasStep next =
        internal::step_bias(setup.balances, weight, K, setup.noise, poses.frames, setup.form);
    if (step + 1 < kSteps) found.bias = wrench_from(Vector6(as_vector(found.bias) + next.bias));
    found.error = wrench_from(next.error);
  }
  return found;
}

/// The bias of the sensor, if it has one to speak of; found against gravity where the loads are known.
std::optional<SensorBias> find_sensor_bias(const StaticPoses& poses, const StiffnessOptions& options,
                                           const std::vector<double>& weight, const Matrix6& K) {
  if (poses.poses.size() < kForBias) return std::nullopt;
  std::optional<SensorBias> bias = internal::compare_with_gravity(poses);
  const bool is_constant = bias && bias->misfit <= kConstant;
  if (!bias) bias = fit_bias(poses, options, weight, K);
  bias->is_removed = bias->statistic > kBiased && (is_constant || !bias->is_against_gravity);
  return bias;
}

StiffnessFit fit_poses(const StaticPoses& poses, const StiffnessOptions& options, WrenchSource source) {
  StiffnessFit result;
  result.method = options.method;
  result.wrench = source;
  const Setup setup = make_setup(poses, options, result.wrench);
  for (const std::size_t odd : internal::find_odd_poses(setup.linear, setup.noise, setup.form, setup.prior))
    result.outliers.push_back(static_cast<int>(odd));
  const std::vector<double> weight = weights_without(poses.poses.size(), result.outliers);
  const Estimate estimate = fit(setup, weight);
  const Sum sum = sum_misfit(setup, weight, estimate.K);
  result.poses = sum.poses;
  for (std::size_t i = 0; i < weight.size(); ++i) {
    if (weight[i] == 0.0) continue;
    const Vector6 error = internal::compute_prediction_error(setup.balances[i], estimate.K, poses.frames);
    result.position += error.head<3>().squaredNorm();
    result.rotation += error.tail<3>().squaredNorm();
  }
  result.degrees_of_freedom = std::max(1, 6 * result.poses - static_cast<int>(setup.form.size()));
  result.chi2_per_dof = sum.chi2 / result.degrees_of_freedom;
  result.position = std::sqrt(result.position / result.poses);
  result.rotation = std::sqrt(result.rotation / result.poses);
  result.K = estimate.K;
  result.covariance = estimate.covariance;
  return result;
}

}  // namespace

StiffnessFit identify_stiffness(const StaticPoses& measured, const StiffnessOptions& options) {
  if (measured.poses.size() < kFewest)
    throw InputError(measured.source, "", std::to_string(measured.poses.size()) + " poses",
                     std::to_string(kFewest) + " or more");
  const WrenchSource source = choose_source(measured, options);
  StiffnessFit result = fit_poses(measured, options, source);
  StaticPoses poses = measured;
  if (source == WrenchSource::Sensor) {
    const std::vector<double> weight = weights_without(poses.poses.size(), result.outliers);
    const std::optional<SensorBias> bias = find_sensor_bias(poses, options, weight, result.K);
    if (bias && bias->is_removed) {
      poses = internal::without_bias(measured, bias->bias);
      result = fit_poses(poses, options, source);
      result.degrees_of_freedom = std::max(1, result.degrees_of_freedom - 6);
    }
    result.bias = bias;
  }
  const Setup setup = make_setup(poses, options, source);
  const std::vector<double> weight = weights_without(poses.poses.size(), result.outliers);
  if (result.bias && result.bias->is_removed) {
    const internal::BiasStep at =
        internal::step_bias(setup.balances, weight, result.K, setup.noise, poses.frames, setup.form);
    const Vector6 error = as_vector(result.bias->error);
    const Eigen::MatrixXd of_bias = result.bias->is_against_gravity ? Eigen::MatrixXd(error.cwiseAbs2().asDiagonal())
                                                                    : Eigen::MatrixXd(at.covariance);
    result.covariance += congruence(at.change, of_bias);
  }
  const double inflation = std::max(1.0, result.chi2_per_dof);
  result.covariance *= inflation;
  result.is_explained = result.chi2_per_dof <= kMisfit;
  result.elasticity = internal::nearest_elasticity(result.K);
  result.parameters = make_parameters(setup.form, result.K, result.covariance, result.chi2_per_dof);
  if (static_cast<std::size_t>(result.poses) >= kForSymmetry) result.symmetry = test_symmetry(setup, weight, inflation);
  return result;
}

HeldBackError compute_held_back_error(const StaticPoses& measured, const StiffnessOptions& options,
                                      const StiffnessFit& whole) {
  const StaticPoses poses =
      whole.bias && whole.bias->is_removed ? internal::without_bias(measured, whole.bias->bias) : measured;
  const Setup setup = make_setup(poses, options, whole.wrench);
  const std::vector<double> used = weights_without(poses.poses.size(), whole.outliers);
  HeldBackError error;
  int count = 0;
  for (int fold = 0; fold < kFolds; ++fold) {
    std::vector<double> weight = used;
    for (std::size_t i = static_cast<std::size_t>(fold); i < weight.size(); i += kFolds) weight[i] = 0.0;
    const Matrix6 K = fit(setup, weight).K;
    for (std::size_t i = static_cast<std::size_t>(fold); i < used.size(); i += kFolds) {
      if (used[i] == 0.0) continue;
      ++count;
      error.relative +=
          internal::compute_misfit(setup.balances[i], K, setup.noise, poses.frames, nullptr).residual.squaredNorm();
      const Vector6 miss = internal::compute_prediction_error(setup.balances[i], K, poses.frames);
      error.position += miss.head<3>().squaredNorm();
      error.rotation += miss.tail<3>().squaredNorm();
    }
  }
  error.relative = std::sqrt(error.relative / (6.0 * count));
  error.position = std::sqrt(error.position / count);
  error.rotation = std::sqrt(error.rotation / count);
  return error;
}

}  // namespace snug::identification
