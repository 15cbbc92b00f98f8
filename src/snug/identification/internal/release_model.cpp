// ReleaseModel: residuals of a swing and their derivatives.
#include "snug/identification/internal/release_model.hpp"

#include <algorithm>

#include "snug/cup/law.hpp"
#include "snug/identification/internal/stiffness_form.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::identification::internal {
Matrix6 sum_of(const std::vector<Matrix6>& bases, const Eigen::VectorXd& theta, Eigen::Index first) {
  Matrix6 sum = Matrix6::Zero();
  for (std::size_t i = 0; i < bases.size(); ++i) sum += theta[first + static_cast<Eigen::Index>(i)] * bases[i];
  return sum;
}

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

ReleaseModel::ReleaseModel(const Release& release, const Unknowns& unknowns, const DampingOptions& options,
                           bool is_moving)
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
  to_S_ = inverse(cup::wrench_transform(release.frames.X_SS1).transpose());
  const MeasurementNoise least;
  position_ = std::max(release.noise.position, 1e-6 * least.position);
  rotation_ = std::max(release.noise.rotation, 1e-6 * least.rotation);
}

void ReleaseModel::evaluate(const Eigen::VectorXd& theta, const Eigen::VectorXd& own, std::size_t samples,
                            Eigen::VectorXd& r, Eigen::MatrixXd* J) const {
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

}  // namespace snug::identification::internal
