// fit_pose_law, evaluate_pose_law: a cup's law by least squares beside the sensor's zero, its frames by a pattern
// search.
#include <algorithm>
#include <array>
#include <cmath>

#include "snug/core/input_error.hpp"
#include "snug/identification/cup_poses.hpp"
#include "snug/identification/internal/law_columns.hpp"
#include "snug/identification/internal/sensor_zero.hpp"

namespace snug::identification {
namespace {

using internal::columns_of;
using internal::SensorZero;
using internal::ZeroedSums;

constexpr std::size_t kParts = 5;         // of poses held back in turn
constexpr std::size_t kFewestPoses = 60;  // 288 numbers of four fifths of them against 23 and the frames' 6
using Coefficients = Eigen::Matrix<double, cup::kLawTerms, 1>;
using LinearFit = Eigen::Matrix<double, 6, 7>;  // on 1, place, rotation
using ZeroKnots = std::array<Eigen::VectorXd, 6>;

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

template <class Used>
SensorZero zero_of(const CupPoses& poses, bool drifts, const Used& is_used) {
  std::vector<bool> used(poses.poses.size());
  for (std::size_t i = 0; i < used.size(); ++i) used[i] = is_used(i);
  return {used, drifts};
}

/// A law's coefficients or a linear fit, with the zero that goes with them, in deviations.
struct FittedLaw {
  Coefficients coefficients;
  ZeroKnots zero;
  double squares = 0.0;  ///< that are left
};

FittedLaw fit_law(const CupPoses& poses, const Vector6& deviations, const SensorZero& zero, const PotentialLaw& law) {
  std::vector<ZeroedSums<cup::kLawTerms>> sums(6, ZeroedSums<cup::kLawTerms>(zero));
  for (std::size_t i = 0; i < zero.rows(); ++i) {
    if (!zero.is_used(i)) continue;
    const internal::LawColumns M = deviations.cwiseInverse().asDiagonal() * columns_of(law, poses.poses[i]);
    const Vector6 y = poses.wrenches[i].cwiseQuotient(deviations);
    for (std::size_t j = 0; j < 6; ++j) {
      const auto at = static_cast<Eigen::Index>(j);
      sums[j].add(zero, i, M.row(at), y[at]);
    }
  }
  ZeroedSums<cup::kLawTerms> whole(zero);
  for (ZeroedSums<cup::kLawTerms>& one : sums) {
    one.eliminate(zero);
    whole.A += one.A;
    whole.b += one.b;
    whole.squares += one.squares;
  }
  FittedLaw found;
  found.coefficients = internal::solve_ridged<cup::kLawTerms>(whole.A, whole.b);
  for (std::size_t j = 0; j < 6; ++j) found.zero[j] = sums[j].find_knots(zero, found.coefficients);
  found.squares =
      whole.squares - 2.0 * whole.b.dot(found.coefficients) + found.coefficients.dot(whole.A * found.coefficients);
  return found;
}

/// The mean of the zero over the rows used, in the reading's units.
Vector6 mean_zero(const SensorZero& zero, const ZeroKnots& knots, const Vector6& deviations) {
  Vector6 sum = Vector6::Zero();
  double count = 0.0;
  for (std::size_t i = 0; i < zero.rows(); ++i) {
    if (!zero.is_used(i)) continue;
    count += 1.0;
    for (std::size_t j = 0; j < 6; ++j) sum[static_cast<Eigen::Index>(j)] += zero.at(i, knots[j]);
  }
  return deviations.cwiseProduct(sum / count);
}

LinearFit fit_linear(const CupPoses& poses, const Vector6& deviations, const SensorZero& zero, ZeroKnots& knots) {
  LinearFit found;
  for (std::size_t j = 0; j < 6; ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    ZeroedSums<6> sums(zero);
    for (std::size_t i = 0; i < zero.rows(); ++i)
      if (zero.is_used(i))
        sums.add(zero, i, internal::linear_columns_of(poses.poses[i]).transpose(),
                 poses.wrenches[i][at] / deviations[at]);
    sums.eliminate(zero);
    const Vector6 slopes = internal::solve_ridged<6>(sums.A, sums.b);
    knots[j] = sums.find_knots(zero, slopes);
    found.row(at).tail<6>() = deviations[at] * slopes.transpose();
  }
  found.col(0) = mean_zero(zero, knots, deviations);
  return found;
}

/// The zero of what `predict` leaves of the rows used.
template <class Predict>
ZeroKnots fit_zero(const CupPoses& poses, const Vector6& deviations, const SensorZero& zero, const Predict& predict) {
  ZeroKnots knots;
  std::vector<Eigen::MatrixXd> sums(6, Eigen::MatrixXd::Zero(zero.knots(), 1));
  for (std::size_t i = 0; i < zero.rows(); ++i) {
    if (!zero.is_used(i)) continue;
    const Vector6 left = (poses.wrenches[i] - predict(poses.poses[i])).cwiseQuotient(deviations);
    for (std::size_t j = 0; j < 6; ++j)
      zero.add(i, Eigen::Matrix<double, 1, 1>(left[static_cast<Eigen::Index>(j)]), sums[j]);
  }
  for (std::size_t j = 0; j < 6; ++j) knots[j] = zero.solve(sums[j]);
  return knots;
}

/// Sums of squares over poses, by component, in deviations.
class Squares {
 public:
  void add(const Vector6& left) {
    sum_ += left.cwiseAbs2();
    poses_ += 1.0;
  }
  [[nodiscard]] Vector6 components() const { return (sum_ / poses_).cwiseSqrt(); }
  [[nodiscard]] double whole() const { return std::sqrt(sum_.sum() / (6.0 * poses_)); }

