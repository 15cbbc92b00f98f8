// The compliance fit: C g = e is linear in C.
#include "snug/identification/internal/compliance.hpp"

#include <algorithm>
#include <cmath>

#include "snug/cup/law.hpp"
#include "snug/cup/law_derivatives.hpp"
#include "snug/numerics/dense.hpp"
#include "snug/numerics/outliers.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::identification::internal {
namespace {

using numerics::congruence;
using numerics::generalized_eigenpairs;
using numerics::invert_symmetric;
using numerics::product;
using numerics::scaled;
using numerics::solve_symmetric;
using numerics::transposed_product;

/// A direction is known when its sum exceeds the noise's own by this much, and by this much over the root of the number
/// of poses: the noise's sum scatters by sqrt(2 / poses), five times that is no chance.
constexpr double kLeastSignal = 1.0;
constexpr double kChanceSignal = 7.0;
constexpr int kRobustSteps = 10;
constexpr double kForgiving = 3.0;  // standard deviations from which a pose weighs less and less

using Wide = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// Inverse of the noise of e near rest, where J = 2 I.
Matrix6 weight_of_e(const NoiseAtS1& noise) { return inverse(4.0 * noise.pose); }

Wide columns(const Form& form, const Vector6& g) {
  Wide A(6, form.size());
  for (Eigen::Index i = 0; i < form.size(); ++i) A.col(i) = form.numbers[static_cast<std::size_t>(i)].basis * g;
  return A;
}

}  // namespace

std::vector<CompliancePose> make_compliance_poses(const std::vector<Balance>& balances) {
  std::vector<CompliancePose> poses;
  poses.reserve(balances.size());
  for (const Balance& balance : balances) {
    const Pose& H = balance.H;
    const Matrix6 J = cup::deformation_jacobian(H);
    const Matrix6 J_inverse = inverse(J.transpose());  // J^T g = -4 f
    CompliancePose pose;
    pose.e = cup::deformation(H);
    pose.g = -4.0 * (J_inverse * balance.wanted(H));
    pose.e_by_pose = J;
    pose.g_by_pose = J_inverse * (-4.0 * balance.wanted_tangent(H) - cup::pullback_derivative(H, pose.g));
    pose.g_by_wrench = balance.is_gravity ? Matrix6(Matrix6::Zero()) : Matrix6(-4.0 * J_inverse);
    poses.push_back(pose);
  }
  return poses;
}

namespace {

/// N theta = b of the poses in use, `of_noise`: what noise adds to N in the mean. It is taken out of b, not of N.
struct NormalSums {
  Eigen::MatrixXd N;
  Eigen::VectorXd b;
  Eigen::MatrixXd of_noise;
  double count = 0.0;  ///< of poses
};

NormalSums normal_sums(const std::vector<CompliancePose>& poses, const std::vector<double>& weight,
                       const NoiseAtS1& noise, const Form& form, const Matrix6& W) {
  const Eigen::Index n = form.size();
  NormalSums sums{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), Eigen::MatrixXd(n, n), 0.0};
  Matrix6 cov_gg = Matrix6::Zero(), cov_eg = Matrix6::Zero();  // summed: W and the basis are the same for all poses
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (weight[i] == 0.0) continue;
    const CompliancePose& pose = poses[i];
    const Wide A = columns(form, pose.g);
    const Wide WA = W * A;
    sums.count += 1.0;
    sums.N += weight[i] * transposed_product(A, WA);
    sums.b += weight[i] * transposed_product(WA, pose.e);
    const Matrix6 by_pose = pose.g_by_pose * noise.pose;
    cov_gg += weight[i] *
              (by_pose * pose.g_by_pose.transpose() + pose.g_by_wrench * noise.wrench * pose.g_by_wrench.transpose());
    cov_eg += weight[i] * (pose.e_by_pose * by_pose.transpose());
  }
  // What noise adds to the sums, in the mean.
  for (Eigen::Index j = 0; j < n; ++j) {
    const Matrix6 BjW = form.numbers[static_cast<std::size_t>(j)].basis * W;
    sums.b[j] -= BjW.cwiseProduct(cov_eg.transpose()).sum();
    const Matrix6 spread = BjW.transpose() * cov_gg;  // W B_j cov(g)
    for (Eigen::Index k = j; k < n; ++k) {
      sums.of_noise(j, k) = form.numbers[static_cast<std::size_t>(k)].basis.cwiseProduct(spread.transpose()).sum();
      sums.of_noise(k, j) = sums.of_noise(j, k);
    }
  }
  return sums;
}

}  // namespace

