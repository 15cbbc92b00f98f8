// Hand-eye: closed form for the start (rotations by quaternions, then places), least squares with weights from there.
#include "snug/calibration/hand_eye.hpp"

#include <cmath>
#include <limits>

#include "snug/calibration/internal/complaints.hpp"
#include "snug/calibration/internal/pose_row.hpp"
#include "snug/core/input_error.hpp"
#include "snug/numerics/dense.hpp"

namespace snug::calibration {
namespace {

using Matrix4 = Eigen::Matrix4d;

struct Pair {
  Pose X_WE, X_CB;
};

/// q (x) p = left(q) p = right(p) q, with w first.
Matrix4 left(const Quaternion& q) {
  Matrix4 m;
  m << q.w(), -q.x(), -q.y(), -q.z(), q.x(), q.w(), -q.z(), q.y(), q.y(), q.z(), q.w(), -q.x(), q.z(), -q.y(), q.x(),
      q.w();
  return m;
}
Matrix4 right(const Quaternion& p) {
  Matrix4 m;
  m << p.w(), -p.x(), -p.y(), -p.z(), p.x(), p.w(), p.z(), -p.y(), p.y(), -p.z(), p.w(), p.x(), p.z(), p.y(), -p.x(),
      p.w();
  return m;
}

/// R_WE R_EB = R_WC R_CB for all pairs: an eigenvalue problem in the quaternion of R_WC over motions between pairs.
/// `spread`: how well it is determined, 0 when the tool turns about one axis only.
Matrix3 start_rotation(const std::vector<Pair>& pairs, double& spread) {
  Matrix4 sum = Matrix4::Zero();
  int count = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i)
    for (std::size_t k = i + 1; k < pairs.size(); ++k) {
      // R_A R_WC = R_WC R_B with the motions A of the tool in W and B of the board in C.
      Quaternion a(Matrix3(pairs[i].X_WE.R * pairs[k].X_WE.R.transpose()));
      Quaternion b(Matrix3(pairs[i].X_CB.R * pairs[k].X_CB.R.transpose()));
      if (a.w() < 0.0) a.coeffs() = -a.coeffs();
      if (b.w() < 0.0) b.coeffs() = -b.coeffs();
      const Matrix4 m = left(a) - right(b);
      sum += m.transpose() * m;
      ++count;
    }
  const numerics::Eigenpairs eigen = numerics::symmetric_eigenpairs(sum / count);
  spread = std::sqrt(std::max(0.0, eigen.values(1)));
  const Eigen::Vector4d q = eigen.vectors.col(0);
  return Quaternion(q(0), q(1), q(2), q(3)).normalized().toRotationMatrix();
}

/// Both places by linear least squares: R_WE p_EB - R_WC p_CB... = p_WC - p_WE.
void start_places(const std::vector<Pair>& pairs, Pose& X_WC, Pose& X_EB) {
  Eigen::MatrixXd A(3 * static_cast<Eigen::Index>(pairs.size()), 6);
  Eigen::VectorXd b(A.rows());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto row = 3 * static_cast<Eigen::Index>(i);
    A.block<3, 3>(row, 0) = -Matrix3::Identity();
    A.block<3, 3>(row, 3) = pairs[i].X_WE.R;
    b.segment<3>(row) = X_WC.R * pairs[i].X_CB.p - pairs[i].X_WE.p;
  }
  const Eigen::VectorXd x = numerics::solve_by_qr(A, b);
  X_WC.p = x.head<3>();
  X_EB.p = x.tail<3>();
}

/// What is left of a pair: board as the robot has it against board as the camera has it, in C.
Vector6 residual(const Pair& pair, const Pose& X_WC, const Pose& X_EB) {
  const Pose off = pair.X_CB.inverse() * (X_WC.inverse() * (pair.X_WE * X_EB));
  Vector6 r;
  r << pair.X_CB.R * off.p, log_rotation(pair.X_CB.R * off.R * pair.X_CB.R.transpose());
  return r;
}

Pose moved(const Pose& X, const Vector6& step) {
  return {orthonormalized(exp_rotation(step.tail<3>()) * X.R), X.p + step.head<3>()};
}

using Matrix12 = Eigen::Matrix<double, 12, 12>;
using Vector12 = Eigen::Matrix<double, 12, 1>;

