// SensorBias: against gravity, and as an unknown of the fit.
#include "snug/identification/internal/sensor_bias.hpp"

#include "snug/numerics/dense.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::identification::internal {
namespace {

/// A wrench in the gripper's frame E, about the lip, in S.
Vector6 in_S(const Matrix3& R_ES, const Vector6& wrench_E) {
  return (Vector6() << R_ES.transpose() * wrench_E.head<3>(), R_ES.transpose() * wrench_E.tail<3>()).finished();
}

Vector6 in_E(const Matrix3& R_ES, const Vector6& wrench_S) {
  return (Vector6() << R_ES * wrench_S.head<3>(), R_ES * wrench_S.tail<3>()).finished();
}

/// Of the cup on the package that hangs still, in S about the lip.
Vector6 gravity_wrench(const StaticPose& pose, const Vector3& gravity_W) {
  const Matrix3 R_WS = pose.load->R_WE * pose.X_ES.R;
  const Vector3 weight = pose.load->mass * (R_WS.transpose() * gravity_W);
  return -(Vector6() << weight, pose.load->p_SScm.cross(weight)).finished();
}

}  // namespace

StaticPoses without_bias(StaticPoses poses, const Wrench& bias) {
  const Vector6 wrench_E = as_vector(bias);
  for (StaticPose& pose : poses.poses)
    if (pose.wrench_S) *pose.wrench_S -= in_S(pose.X_ES.R, wrench_E);
  return poses;
}

std::optional<SensorBias> compare_with_gravity(const StaticPoses& poses) {
  Vector6 mean = Vector6::Zero(), variance = Vector6::Zero();
  const double count = static_cast<double>(poses.poses.size());
  std::vector<Vector6> differences, variances;
  for (const StaticPose& pose : poses.poses) {
    if (!pose.wrench_S || !pose.load) return std::nullopt;
    differences.push_back(in_E(pose.X_ES.R, *pose.wrench_S - gravity_wrench(pose, poses.gravity_W)));
    mean += differences.back() / count;
    // Of the sensor, and of the weight's direction by the measured turn of the lip.
    const double weight = pose.load->mass * poses.gravity_W.norm();
    const double force = std::hypot(poses.noise.force, poses.noise.rotation * weight);
    const double torque = std::hypot(poses.noise.torque, poses.noise.rotation * weight * pose.load->p_SScm.norm());
    variances.push_back((Vector6() << Vector3::Constant(force * force), Vector3::Constant(torque * torque)).finished());
    variance += variances.back() / (count * count);
  }
  SensorBias bias;
  bias.is_against_gravity = true;
  bias.bias = wrench_from(mean);
  const Vector6 error = variance.cwiseSqrt();
  bias.error = wrench_from(error);
  bias.statistic = mean.cwiseAbs2().cwiseQuotient(variance).sum();
  for (std::size_t i = 0; i < differences.size(); ++i)
    bias.misfit += (differences[i] - mean).cwiseAbs2().cwiseQuotient(variances[i]).sum() / (6.0 * (count - 1.0));
  return bias;
}

BiasStep step_bias(const std::vector<Balance>& balances, const std::vector<double>& weight, const Matrix6& K,
                   const NoiseAtS1& noise, const CupFrames& frames, const Form& form) {
  const Eigen::Index n = form.size();
  const Eigen::VectorXd scale = form.scale_in(K);
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n + 6, n + 6);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(n + 6);
  for (std::size_t i = 0; i < balances.size(); ++i) {
    if (weight[i] == 0.0) continue;
    const Misfit misfit = compute_misfit(balances[i], K, noise, frames, &form);
    Eigen::MatrixXd J(6, n + 6);
    J.leftCols(n) = numerics::product(misfit.jacobian, scale.asDiagonal());
    Matrix6 turn = Matrix6::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = balances[i].X_ES.R.transpose();
    J.rightCols(6) = misfit.whitening * noise.from_S * turn;
    H += numerics::transposed_product(J, J);
    g += numerics::transposed_product(J, misfit.residual);
  }
  H.topLeftCorner(n, n).diagonal().array() += 1e-6;  // numbers that nothing tells stay
  const Eigen::MatrixXd inverse = numerics::invert_symmetric(H);
  const Eigen::VectorXd step = -numerics::product(inverse, g);
  BiasStep result;
  result.bias = step.tail<6>();
  result.covariance = inverse.bottomRightCorner<6, 6>();
  result.error = result.covariance.diagonal().cwiseSqrt();
  result.change = -numerics::solve_symmetric(H.topLeftCorner(n, n), H.topRightCorner(n, 6));
  result.change = scale.asDiagonal() * result.change;
  return result;
}

}  // namespace snug::identification::internal
