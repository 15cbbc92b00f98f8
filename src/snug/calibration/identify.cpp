// Identification of an arm's geometry: residuals, two rounds of fitting, and what can be said against the data.
#include "snug/calibration/identify.hpp"

#include <algorithm>
#include <cmath>

#include "snug/calibration/exact_arm.hpp"
#include "snug/calibration/internal/complaints.hpp"
#include "snug/calibration/internal/frames.hpp"
#include "snug/calibration/internal/linear_fit.hpp"
#include "snug/calibration/internal/pose_row.hpp"
#include "snug/core/input_error.hpp"
#include "snug/numerics/dense.hpp"
#include "snug/numerics/least_squares.hpp"
#include "snug/numerics/outliers.hpp"
#include "snug/robot/kinematics.hpp"

namespace snug::calibration {
namespace {

/// Step of the central differences: their error, step^2, and rounding, 1e-16 / step, are both below 1e-9.
constexpr double kStep = 1e-6;
/// First guess of noise, only the ratio counts: a tracker of 0.1 mm over an arm's length of about 0.3 m.
constexpr double kFirstPositionNoise = 1e-4;  // m
constexpr double kFirstAngleNoise = 3e-4;     // rad
/// A combination of deviations (m, rad) of size 1 must move the ends by this on average, else it is undetermined.
constexpr double kSmallestSpread = 1e-3;

/// A joint may be read this far beyond its limit, rad or m; one without limits may have been turned this often, rad.
constexpr double kBeyondLimit = 0.1;
constexpr double kManyTurns = 100.0;

/// Two directions across a unit axis; for z they are x and y.
std::pair<Vector3, Vector3> across(const Vector3& axis) {
  const Vector3 guess = std::abs(axis.x()) < 0.9 ? Vector3::UnitX() : Vector3::UnitY();
  const Vector3 first = (guess - axis * axis.dot(guess)).normalized();
  return {first, axis.cross(first)};
}

/// What is measured less what the arm gives: (m, rad) for each pair.
class Model {
 public:
  Model(const robot::ArmModel& nominal, const PosePairs& pairs, const MeasuredFrames& frames)
      : nominal_(nominal), pairs_(pairs), frames_(frames) {}

  [[nodiscard]] Eigen::VectorXd errors(const Eigen::VectorXd& deviations) const {
    const robot::ArmModel arm = with_deviations(nominal_, deviations);
    const Pose X_WB = arm.X_WB * arm.links[static_cast<std::size_t>(frames_.base)].X_SL;
    const Pose& X_SF = arm.links[static_cast<std::size_t>(frames_.end)].X_SL;
    Eigen::VectorXd error(6 * static_cast<Eigen::Index>(pairs_.q.size()));
    for (std::size_t k = 0; k < pairs_.q.size(); ++k) {
      const Pose X_BF = X_WB.inverse() * robot::forward(arm, pairs_.q[k]).X_WS[arm.joints.size()] * X_SF;
      const auto row = 6 * static_cast<Eigen::Index>(k);
      error.segment<3>(row) = pairs_.X_BF[k].p - X_BF.p;
      error.segment<3>(row + 3) = log_rotation(pairs_.X_BF[k].R * X_BF.R.transpose());
    }
    return error;
  }

  [[nodiscard]] Eigen::MatrixXd jacobian(const Eigen::VectorXd& deviations) const {
    Eigen::MatrixXd J(6 * static_cast<Eigen::Index>(pairs_.q.size()), deviations.size());
    for (Eigen::Index i = 0; i < deviations.size(); ++i) {
      Eigen::VectorXd plus = deviations, minus = deviations;
      plus(i) += kStep;
      minus(i) -= kStep;
      J.col(i) = (errors(plus) - errors(minus)) / (2.0 * kStep);
    }
    return J;
  }

