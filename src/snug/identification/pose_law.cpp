// PotentialLaw: wrench and energy; its least squares, with the frames found by a pattern search.
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "snug/core/input_error.hpp"
#include "snug/cup/law.hpp"
#include "snug/cup/law_derivatives.hpp"
#include "snug/cup/potential_law.hpp"
#include "snug/identification/cup_poses.hpp"

namespace snug::identification {
namespace {

constexpr int kAxial = 6, kShear = 3, kTorsion = 2, kTare = 6;
static_assert(kAxial + 3 * kShear + kTorsion == cup::kLawTerms);
constexpr int kLaw = cup::kLawTerms, kLawAndTare = kLaw + kTare;
constexpr int kParts = 5;                 // of poses held back in turn
constexpr std::size_t kFewestPoses = 60;  // 288 numbers of four fifths of them against 23 and the frames' 6
using LawColumns = Eigen::Matrix<double, 6, kLawAndTare>;

/// q = e / 2 of the law in section 1 of docs/theory/cup.md, and dq = J nu of the body twist of S1.
struct Deformation {
  Vector6 q;
  Matrix6 J;
};

Deformation deformation_of(const Vector3& centre_B, const Pose& X_BS) {
  const Pose H{X_BS.R, X_BS * centre_B - centre_B};
  return {0.5 * cup::deformation(H), 0.5 * cup::deformation_jacobian(H)};
}

/// What the sensor reads for each coefficient at 1.
LawColumns columns_of(const PotentialLaw& law, const Pose& X_BS) {
  const Deformation deformation = deformation_of(law.centre_B, X_BS);
  const Eigen::Matrix<double, 6, kLaw> f =
      -deformation.J.transpose() * cup::law_terms(deformation.q, law.middle, law.half_range).gradient;
  LawColumns out = LawColumns::Zero();
  out.topLeftCorner<3, kLaw>() = X_BS.R * f.topRows<3>();
  out.bottomLeftCorner<3, kLaw>() =
      X_BS.R * f.bottomRows<3>() + skew(X_BS * law.centre_B - law.reference_B) * out.topLeftCorner<3, kLaw>();
  out.rightCols<kTare>() = Matrix6::Identity();
  return out;
}

Eigen::Matrix<double, 7, 1> linear_basis(const Pose& X_BS) {
  const Quaternion turn(X_BS.R);
  Eigen::Matrix<double, 7, 1> basis;
  basis << 1.0, X_BS.p, 2.0 * (turn.w() < 0.0 ? -1.0 : 1.0) * turn.vec();
  return basis;
}

Vector6 deviations_of(const CupPoses& poses) {
  Vector6 mean = Vector6::Zero(), squares = Vector6::Zero();
  const double n = static_cast<double>(poses.wrenches.size());
  for (const Vector6& wrench : poses.wrenches) mean += wrench / n;
  for (const Vector6& wrench : poses.wrenches) squares += (wrench - mean).cwiseAbs2() / n;
  const std::array<const char*, 6> names = {"fx_N", "fy_N", "fz_N", "tx_Nmm", "ty_Nmm", "tz_Nmm"};
  for (Eigen::Index i = 0; i < 6; ++i)
    if (!(squares[i] > 0.0))
      throw InputError(poses.source, names[static_cast<std::size_t>(i)], "the same in every pose",
                       "poses in which it changes");
  return squares.cwiseSqrt();
}

/// The poses i with is_used(i), coefficients by least squares in units of `deviations`; returns the sum of squares.
template <class Used>
double fit_coefficients(const CupPoses& poses, const Vector6& deviations, const Used& is_used, PotentialLaw& law) {
  Eigen::Matrix<double, kLawAndTare, kLawAndTare> A = Eigen::Matrix<double, kLawAndTare, kLawAndTare>::Zero();
  Eigen::Matrix<double, kLawAndTare, 1> b = Eigen::Matrix<double, kLawAndTare, 1>::Zero();
  double squares = 0.0;
  for (std::size_t i = 0; i < poses.poses.size(); ++i) {
    if (!is_used(i)) continue;
    const LawColumns M = deviations.cwiseInverse().asDiagonal() * columns_of(law, poses.poses[i]);
    const Vector6 y = poses.wrenches[i].cwiseQuotient(deviations);
    A.noalias() += M.transpose() * M;
    b.noalias() += M.transpose() * y;
    squares += y.squaredNorm();
  }
  // LawColumns of one size; a ridge of 1e-9 keeps those that the poses do not know at zero.
  const Eigen::Matrix<double, kLawAndTare, 1> size = A.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::Matrix<double, kLawAndTare, kLawAndTare> scaled = size.asDiagonal() * A * size.asDiagonal();
  const Eigen::Matrix<double, kLawAndTare, kLawAndTare> kept =
      scaled + 1e-9 * Eigen::Matrix<double, kLawAndTare, kLawAndTare>::Identity();
  const Eigen::Matrix<double, kLawAndTare, 1> found = size.asDiagonal() * kept.ldlt().solve(size.asDiagonal() * b);
  law.coefficients = found;
  return squares - 2.0 * b.dot(found) + found.dot(A * found);
}

template <class Used>
void fit_linear(const CupPoses& poses, const Used& is_used, PotentialLaw& law) {
  Eigen::Matrix<double, 7, 7> A = Eigen::Matrix<double, 7, 7>::Zero();
  Eigen::Matrix<double, 7, 6> b = Eigen::Matrix<double, 7, 6>::Zero();
  for (std::size_t i = 0; i < poses.poses.size(); ++i) {
    if (!is_used(i)) continue;
    const Eigen::Matrix<double, 7, 1> basis = linear_basis(poses.poses[i]);
    A += basis * basis.transpose();
    b += basis * poses.wrenches[i].transpose();
  }
  const Eigen::Matrix<double, 7, 1> size = A.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::Matrix<double, 7, 7> scaled = size.asDiagonal() * A * size.asDiagonal();
  const Eigen::Matrix<double, 7, 7> kept = scaled + 1e-9 * Eigen::Matrix<double, 7, 7>::Identity();
  const Eigen::Matrix<double, 7, 6> found = size.asDiagonal() * kept.ldlt().solve(size.asDiagonal() * b);
  law.linear = found.transpose();
}

/// Pattern search of the centre and the reference point from a centre at this height: in every third pose.
double find_frames(const CupPoses& poses, const Vector6& deviations, double height, PotentialLaw& law) {
  const auto third = [](std::size_t i) { return i % 3 == 0; };
  const auto coordinate = [&law](int i) -> double& { return i < 3 ? law.centre_B[i] : law.reference_B[i - 3]; };
  law.centre_B = Vector3(0.0, 0.0, height);
  law.reference_B = Vector3::Zero();
  double best = fit_coefficients(poses, deviations, third, law);
  for (double step = 0.016; step > 4e-4; step *= 0.5) {
    for (bool improves = true; improves;) {
      improves = false;
      for (int i = 0; i < 6; ++i) {
        for (const double move : {step, -step}) {
          const double before = coordinate(i);
          coordinate(i) = std::clamp(before + move, -0.08, 0.08);
          const double squares = fit_coefficients(poses, deviations, third, law);
          if (squares < best * (1.0 - 1e-6)) {
            best = squares;
            improves = true;
            break;
          }
          coordinate(i) = before;
        }
      }
    }
  }
  return best;
}

void add_squares(const CupPoses& poses, std::size_t i, const Vector6& deviations, const PotentialLaw& law,
                 Vector6& of_law, double& of_linear) {
  const Vector6& measured = poses.wrenches[i];
  of_law += (predict_wrench(law, poses.poses[i]) - measured).cwiseQuotient(deviations).cwiseAbs2();
  of_linear += (law.linear * linear_basis(poses.poses[i]) - measured).cwiseQuotient(deviations).squaredNorm();
}

PoseErrors pose_errors_of(const Vector6& of_law, double of_linear, std::size_t poses) {
  const double n = static_cast<double>(poses);
  return {std::sqrt(of_law.sum() / (6.0 * n)), std::sqrt(of_linear / (6.0 * n)), (of_law / n).cwiseSqrt()};
}

/// Each fifth pose from the others; the coefficients of the five fits are the columns of `found`.
PoseErrors hold_back(const CupPoses& poses, const Vector6& deviations, PotentialLaw law, Eigen::MatrixXd& found) {
  Vector6 of_law = Vector6::Zero();
  double of_linear = 0.0;
  found.resize(kLawAndTare, kParts);
  for (std::size_t part = 0; part < kParts; ++part) {
    const auto others = [part](std::size_t i) { return i % kParts != part; };
    (void)fit_coefficients(poses, deviations, others, law);
    fit_linear(poses, others, law);
    found.col(static_cast<Eigen::Index>(part)) = law.coefficients;
    for (std::size_t i = part; i < poses.poses.size(); i += kParts)
      add_squares(poses, i, deviations, law, of_law, of_linear);
  }
  return pose_errors_of(of_law, of_linear, poses.poses.size());
}

}  // namespace

std::vector<std::string> coefficient_names() {
  std::vector<std::string> names;
  const auto add = [&names](const std::string& name, int count) {
    for (int i = 0; i < count; ++i) names.push_back(name + "_" + std::to_string(i));
  };
  add("axial", kAxial);
  for (const char* name : {"lateral", "bend", "coupling"}) add(name, kShear);
  add("torsion", kTorsion);
  for (const char* name : {"fx", "fy", "fz", "tx", "ty", "tz"}) names.push_back(std::string("tare_") + name);
  return names;
}

std::string unit_of_coefficient(const std::string& name) {
  if (name.starts_with("lateral")) return "N/m";
  if (name.starts_with("bend") || name.starts_with("torsion")) return "Nm/rad";
  return name.starts_with("tare_t") ? "Nm" : "N";
}

Vector6 predict_wrench(const PotentialLaw& law, const Pose& X_BS) { return columns_of(law, X_BS) * law.coefficients; }

double stored_energy(const PotentialLaw& law, const Pose& X_BS) {
  const cup::LawTerms terms = cup::law_terms(deformation_of(law.centre_B, X_BS).q, law.middle, law.half_range);
  return terms.energy.dot(law.coefficients.head<kLaw>().transpose());
}

std::vector<std::string> find_unexplained(const PoseErrors& errors) {
  std::vector<std::string> names;
  Eigen::Index i = 0;
  for (const char* name : {"fx", "fy", "fz", "tx", "ty", "tz"})
    if (!(errors.components[i++] <= kExplainedComponent)) names.emplace_back(name);
  return names;
}

PoseErrors evaluate_pose_law(const CupPoses& poses, const PotentialLaw& law) {
  const Vector6 deviations = deviations_of(poses);
  Vector6 of_law = Vector6::Zero();
  double of_linear = 0.0;
  for (std::size_t i = 0; i < poses.poses.size(); ++i) add_squares(poses, i, deviations, law, of_law, of_linear);
  return pose_errors_of(of_law, of_linear, poses.poses.size());
}

PoseFit fit_pose_law(const CupPoses& poses) {
  if (poses.poses.size() < kFewestPoses)
    throw InputError(poses.source, "", std::to_string(poses.poses.size()) + " poses",
                     std::to_string(kFewestPoses) + " or more");
  const Vector6 deviations = deviations_of(poses);
  double low = poses.poses.front().p.z(), high = low;
  for (const Pose& pose : poses.poses) low = std::min(low, pose.p.z()), high = std::max(high, pose.p.z());
  if (!(high - low > 1e-4))
    throw InputError(poses.source, "z_mm", "the same in every pose", "poses at several compressions");
  PoseFit fit;
  PotentialLaw below, above;
  for (PotentialLaw* law : {&below, &above}) law->middle = 0.5 * (low + high), law->half_range = 0.5 * (high - low);
  const double squares = find_frames(poses, deviations, -0.02, below);
  fit.law = find_frames(poses, deviations, 0.015, above) < squares ? above : below;
  Eigen::MatrixXd parts;
  fit.held_back = hold_back(poses, deviations, fit.law, parts);
  const auto all = [](std::size_t) { return true; };
  (void)fit_coefficients(poses, deviations, all, fit.law);
  fit_linear(poses, all, fit.law);
  const Eigen::VectorXd mean = parts.rowwise().mean();
  const Eigen::VectorXd errors =
      (((parts.colwise() - mean).rowwise().squaredNorm()) * (kParts - 1.0) / kParts).cwiseSqrt();
  const std::vector<std::string> names = coefficient_names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const std::string kind = names[i].substr(0, names[i].find('_'));
    double scale = 0.0;  // the largest of its kind and unit
    for (std::size_t j = 0; j < names.size(); ++j)
      if (names[j].starts_with(kind) && unit_of_coefficient(names[j]) == unit_of_coefficient(names[i]))
        scale = std::max(scale, std::abs(fit.law.coefficients[static_cast<Eigen::Index>(j)]));
    fit.parameters.push_back(
        {names[i], fit.law.coefficients[at], errors[at], unit_of_coefficient(names[i]), judge(errors[at], scale), ""});
  }
  return fit;
}

}  // namespace snug::identification
