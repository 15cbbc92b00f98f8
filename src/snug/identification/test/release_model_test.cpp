// ReleaseModel: residuals of a swing in units of its noise, their derivatives, and what is looked for.
#include "snug/identification/internal/release_model.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "snug/core/rng.hpp"
#include "snug/cup/law.hpp"
#include "snug/identification/virtual_experiments.hpp"

namespace snug::identification::internal {
namespace {

constexpr model::CupElasticity kModelDamping{10.0, 15.0, 0.04, 0.025, 0.3};

Release swinging(PluckDirection direction, std::size_t samples) {
  Pluck pluck;
  pluck.load_S = {0.55, Vector3(0.006, -0.004, 0.08), Vector3(0.0021, 0.0022, 0.0038).asDiagonal()};
  pluck.frames = frames_of({});
  pluck.K = cup::as_matrix(model::CupParams{}.stiffness);
  pluck.D = cup::as_matrix(kModelDamping);
  pluck.direction = direction;
  pluck.amplitude = direction == PluckDirection::Axial ? 0.004 : 0.1;
  pluck.duration = static_cast<double>(samples) / pluck.rate;
  return make_pluck(pluck);
}

DampingOptions all_unknown() {
  DampingOptions options;
  options.prior = kModelDamping;
  options.with_coupling = options.with_stiffness = true;
  return options;
}

TEST(ReleaseUnknowns, AreTheDampingAndWhatElseIsAskedFor) {
  const Matrix6 K = cup::as_matrix(model::CupParams{}.stiffness);
  DampingOptions options;
  options.prior = kModelDamping;
  const Unknowns four = make_unknowns(options, K);
  EXPECT_EQ(four.names, (std::vector<std::string>{"d_lat", "d_ax", "d_bend", "d_tors"}));
  EXPECT_TRUE(four.stiffness.empty());
  EXPECT_EQ(four.prior, Eigen::Vector4d(10.0, 15.0, 0.04, 0.025));
  const Unknowns ten = make_unknowns(all_unknown(), K);
  ASSERT_EQ(ten.names.size(), 10U);
  EXPECT_EQ(ten.names[4], "d_c");
  EXPECT_EQ(ten.names[5], "k_lat");
  EXPECT_EQ(ten.units[9], "N/rad");
  // The numbers at their prior are the matrices that they were taken from.
  EXPECT_EQ(sum_of(ten.damping, ten.prior, 0), cup::as_matrix(kModelDamping));
  EXPECT_EQ(sum_of(ten.stiffness, ten.prior, 5), K);
  EXPECT_EQ(sum_of({}, ten.prior, 0), Matrix6(Matrix6::Zero()));
  EXPECT_NEAR(ten.scale[4], std::sqrt(10.0 * 0.04), 1e-12);
}

TEST(ReleaseModel, OfTheTruthHasNoResiduals) {
  for (const PluckDirection direction : {PluckDirection::Axial, PluckDirection::Bend}) {
    const Release release = swinging(direction, 100);
    const DampingOptions options = all_unknown();
    const Unknowns unknowns = make_unknowns(options, *release.K);
    const ReleaseModel model(release, unknowns, options, false);
    EXPECT_EQ(model.own(), 6);
    EXPECT_EQ(model.more_rows(), 0);
    Eigen::VectorXd r(600);
    model.evaluate(unknowns.prior, Eigen::VectorXd::Zero(6), 100, r, nullptr);
    EXPECT_LT(r.cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(ReleaseModel, CountsAShiftInUnitsOfTheNoise) {
  Release release = swinging(PluckDirection::Bend, 30);
  release.noise.position = 2e-4;
  release.noise.rotation = 1e-3;
  const DampingOptions options = all_unknown();
  const Unknowns unknowns = make_unknowns(options, *release.K);
  const ReleaseModel model(release, unknowns, options, false);
  EXPECT_EQ(model.position_noise(), 2e-4);
  release.X_ES[7].p += Vector3(0.0, -6e-4, 0.0);
  release.X_ES[8].R = release.X_ES[8].R * exp_rotation(Vector3(0.0, 0.0, 5e-3));
  Eigen::VectorXd r(180);
  model.evaluate(unknowns.prior, Eigen::VectorXd::Zero(6), 30, r, nullptr);
  // Simulated less measured: the sample went to -y, turned about +z.
  EXPECT_NEAR(r[6 * 7 + 1], 3.0, 1e-6);
  EXPECT_NEAR(r[6 * 8 + 5], -5.0, 1e-6);
  r.segment<6>(42).setZero();
  r.segment<6>(48).setZero();
  EXPECT_LT(r.norm(), 1e-6);
}

TEST(ReleaseModel, OfNoNoiseDoesNotDivideByIt) {
  Release release = swinging(PluckDirection::Axial, 25);
  release.noise.position = release.noise.rotation = 0.0;
  const DampingOptions options = all_unknown();
  const Unknowns unknowns = make_unknowns(options, *release.K);
  const ReleaseModel model(release, unknowns, options, false);
  EXPECT_NEAR(model.position_noise(), 1e-6 * MeasurementNoise{}.position, 1e-15);
  EXPECT_NEAR(model.rotation_noise(), 1e-6 * MeasurementNoise{}.rotation, 1e-15);
}

TEST(ReleaseModel, DerivativesAreThoseOfDifferences) {
  Release release = swinging(PluckDirection::Bend, 40);
  release.X_ES_start = release.X_ES.front();
  const DampingOptions options = all_unknown();
  const Unknowns unknowns = make_unknowns(options, *release.K);
  const ReleaseModel model(release, unknowns, options, true);
  ASSERT_EQ(model.own(), 12);
  ASSERT_EQ(model.more_rows(), 6);
  constexpr Eigen::Index kRows = 6 * 40 + 6;
  Eigen::VectorXd own(12);
  own << 0.3, -0.2, 0.1, 1.0, -2.0, 0.5, 0.02, -0.01, 0.03, 0.1, 0.2, -0.1;
  Eigen::VectorXd r(kRows), up(kRows), down(kRows);
  Eigen::MatrixXd J(kRows, 22);
  const Eigen::VectorXd theta = 1.1 * unknowns.prior;
  model.evaluate(theta, own, 40, r, &J);
  for (Eigen::Index column = 0; column < 22; ++column) {
    SCOPED_TRACE(column);
    const double step = column < 10 ? 1e-5 * unknowns.scale[column] : 1e-4;
    const auto at = [&](double sign, Eigen::VectorXd& out) {
      Eigen::VectorXd x = theta, mine = own;
      (column < 10 ? x[column] : mine[column - 10]) += sign * step;
      model.evaluate(x, mine, 40, out, nullptr);
    };
    at(1.0, up);
    at(-1.0, down);
    const Eigen::VectorXd numeric = (up - down) / (2.0 * step);
    // The variational equations are integrated with the trajectory's own error (free_swing.hpp): 2e-3 of their size.
    EXPECT_LT((numeric - J.col(column)).norm(), 2e-3 * J.col(column).norm() + 1e-6);
  }
}

TEST(ReleaseModel, KnowsAHeldStartTwentyTimesBetterThanASample) {
  Release release = swinging(PluckDirection::Axial, 25);
  release.X_ES_start = release.X_ES.front();
  const DampingOptions options = all_unknown();
  const Unknowns unknowns = make_unknowns(options, *release.K);
  const ReleaseModel model(release, unknowns, options, false);
  Eigen::VectorXd own = Eigen::VectorXd::Zero(6), r(156);
  own[0] = 1.0;  // a millimetre along x of S1, and of S
  model.evaluate(unknowns.prior, own, 25, r, nullptr);
  EXPECT_NEAR(r[150], 20.0 * 1e-3 / release.noise.position, 1e-6);
  EXPECT_NEAR(r.segment<5>(151).norm(), 0.0, 1e-9);
  // Residuals of samples alone leave those rows out.
  Eigen::VectorXd of_samples(150);
  model.evaluate(unknowns.prior, own, 25, of_samples, nullptr);
  EXPECT_EQ(of_samples, r.head<150>());
}

}  // namespace
}  // namespace snug::identification::internal