LinearEstimate fit_compliance(const std::vector<CompliancePose>& poses, const std::vector<double>& weight,
                              const NoiseAtS1& noise, const Form& form, const Matrix6& prior) {
  const Eigen::Index n = form.size();
  const Matrix6 W = weight_of_e(noise);
  const auto [N, b, of_noise, count] = normal_sums(poses, weight, noise, form, W);
  // In units of the prior's width (m/N and rad/(Nm) differ by a thousand), where the prior's information is one.
  const Matrix6 C_prior = inverse(prior);
  const Eigen::VectorXd width = kPriorWidth * form.scale_in(C_prior);
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd whole = scaled(N, width);
  const Eigen::MatrixXd chance = scaled(of_noise, width);
  // Where the sums hold no more than noise puts there, taking out its mean leaves chance: those directions are unknown.
  const numerics::Eigenpairs ratio = generalized_eigenpairs(whole + one, chance + one);
  const Eigen::MatrixXd& V = ratio.vectors;               // V^T (chance + 1) V = 1
  const Eigen::MatrixXd back = product(chance + one, V);  // V^-T
  const double least = std::max(kLeastSignal, kChanceSignal / std::sqrt(count));
  Eigen::VectorXd signal = (ratio.values.array() - 1.0).matrix();
  Eigen::VectorXd is_known = (signal.array() > least).cast<double>();
  signal = signal.cwiseProduct(is_known);
  const Eigen::MatrixXd information = congruence(back, signal.asDiagonal()) + one;
  const Eigen::VectorXd in_V = transposed_product(V, width.cwiseProduct(b));
  const Eigen::VectorXd known_b = product(back, is_known.cwiseProduct(in_V));

  LinearEstimate estimate;
  const Eigen::VectorXd all_b = known_b + form.numbers_of(C_prior).cwiseQuotient(width);
  estimate.theta = width.cwiseProduct(Eigen::VectorXd(solve_symmetric(information, all_b)));
  const Matrix6 C = form.matrix(estimate.theta);
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(n, n);
  double size = 0.0;  // of the residuals against W
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (weight[i] == 0.0) continue;
    const CompliancePose& pose = poses[i];
    const Matrix6 by_pose = C * pose.g_by_pose - pose.e_by_pose;
    const Matrix6 by_wrench = C * pose.g_by_wrench;
    const Matrix6 covariance =
        by_pose * noise.pose * by_pose.transpose() + by_wrench * noise.wrench * by_wrench.transpose();
    const Wide WA = W * columns(form, pose.g);
    size += W.cwiseProduct(covariance).sum() / (6.0 * count);
    scatter += weight[i] * weight[i] * transposed_product(WA, product(covariance, WA));
  }
  // The regressors' noise meets that of the residuals: second order, but all there is when signals are small.
  const Eigen::MatrixXd known = product(back, product(is_known.asDiagonal(), V.transpose()));
  scatter = congruence(known, scaled(scatter + size * of_noise, width)) + one;
  estimate.covariance = scaled(congruence(invert_symmetric(information), scatter), width);
  const auto unknown = static_cast<Eigen::Index>(std::lround(static_cast<double>(n) - is_known.sum()));
  estimate.unknown = product(width.asDiagonal(), V.leftCols(unknown));  // eigenvalues grow
  return estimate;
}

std::vector<std::size_t> find_odd_poses(const std::vector<CompliancePose>& poses, const NoiseAtS1& noise,
                                        const Form& form, const Matrix6& prior) {
  const Matrix6 U = cholesky(weight_of_e(noise)).transpose();
  // Least squares by weights that fall with the misfit, from plain sums: no compensation, it does not matter here.
  std::vector<Wide> A;
  std::vector<Vector6> b;
  for (const CompliancePose& pose : poses) {
    A.push_back(U * columns(form, pose.g));
    b.push_back(U * pose.e);
  }
  const Eigen::VectorXd width = kPriorWidth * form.scale_in(inverse(prior));
  std::vector<double> weight(poses.size(), 1.0), sizes(poses.size());
  for (int step = 0; step < kRobustSteps; ++step) {
    Eigen::MatrixXd N = width.cwiseAbs2().cwiseInverse().asDiagonal();
    Eigen::VectorXd sum = product(N, form.numbers_of(inverse(prior)));
    for (std::size_t i = 0; i < poses.size(); ++i) {
      N += weight[i] * transposed_product(A[i], A[i]);
      sum += weight[i] * transposed_product(A[i], b[i]);
    }
    const Eigen::VectorXd solved = solve_symmetric(scaled(N, width), width.cwiseProduct(sum));
    const Eigen::VectorXd theta = width.cwiseProduct(solved);
    for (std::size_t i = 0; i < poses.size(); ++i) sizes[i] = (A[i] * theta - b[i]).norm();
    const double limit = kForgiving * std::max(1e-9, numerics::median_deviation(sizes, 6));
    for (std::size_t i = 0; i < poses.size(); ++i) weight[i] = 1.0 / (1.0 + std::pow(sizes[i] / limit, 2));
  }
  constexpr double kRounding = 1e-3;  // of the noise declared: exact data have no outliers
  return numerics::find_outliers(sizes, 6, kRounding);
}

}  // namespace snug::identification::internal
