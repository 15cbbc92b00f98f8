// Misfit of one static pose.
#include "snug/identification/internal/pose_misfit.hpp"

#include <algorithm>

#include "snug/core/input_error.hpp"
#include "snug/cup/law.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::identification::internal {
namespace {

constexpr int kMaxIterations = 10;
constexpr double kTolerance = 1e-5;  // of the noise; its square is what the misfit is off by
/// Noise of zero would divide by zero: a millionth of the demonstrator's counts instead.
constexpr double kLeastNoise = 1e-6;

Pose moved(const Pose& X_ES, const Vector6& shift) {
  return {X_ES.R * exp_rotation(shift.tail<3>()), X_ES.p + X_ES.R * shift.head<3>()};
}

/// Body twist of S at moved(X, shift) from a change of `shift`. The series of the right Jacobian ends at the third
/// power of the turn: 1e-7 at 0.02 rad.
Matrix6 twist_of_shift(const Vector6& shift) {
  const Matrix3 w = skew(Vector3(shift.tail<3>()));
  Matrix6 B;
  B << exp_rotation(-shift.tail<3>()), Matrix3::Zero(), Matrix3::Zero(), Matrix3::Identity() - 0.5 * w + w * w / 6.0;
  return B;
}

Pose deformation_at(const Pose& X_ES, const CupFrames& frames) { return frames.X_ES2.inverse() * X_ES * frames.X_SS1; }

}  // namespace

NoiseAtS1 carry_noise(const MeasurementNoise& noise, const CupFrames& frames) {
  const MeasurementNoise least;
  const auto variance = [](double value, double usual) {
    const double at_least = std::max(value, kLeastNoise * usual);
    return at_least * at_least;
  };
  NoiseAtS1 carried;
  carried.pose_S << Vector3::Constant(variance(noise.position, least.position)),
      Vector3::Constant(variance(noise.rotation, least.rotation));
  Vector6 wrench;
  wrench << Vector3::Constant(variance(noise.force, least.force)),
      Vector3::Constant(variance(noise.torque, least.torque));
  const Matrix6 X = cup::wrench_transform(frames.X_SS1);
  carried.to_S1 = X.transpose();
  carried.from_S = inverse(X);
  carried.pose = carried.to_S1 * carried.pose_S.asDiagonal() * carried.to_S1.transpose();
  carried.wrench = carried.from_S * wrench.asDiagonal() * carried.from_S.transpose();
  return carried;
}

Vector6 Balance::wanted(const Pose& at) const {
  if (!is_gravity) return wrench_S1;
  const Vector3 weight = at.R.transpose() * weight_S2;
  return -(Vector6() << weight, p_S1Scm.cross(weight)).finished();
}

Matrix6 Balance::wanted_tangent(const Pose& at) const {
  Matrix6 T = Matrix6::Zero();
  if (!is_gravity) return T;
  const Matrix3 turn = skew(Vector3(at.R.transpose() * weight_S2));
  T.topRightCorner<3, 3>() = -turn;
  T.bottomRightCorner<3, 3>() = -skew(p_S1Scm) * turn;
  return T;
}

std::vector<Balance> make_balances(const StaticPoses& poses, WrenchSource source) {
  const Matrix6 from_S = inverse(cup::wrench_transform(poses.frames.X_SS1));
  std::vector<Balance> balances;
  for (const StaticPose& pose : poses.poses) {
    Balance balance;
    balance.X_ES = pose.X_ES;
    balance.H = deformation_at(pose.X_ES, poses.frames);
    balance.is_gravity = source == WrenchSource::Gravity;
    if (balance.is_gravity) {
      if (!pose.load)
        throw InputError(pose.where, "", "no payload",
                         "mass, centre of mass and orientation of the gripper, for gravity's wrench");
      const Matrix3 R_WS2 = pose.load->R_WE * poses.frames.X_ES2.R;
      balance.weight_S2 = pose.load->mass * (R_WS2.transpose() * poses.gravity_W);
      balance.p_S1Scm = poses.frames.X_SS1.inverse() * pose.load->p_SScm;
    } else {
      if (!pose.wrench_S)
        throw InputError(pose.where, "", "no measured wrench", "one in every pose, or --wrench gravity");
      balance.wrench_S1 = from_S * *pose.wrench_S;
    }
    balances.push_back(balance);
  }
  return balances;
}

Misfit compute_misfit(const Balance& balance, const Matrix6& K, const NoiseAtS1& noise, const CupFrames& frames,
                      const Form* form) {
  Vector6 shift = Vector6::Zero();
  Pose H = balance.H;
  Misfit misfit;
  Matrix6& whitening = misfit.whitening;  // inverse of the lower factor of the covariance
  for (int i = 0;; ++i) {
    const Matrix6 A = (cup::spring_tangent(H, K) - balance.wanted_tangent(H)) * noise.to_S1 * twist_of_shift(shift);
    const Vector6 gap = cup::spring_wrench(H, K) - balance.wanted(H) - A * shift;
    Matrix6 covariance = A * noise.pose_S.asDiagonal() * A.transpose();
    if (!balance.is_gravity) covariance += noise.wrench;
    whitening = inverse(cholesky(covariance));
    misfit.residual = whitening * gap;
    const Vector6 next = -(noise.pose_S.asDiagonal() * (A.transpose() * (whitening.transpose() * misfit.residual)));
    const double change = ((next - shift).cwiseAbs2().cwiseQuotient(noise.pose_S)).sum();
    shift = next;
    H = deformation_at(moved(balance.X_ES, shift), frames);
    if (change < kTolerance * kTolerance || i >= kMaxIterations) break;
  }
  if (form == nullptr) return misfit;
  misfit.jacobian.resize(6, form->size());
  for (Eigen::Index i = 0; i < form->size(); ++i)
    misfit.jacobian.col(i) = cup::spring_wrench(H, form->numbers[static_cast<std::size_t>(i)].basis);
  misfit.jacobian = (whitening * misfit.jacobian).eval();
  return misfit;
}

Vector6 compute_prediction_error(const Balance& balance, const Matrix6& K, const CupFrames& frames) {
  const Matrix6 to_S1 = cup::wrench_transform(frames.X_SS1).transpose();
  Pose X_ES = balance.X_ES;
  for (int i = 0; i < 3; ++i) {  // Newton from the measured pose: noise to the eighth power is left
    const Pose H = deformation_at(X_ES, frames);
    const Matrix6 A = (cup::spring_tangent(H, K) - balance.wanted_tangent(H)) * to_S1;
    X_ES = moved(X_ES, snug::solve(A, balance.wanted(H) - cup::spring_wrench(H, K)));
  }
  const Pose error = X_ES.inverse() * balance.X_ES;
  return (Vector6() << error.p, log_rotation(error.R)).finished();
}

}  // namespace snug::identification::internal