 private:
  Vector6 sum_ = Vector6::Zero();
  double poses_ = 0.0;
};

Vector6 zero_at(const SensorZero& zero, std::size_t row, const ZeroKnots& knots) {
  Vector6 value;
  for (std::size_t j = 0; j < 6; ++j) value[static_cast<Eigen::Index>(j)] = zero.at(row, knots[j]);
  return value;
}

/// Everything that is compared on poses held back: the law and the linear fit, each with both kinds of zero.
struct Compared {
  Squares law, law_drifting, linear, linear_drifting;

  [[nodiscard]] PoseErrors errors() const {
    PoseErrors out;
    out.zero_drifts = law_drifting.whole() < law.whole();
    out.constant_zero = law.whole();
    out.drifting_zero = law_drifting.whole();
    out.normalised = std::min(out.constant_zero, out.drifting_zero);
    out.linear = linear.whole();
    out.linear_drifting = linear_drifting.whole();
    out.components = out.zero_drifts ? law_drifting.components() : law.components();
    return out;
  }
};

/// Pattern search of the centre and the reference point, in every third pose. Coupling stands for the centre's height,
/// so one beyond the lip is taken only where it is clearly better.
void find_frames(const CupPoses& poses, const Vector6& deviations, bool drifts, PotentialLaw& law) {
  constexpr double kFirstStep = 0.016, kLastStep = 2e-4;  // m
  constexpr double kClearly = 0.98;                       // of the squares
  const SensorZero zero = zero_of(poses, drifts, [](std::size_t i) { return i % 3 == 0; });
  const auto left_by = [&](double height, PotentialLaw& one) {
    const auto coordinate = [&one](int i) -> double& { return i < 3 ? one.centre_B[i] : one.reference_B[i - 3]; };
    one.centre_B = Vector3(0.0, 0.0, height);
    one.reference_B = Vector3::Zero();
    double best = fit_law(poses, deviations, zero, one).squares;
    for (double step = kFirstStep; step > kLastStep; step *= 0.5) {
      for (bool improves = true; improves;) {
        improves = false;
        for (int i = 0; i < 6; ++i) {
          for (const double move : {step, -step}) {
            const double before = coordinate(i);
            coordinate(i) = std::clamp(before + move, -0.08, 0.08);
            const double squares = fit_law(poses, deviations, zero, one).squares;
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
  };
  PotentialLaw below = law, above = law;
  const double squares = left_by(-0.02, below);
  law = left_by(0.015, above) < kClearly * squares ? above : below;
}

/// Each fifth pose from the others; the coefficients of the five fits are the columns of `parts`.
void hold_back(const CupPoses& poses, const Vector6& deviations, const PotentialLaw& law, bool drifts, Squares& of_law,
               Squares& of_linear, Eigen::MatrixXd& parts) {
  parts.resize(cup::kLawTerms + 6, kParts);
  for (std::size_t part = 0; part < kParts; ++part) {
    const SensorZero zero = zero_of(poses, drifts, [part](std::size_t i) { return i % kParts != part; });
    const FittedLaw found = fit_law(poses, deviations, zero, law);
    ZeroKnots linear_zero;
    const LinearFit linear = fit_linear(poses, deviations, zero, linear_zero);
    parts.col(static_cast<Eigen::Index>(part)) << found.coefficients, mean_zero(zero, found.zero, deviations);
    for (std::size_t i = part; i < poses.poses.size(); i += kParts) {
      const Pose& X_BS = poses.poses[i];
      const Vector6 measured = poses.wrenches[i].cwiseQuotient(deviations);
      const Vector6 by_law = (columns_of(law, X_BS) * found.coefficients).cwiseQuotient(deviations);
      const Vector6 by_linear = (linear.rightCols<6>() * internal::linear_columns_of(X_BS)).cwiseQuotient(deviations);
      of_law.add(by_law + zero_at(zero, i, found.zero) - measured);
      of_linear.add(by_linear + zero_at(zero, i, linear_zero) - measured);
    }
  }
}

std::vector<Parameter> parameters_of(const PotentialLaw& law, const Eigen::MatrixXd& parts) {
  const Eigen::VectorXd mean = parts.rowwise().mean();
  const double count = static_cast<double>(kParts);
  const Eigen::VectorXd errors = ((parts.colwise() - mean).rowwise().squaredNorm() * (count - 1.0) / count).cwiseSqrt();
  const std::vector<std::string> names = coefficient_names();
  std::vector<Parameter> parameters;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const std::string kind = names[i].substr(0, names[i].find('_'));
    double scale = 0.0;  // the largest of its kind and unit
    for (std::size_t j = 0; j < names.size(); ++j)
      if (names[j].starts_with(kind) && unit_of_coefficient(names[j]) == unit_of_coefficient(names[i]))
        scale = std::max(scale, std::abs(law.coefficients[static_cast<Eigen::Index>(j)]));
    parameters.push_back(
        {names[i], law.coefficients[at], errors[at], unit_of_coefficient(names[i]), judge(errors[at], scale), ""});
  }
  return parameters;
}

}  // namespace

PoseErrors evaluate_pose_law(const CupPoses& poses, const PotentialLaw& law) {
  const Vector6 deviations = deviations_of(poses);
  const auto by_law = [&law](const Pose& X_BS) { return predict_wrench(law, X_BS); };
  const auto by_linear = [&law](const Pose& X_BS) {
    return Vector6(law.linear.rightCols<6>() * internal::linear_columns_of(X_BS) + law.linear.col(0));
  };
  Compared compared;
  for (std::size_t part = 0; part < kParts; ++part) {
    const SensorZero zero = zero_of(poses, true, [part](std::size_t i) { return i % kParts != part; });
    const ZeroKnots of_law = fit_zero(poses, deviations, zero, by_law);
    const ZeroKnots of_linear = fit_zero(poses, deviations, zero, by_linear);
    for (std::size_t i = part; i < poses.poses.size(); i += kParts) {
      const Vector6 measured = poses.wrenches[i];
      const Vector6 law_left = (by_law(poses.poses[i]) - measured).cwiseQuotient(deviations);
      const Vector6 linear_left = (by_linear(poses.poses[i]) - measured).cwiseQuotient(deviations);
      compared.law.add(law_left);
      compared.law_drifting.add(law_left + zero_at(zero, i, of_law));
      compared.linear.add(linear_left);
      compared.linear_drifting.add(linear_left + zero_at(zero, i, of_linear));
    }
  }
  return compared.errors();
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
  PotentialLaw constant;
  constant.rest = high;
  constant.half_range = 0.5 * (high - low);
  constant.middle = -constant.half_range;
  PotentialLaw drifting = constant;
  find_frames(poses, deviations, false, constant);
  find_frames(poses, deviations, true, drifting);
  Compared compared;
  Eigen::MatrixXd parts, parts_drifting;
  hold_back(poses, deviations, constant, false, compared.law, compared.linear, parts);
  hold_back(poses, deviations, drifting, true, compared.law_drifting, compared.linear_drifting, parts_drifting);
  PoseFit fit;
  fit.held_back = compared.errors();
  const bool drifts = fit.held_back.zero_drifts;
  fit.law = drifts ? drifting : constant;
  const auto all = [](std::size_t) { return true; };
  const SensorZero zero = zero_of(poses, drifts, all);
  const FittedLaw found = fit_law(poses, deviations, zero, fit.law);
  fit.law.coefficients.resize(cup::kLawTerms + 6);
  fit.law.coefficients << found.coefficients, mean_zero(zero, found.zero, deviations);
  ZeroKnots unused;
  fit.law.linear = fit_linear(poses, deviations, zero_of(poses, false, all), unused);
  fit.parameters = parameters_of(fit.law, drifts ? parts_drifting : parts);
  return fit;
}

}  // namespace snug::identification
