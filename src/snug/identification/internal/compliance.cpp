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

LinearEstimate fit_compliance(const std::vector<CompliancePose>& poses, const std::vector<double>& weight,
                              const NoiseAtS1& noise, const Form& form, const Matrix6& prior) {
  const Eigen::Index n = form.size();
  const Matrix6 W = weight_of_e(noise);
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  Matrix6 cov_gg = Matrix6::Zero(), cov_eg = Matrix6::Zero();  // summed: W and the basis are the same for all poses
  double count = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (weight[i] == 0.0) continue;
    const CompliancePose& pose = poses[i];
    const Wide A = columns(form, pose.g);
    const Wide WA = W * A;
    count += 1.0;
    N.noalias() += weight[i] * (A.transpose() * WA);
    b.noalias() += weight[i] * (WA.transpose() * pose.e);
    const Matrix6 by_pose = pose.g_by_pose * noise.pose;
    cov_gg += weight[i] *
              (by_pose * pose.g_by_pose.transpose() + pose.g_by_wrench * noise.wrench * pose.g_by_wrench.transpose());
    cov_eg += weight[i] * (pose.e_by_pose * by_pose.transpose());
  }
  // What noise adds to the sums, in the mean.
  Eigen::MatrixXd of_noise(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const Matrix6 BjW = form.numbers[static_cast<std::size_t>(j)].basis * W;
    b[j] -= BjW.cwiseProduct(cov_eg.transpose()).sum();
    const Matrix6 spread = BjW.transpose() * cov_gg;  // W B_j cov(g)
    for (Eigen::Index k = j; k < n; ++k) {
      of_noise(j, k) = form.numbers[static_cast<std::size_t>(k)].basis.cwiseProduct(spread.transpose()).sum();
      of_noise(k, j) = of_noise(j, k);
    }
  }
  // In units of the prior's width (m/N and rad/(Nm) differ by a thousand), where the prior's information is one.
  const Matrix6 C_prior = inverse(prior);
  const Eigen::VectorXd width = kPriorWidth * form.scale_in(C_prior);
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(n, n);
  const Eigen::MatrixXd whole = width.asDiagonal() * N * width.asDiagonal();
  const Eigen::MatrixXd chance = width.asDiagonal() * of_noise * width.asDiagonal();
  // Where the sums hold no more than noise puts there, taking out its mean leaves chance: those directions are unknown.
  const numerics::Eigenpairs ratio = numerics::generalized_eigenpairs(whole + one, chance + one);
  const Eigen::MatrixXd& V = ratio.vectors;         // V^T (chance + 1) V = 1
  const Eigen::MatrixXd back = (chance + one) * V;  // V^-T
  const double least = std::max(kLeastSignal, kChanceSignal / std::sqrt(count));
  Eigen::VectorXd signal = (ratio.values.array() - 1.0).matrix();
  Eigen::VectorXd is_known = (signal.array() > least).cast<double>();
  signal = signal.cwiseProduct(is_known);
  const Eigen::MatrixXd information = back * signal.asDiagonal() * back.transpose() + one;
  const Eigen::VectorXd known_b = back * is_known.cwiseProduct(V.transpose() * (width.asDiagonal() * b));

  LinearEstimate estimate;
  estimate.theta = width.asDiagonal() *
                   numerics::solve_symmetric(information, known_b + form.numbers_of(C_prior).cwiseQuotient(width));
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
    scatter.noalias() += weight[i] * weight[i] * (WA.transpose() * (covariance * WA));
  }
  // The regressors' noise meets that of the residuals: second order, but all there is when signals are small.
  scatter = width.asDiagonal() * (scatter + size * of_noise) * width.asDiagonal();
  const Eigen::MatrixXd known = back * is_known.asDiagonal() * V.transpose();
  scatter = known * scatter * known.transpose() + one;
  const Eigen::MatrixXd gain = width.asDiagonal() * numerics::invert_symmetric(information);
  estimate.covariance = gain * scatter * gain.transpose();
  const auto unknown = static_cast<Eigen::Index>(std::lround(static_cast<double>(n) - is_known.sum()));
  estimate.unknown = width.asDiagonal() * V.leftCols(unknown);  // eigenvalues grow
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
    Eigen::VectorXd sum = N * form.numbers_of(inverse(prior));
    for (std::size_t i = 0; i < poses.size(); ++i) {
      N.noalias() += weight[i] * (A[i].transpose() * A[i]);
      sum.noalias() += weight[i] * (A[i].transpose() * b[i]);
    }
    const Eigen::VectorXd theta =
        width.asDiagonal() *
        numerics::solve_symmetric(width.asDiagonal() * N * width.asDiagonal(), width.asDiagonal() * sum);
    for (std::size_t i = 0; i < poses.size(); ++i) sizes[i] = (A[i] * theta - b[i]).norm();
    const double limit = kForgiving * std::max(1e-9, numerics::median_deviation(sizes, 6));
    for (std::size_t i = 0; i < poses.size(); ++i) weight[i] = 1.0 / (1.0 + std::pow(sizes[i] / limit, 2));
  }
  constexpr double kRounding = 1e-3;  // of the noise declared: exact data have no outliers
  return numerics::find_outliers(sizes, 6, kRounding);
}

}  // namespace snug::identification::internal
