// Laws of a cup from wrenches in many poses: the potential is one, its numbers come back, files are read strictly.
#include "snug/identification/cup_poses.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::identification {
namespace {

PotentialLaw stiffening_law() {
  PotentialLaw law;
  law.centre_B = Vector3(0.002, -0.001, -0.02);
  law.reference_B = Vector3(0.004, 0.002, -0.01);
  law.middle = -0.014;
  law.half_range = 0.006;
  law.coefficients.resize(23);
  law.coefficients << -12.0, 9.0, -3.0, 1.0, 0.5, -0.2, 900.0, -200.0, 80.0, 0.4, -0.1, 0.05, 6.0, 1.0, -0.5, 0.3, 0.02,
      0.1, -0.2, 0.3, 0.01, -0.02, 0.005;
  return law;
}

Pose any_pose(Rng& rng) {
  const auto draw = [&rng](double size) { return size * (2.0 * rng.uniform() - 1.0); };
  return {exp_rotation(Vector3(draw(0.3), draw(0.3), draw(0.3))),
          Vector3(draw(0.004), draw(0.004), -0.014 + draw(0.006))};
}

CupPoses measured(const PotentialLaw& law, int count, double noise) {
  Rng rng = Rng(5).split("cup poses");
  CupPoses poses;
  poses.source = "drawn";
  for (int i = 0; i < count; ++i) {
    poses.poses.push_back(any_pose(rng));
    Vector6 wrench = predict_wrench(law, poses.poses.back());
    for (Eigen::Index k = 0; k < 6; ++k) wrench[k] += noise * (k < 3 ? 1.0 : 0.01) * (2.0 * rng.uniform() - 1.0);
    poses.wrenches.push_back(wrench);
  }
  return poses;
}

TEST(PotentialLaw, WrenchIsTheGradientOfItsEnergy) {
  PotentialLaw law = stiffening_law();
  law.coefficients.tail<6>().setZero();
  Rng rng = Rng(7).split("gradient");
  for (int i = 0; i < 50; ++i) {
    SCOPED_TRACE(i);
    const Pose X_BS = any_pose(rng);
    const Vector6 wrench = predict_wrench(law, X_BS);
    constexpr double kStep =
        1e-6;  // differences of second order: 1e-12 of third derivatives below 1e7 N/m^2, and rounding
    for (int k = 0; k < 3; ++k) {
      const Vector3 shift = kStep * Vector3::Unit(k);
      const double slope =
          (stored_energy(law, {X_BS.R, X_BS.p + shift}) - stored_energy(law, {X_BS.R, X_BS.p - shift})) / (2.0 * kStep);
      EXPECT_NEAR(-slope, wrench[k], 1e-4 * (1.0 + std::abs(wrench[k])));
      // A turn about the reference point does the work of the torque about it.
      const auto turned = [&](double angle) {
        const Matrix3 R = exp_rotation(angle * Vector3::Unit(k));
        return Pose{R * X_BS.R, law.reference_B + R * (X_BS.p - law.reference_B)};
      };
      const double turn = (stored_energy(law, turned(kStep)) - stored_energy(law, turned(-kStep))) / (2.0 * kStep);
      EXPECT_NEAR(-turn, wrench[3 + k], 1e-5);
    }
  }
}

TEST(PotentialLaw, ComesBackFromItsOwnWrenches) {
  const PotentialLaw law = stiffening_law();
  const CupPoses poses = measured(law, 240, 0.02);
  const PoseFit fit = fit_pose_law(poses);
  // Noise of 0.0115 N rms against forces of 1 to 10 N; the frames are found to half a millimetre.
  EXPECT_LT(fit.held_back.normalised, 0.1);
  EXPECT_GT(fit.held_back.linear, 2.0 * fit.held_back.normalised);
  EXPECT_TRUE(find_unexplained(fit.held_back).empty());
  EXPECT_LT(evaluate_pose_law(measured(law, 240, 0.0), fit.law).normalised, 0.1);
}

TEST(PotentialLaw, SaysThatItDoesNotExplainChance) {
  CupPoses poses = measured(stiffening_law(), 120, 0.0);
  Rng rng = Rng(9).split("chance");
  for (Vector6& wrench : poses.wrenches) wrench[4] = rng.uniform();
  EXPECT_EQ(find_unexplained(fit_pose_law(poses).held_back), std::vector<std::string>{"ty"});
}

TEST(PotentialLaw, IsReadAsItWasWritten) {
  const PoseFit fit = fit_pose_law(measured(stiffening_law(), 80, 0.02));
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "snug-law.yaml";
  std::ofstream(path) << format_pose_law(fit, "drawn");
  const PotentialLaw law = load_pose_law(path);
  // Seven digits are written.
  const Pose X_BS{Matrix3::Identity(), Vector3(0.001, 0.002, -0.015)};
  EXPECT_LT((predict_wrench(law, X_BS) - predict_wrench(fit.law, X_BS)).norm(), 1e-4);
  std::ofstream(path) << "law:\n  centre: [0, 0, nan]\n";
  EXPECT_THROW((void)load_pose_law(path), InputError);
  std::filesystem::remove(path);
}

TEST(CupPoses, BrokenFilesAreRefusedWithTheirLine) {
  const std::string head = "x_mm,y_mm,z_mm,qw,qx,qy,qz,fx_N,fy_N,fz_N,tx_Nmm,ty_Nmm,tz_Nmm\n";
  for (const char* row :
       {"0,0,-8,1,1,0,0,0,0,6,0,0,0\n", "0,0,-8,1,0,0,0,0,0,nan,0,0,0\n", "0,0,-8,0,1,0,0,0,0,6,0,0,0\n", ""}) {
    SCOPED_TRACE(row);
    EXPECT_THROW((void)parse_cup_poses(head + row, "poses.csv"), InputError);
  }
  const CupPoses one = parse_cup_poses(head + "1,0,-8,1,0,0,0,0.5,0,6,0,20,0\n", "poses.csv");
  EXPECT_EQ(one.poses[0].p, Vector3(0.001, 0.0, -0.008));
  EXPECT_EQ(one.wrenches[0][4], 0.02);
  EXPECT_THROW((void)fit_pose_law(one), InputError);
}

}  // namespace
}  // namespace snug::identification