/// One Gauss-Newton step with central differences; returns the information.
Matrix12 improve(const std::vector<Pair>& pairs, double position_noise, double angle_noise, Pose& X_WC, Pose& X_EB) {
  constexpr double kStep = 1e-6;
  Vector6 weights;
  weights << Vector3::Constant(1.0 / (position_noise * position_noise)),
      Vector3::Constant(1.0 / (angle_noise * angle_noise));
  Matrix12 H = Matrix12::Zero();
  Vector12 g = Vector12::Zero();
  for (const Pair& pair : pairs) {
    Eigen::Matrix<double, 6, 12> J;
    for (int k = 0; k < 12; ++k) {
      Vector6 step = Vector6::Zero();
      step(k % 6) = kStep;
      const auto at = [&](double sign) {
        return k < 6 ? residual(pair, moved(X_WC, sign * step), X_EB) : residual(pair, X_WC, moved(X_EB, sign * step));
      };
      J.col(k) = (at(1.0) - at(-1.0)) / (2.0 * kStep);
    }
    const Eigen::MatrixXd weighted = J.array().colwise() * weights.array();
    H += numerics::transposed_product(weighted, J);
    g += numerics::transposed_product(weighted, residual(pair, X_WC, X_EB));
  }
  const Vector12 step = -numerics::solve_symmetric(H, g);
  X_WC = moved(X_WC, step.head<6>());
  X_EB = moved(X_EB, step.tail<6>());
  return H;
}

void note_noise(const std::vector<Pair>& pairs, HandEye& found) {
  double positions = 0.0, angles = 0.0;
  for (const Pair& pair : pairs) {
    const Vector6 r = residual(pair, found.X_WC, found.X_EB);
    positions += r.head<3>().squaredNorm();
    angles += r.tail<3>().squaredNorm();
  }
  // Six of the twelve unknowns are rotations, six are places. Exact data: what rounding leaves.
  const double freedom = 3.0 * static_cast<double>(pairs.size()) - 6.0;
  found.position_noise = std::max(std::sqrt(positions / freedom), 1e-12);
  found.angle_noise = std::max(std::sqrt(angles / freedom), 1e-12);
}

}  // namespace

std::vector<std::string> hand_eye_columns() {
  return {"x", "y", "z", "rx", "ry", "rz", "cx", "cy", "cz", "crx", "cry", "crz"};
}

HandEye find_hand_eye(const Table& table) {
  internal::check_count(table, 4, "poses of the board");
  internal::check_poses(table, 0);
  internal::check_poses(table, 6);
  std::vector<Pair> pairs;
  for (const std::vector<double>& row : table.rows)
    pairs.push_back({internal::row_pose(row, 0), internal::row_pose(row, 6)});
  HandEye found;
  double spread = 0.0;
  found.X_WC.R = start_rotation(pairs, spread);
  // The quaternions of turns by an angle t about two axes differ by about t / 2: 5 degrees is too little.
  if (spread < 0.04)
    throw InputError(table.name, "", "poses of the tool turned about fewer than two axes",
                     "poses turned about at least two axes, by 20 degrees or more: else the camera is not determined");
  found.X_EB.R = pairs[0].X_WE.R.transpose() * found.X_WC.R * pairs[0].X_CB.R;
  start_places(pairs, found.X_WC, found.X_EB);
  note_noise(pairs, found);
  Matrix12 information = Matrix12::Identity();
  for (int i = 0; i < 12; ++i) {
    information = improve(pairs, found.position_noise, found.angle_noise, found.X_WC, found.X_EB);
    note_noise(pairs, found);
  }
  std::vector<std::size_t> outliers;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Vector6 r = residual(pairs[i], found.X_WC, found.X_EB);
    // Of so few rows one that is off makes the noise larger too: 4 of its standard deviations are many.
    if (r.head<3>().norm() > 4.0 * std::sqrt(3.0) * found.position_noise ||
        r.tail<3>().norm() > 4.0 * std::sqrt(3.0) * found.angle_noise)
      outliers.push_back(i);
  }
  internal::check_outliers(table, outliers);
  const Matrix12 covariance = numerics::invert_symmetric(information);
  found.covariance = covariance.topLeftCorner<6, 6>();
  found.board_covariance = covariance.bottomRightCorner<6, 6>();
  return found;
}

}  // namespace snug::calibration