 private:
  const robot::ArmModel& nominal_;
  const PosePairs& pairs_;
  const MeasuredFrames& frames_;
};

struct Sizes {
  std::vector<double> positions;
  std::vector<double> angles;
};

Sizes group_sizes(const Eigen::VectorXd& error) {
  Sizes sizes;
  for (Eigen::Index row = 0; row < error.size(); row += 6) {
    sizes.positions.push_back(error.segment<3>(row).norm());
    sizes.angles.push_back(error.segment<3>(row + 3).norm());
  }
  return sizes;
}

Eigen::VectorXd weights(Eigen::Index rows, double position_noise, double angle_noise) {
  Eigen::VectorXd w(rows);
  for (Eigen::Index row = 0; row < rows; row += 6) {
    w.segment<3>(row).setConstant(1.0 / position_noise);
    w.segment<3>(row + 3).setConstant(1.0 / angle_noise);
  }
  return w;
}

double rms(const std::vector<double>& sizes) {
  double sum = 0.0;
  for (const double size : sizes) sum += size * size;
  return std::sqrt(sum / static_cast<double>(sizes.size()));
}

/// The deviation that the poses say least about.
void check_determined(const robot::ArmModel& arm, const PosePairs& pairs, const Eigen::MatrixXd& J) {
  const internal::Weakest weakest = internal::find_weakest(J, pairs.q.size());
  if (weakest.spread > kSmallestSpread) return;
  Eigen::Index worst = 0;
  weakest.direction.cwiseAbs().maxCoeff(&worst);
  throw InputError(pairs.table.name, deviation_name(arm, static_cast<int>(worst)),
                   "poses that leave this deviation (or one together with it) undetermined",
                   "poses in which every joint takes values a radian or more apart");
}

/// Residuals and derivatives of all pairs at one place: the terms, one for each pair, take their rows from it.
struct Evaluation {
  Eigen::VectorXd at;
  Eigen::VectorXd residual;
  Eigen::MatrixXd jacobian;
};

numerics::LeastSquaresResult fit(const Model& model, const Eigen::VectorXd& start, const Eigen::VectorXd& w,
                                 double loss_scale) {
  Evaluation last;
  std::vector<numerics::LeastSquaresTerm> terms;
  for (Eigen::Index row = 0; row < w.size(); row += 6) {
    terms.push_back(
        {6, {}, [&, row](const Eigen::VectorXd& x, const Eigen::VectorXd&, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
           if (last.at.size() != x.size() || last.at != x)
             last = {x, w.cwiseProduct(model.errors(x)), Eigen::MatrixXd()};
           if (J != nullptr && last.jacobian.size() == 0) last.jacobian = w.asDiagonal() * model.jacobian(x);
           r = last.residual.segment<6>(row);
           if (J != nullptr) *J = last.jacobian.middleRows<6>(row);
         }});
  }
  return numerics::solve_least_squares(terms, start, {.loss_scale = loss_scale});
}

void require_convergence(const numerics::LeastSquaresResult& result, const PosePairs& pairs) {
  if (!result.has_converged)
    throw InputError(pairs.table.name, "", "a fit that does not converge: " + result.message,
                     "poses of this arm, in the base named, in metres and radians");
}

}  // namespace

int deviation_count(const robot::ArmModel& arm) { return 4 * arm.joint_count() + 6; }

robot::ArmModel with_deviations(const robot::ArmModel& nominal, const Eigen::VectorXd& deviations) {
  robot::ArmModel arm = nominal;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const auto at = 4 * static_cast<Eigen::Index>(i);
    const auto [first, second] = across(arm.joints[i].axis);
    const Pose move{exp_rotation(deviations(at + 2) * first + deviations(at + 3) * second),
                    deviations(at) * first + deviations(at + 1) * second};
    arm.joints[i].X_SJ = arm.joints[i].X_SJ * move;
  }
  const Eigen::VectorXd end = deviations.tail<6>();
  internal::move_end(arm, {exp_rotation(end.tail<3>()), end.head<3>()});
  return arm;
}

std::string deviation_name(const robot::ArmModel& arm, int index) {
  const int joint = index / 4;
  static constexpr std::array<const char*, 4> kLine = {"shift along x", "shift along y", "turn about x",
                                                       "turn about y"};
  static constexpr std::array<const char*, 6> kEnd = {"shift along x", "shift along y", "shift along z",
                                                      "turn about x",  "turn about y",  "turn about z"};
  if (joint < arm.joint_count())
    return arm.joints[static_cast<std::size_t>(joint)].name + ": " + kLine[static_cast<std::size_t>(index % 4)];
  return std::string("end: ") + kEnd[static_cast<std::size_t>(index - 4 * arm.joint_count())];
}

PosePairs make_pose_pairs(Table table, const robot::ArmModel& arm) {
  if (!arm.followers.empty())
    throw InputError(arm.name, "joint '" + arm.followers.front().joint.name + "'", "a joint that mimics another",
                     "an arm each of whose joints moves by itself");
  PosePairs pairs;
  const auto n = arm.joints.size();
  for (std::size_t i = 0; i < n; ++i) {
    const robot::Joint& joint = arm.joints[i];
    const bool turns = joint.kind == robot::JointKind::Revolute;
    const double farthest = std::max(std::abs(joint.lower), std::abs(joint.upper));
    const double most = std::max(turns ? internal::kLargestTurn : internal::kFarthest,
                                 std::isfinite(farthest) ? farthest + kBeyondLimit : kManyTurns);
    internal::check_range(
        table, i, most,
        "a position of " + joint.name + (turns ? " in rad" : " in metres") + ", at most " + internal::to_text(most));
  }
  internal::check_poses(table, n);
  for (const std::vector<double>& row : table.rows) {
    pairs.q.push_back(Eigen::Map<const Eigen::VectorXd>(row.data(), static_cast<Eigen::Index>(n)));
    pairs.X_BF.push_back(internal::row_pose(row, n));
  }
  pairs.table = std::move(table);
  return pairs;
}

PosePairs load_pose_pairs(const std::filesystem::path& path, const robot::ArmModel& arm) {
  std::vector<std::string> columns;
  for (int i = 1; i <= arm.joint_count(); ++i) columns.push_back("q" + std::to_string(i));
  for (const char* column : {"x", "y", "z", "rx", "ry", "rz"}) columns.emplace_back(column);
  return make_pose_pairs(load_table(path, columns), arm);
}

IdentifiedArm identify_arm(const robot::ArmModel& nominal, const PosePairs& pairs, const MeasuredFrames& frames) {
  const int count = deviation_count(nominal);
  // Twice as many numbers as unknowns, so that noise can be told from deviations.
  internal::check_count(pairs.table, static_cast<std::size_t>(count / 3), "joint and pose pairs");
  const Model model(nominal, pairs, frames);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(count);
  const Eigen::VectorXd before = model.errors(none);
  check_determined(nominal, pairs, model.jacobian(none));

  // First round with a loss that forgives outliers: what they are, and how large the noise is.
  const Eigen::VectorXd first_weights = weights(before.size(), kFirstPositionNoise, kFirstAngleNoise);
  const numerics::LeastSquaresResult first = fit(model, none, first_weights, 3.0);
  require_convergence(first, pairs);
  const Sizes left = group_sizes(model.errors(first.x));
  constexpr double kRounding = 1e-10;  // m, rad: exact data have no outliers
  std::vector<std::size_t> outliers = numerics::find_outliers(left.positions, 3, kRounding);
  for (const std::size_t k : numerics::find_outliers(left.angles, 3, kRounding)) outliers.push_back(k);
  std::sort(outliers.begin(), outliers.end());
  outliers.erase(std::unique(outliers.begin(), outliers.end()), outliers.end());
  internal::check_outliers(pairs.table, outliers);

  // Second round: plain least squares, each kind weighed by its own noise.
  IdentifiedArm result;
  result.position_noise = std::max(kRounding, numerics::median_deviation(left.positions, 3));
  result.angle_noise = std::max(kRounding, numerics::median_deviation(left.angles, 3));
  const Eigen::VectorXd w = weights(before.size(), result.position_noise, result.angle_noise);
  const numerics::LeastSquaresResult second = fit(model, first.x, w, 0.0);
  require_convergence(second, pairs);
  result.deviations = second.x;
  result.iterations = first.iterations + second.iterations;
  const Eigen::VectorXd after = model.errors(second.x);
  const Eigen::MatrixXd J = w.asDiagonal() * model.jacobian(second.x);
  const Eigen::VectorXd weighted = w.cwiseProduct(after);
  const double variance = weighted.squaredNorm() / static_cast<double>(after.size() - count);
  const Eigen::MatrixXd normal = numerics::transposed_product(J, J);
  result.covariance = variance * numerics::invert_symmetric(normal);
  result.position_noise *= std::sqrt(variance);
  result.angle_noise *= std::sqrt(variance);
  const Sizes now = group_sizes(after);
  const Sizes then = group_sizes(before);
  result.rms_position = rms(now.positions);
  result.rms_angle = rms(now.angles);
  result.rms_position_before = rms(then.positions);
  result.rms_angle_before = rms(then.angles);
  result.arm = with_frames_near(with_deviations(nominal, second.x), nominal);
  return result;
}

}  // namespace snug::calibration
