// Tests of the payload estimator: simulated lifts with sensor noise, honest covariance, what it does not know.
#include "snug/identification/payload.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "snug/cup/law.hpp"
#include "snug/identification/payload_file.hpp"
#include "snug/identification/test/helpers.hpp"
#include "snug/identification/virtual_lift.hpp"

namespace snug::identification {
namespace {

const model::CupParams kCup;

Lift make_plan(double mass, const Vector3& com) {
  Lift lift;
  lift.load_S = {mass, com, Matrix3(mass * Vector3(0.0038, 0.0040, 0.0069).asDiagonal())};
  lift.frames = frames_of(kCup);
  lift.K = cup::as_matrix(kCup.stiffness);
  lift.D = cup::as_matrix(kCup.damping);
  return lift;
}

PayloadSettings settings_of(const Lift& lift) {
  PayloadSettings settings;
  settings.K = lift.K;
  settings.frames = lift.frames;
  return settings;
}

PayloadEstimate estimate_of(const std::vector<PayloadSample>& samples, const PayloadSettings& settings) {
  PayloadEstimator estimator(settings);
  for (const PayloadSample& sample : samples) estimator.add(sample);
  return estimator.estimate();
}

TEST(LipUnderWrench, IsWhereTheCupGivesThatWrench) {
  const Lift lift = make_plan(1.0, Vector3(0.0, 0.0, 0.05));
  const Pose H{exp_rotation(Vector3(0.2, -0.15, 0.1)), Vector3(0.004, -0.003, 0.002)};
  const Vector6 f = cup::spring_wrench(H, lift.K);  // in S1 about S1
  const Pose X_ES1 = lift.frames.X_ES2 * H;
  Vector6 wrench_E;
  wrench_E << X_ES1.R * f.head<3>(), X_ES1.R * f.tail<3>() + X_ES1.p.cross(X_ES1.R * f.head<3>());
  const Pose X_ES = lip_under_wrench(lift.K, lift.frames, wrench_E);
  const Pose expected = X_ES1 * lift.frames.X_SS1.inverse();
  // Six fixed-point steps at 15 degrees: each takes the error by the square of the bending, some 1/15.
  EXPECT_LE((X_ES.p - expected.p).norm(), 2e-5);
  EXPECT_LE(angle_between(X_ES.R, expected.R), 2e-4);
}

TEST(Payload, IsKnownWithinTwoPercentAndFiveMillimetresAfterALift) {
  for (const double mass : {0.26, 0.55, 1.05}) {
    for (const Vector3& com : {Vector3(0.0, 0.0, 0.08), Vector3(0.02, -0.015, 0.05)}) {
      SCOPED_TRACE(mass);
      const Lift lift = make_plan(mass, com);
      std::vector<PayloadSample> samples = make_lift(lift);
      Rng rng = Rng(17).split("lift");
      const PayloadSettings settings = settings_of(lift);
      add_noise(samples, settings.noise, settings.force_bias, settings.torque_bias, rng);
      const PayloadEstimate found = estimate_of(samples, settings);
      EXPECT_NEAR(found.load_S.mass, mass, 0.02 * mass);
      EXPECT_LE((found.load_S.com - com).norm(), 5e-3) << found.load_S.com.transpose();
    }
  }
}

TEST(Payload, HasACovarianceThatCovers) {
  const Lift lift = make_plan(0.8, Vector3(0.01, -0.01, 0.06));
  const std::vector<PayloadSample> exact = make_lift(lift);
  const PayloadSettings settings = settings_of(lift);
  int covered = 0;
  constexpr int kSets = 100;
  double normalised = 0.0;
  for (int set = 0; set < kSets; ++set) {
    std::vector<PayloadSample> samples = exact;
    Rng rng = Rng(static_cast<std::uint64_t>(set)).split("lift");
    add_noise(samples, settings.noise, settings.force_bias, settings.torque_bias, rng);
    const PayloadEstimate found = estimate_of(samples, settings);
    Eigen::Vector4d error;
    error << found.load_S.mass - lift.load_S.mass, found.load_S.com - lift.load_S.com;
    const Eigen::Vector4d deviation = found.covariance.diagonal().head<4>().cwiseSqrt();
    for (int i = 0; i < 4; ++i) {
      covered += std::abs(error[i]) <= 1.96 * deviation[i];
      normalised += std::pow(error[i] / deviation[i], 2) / (4 * kSets);
    }
  }
  // At least what is said, and not three times too careful.
  EXPECT_GE(covered, 4 * kSets * 90 / 100);
  EXPECT_GE(normalised, 0.1);
}

TEST(Payload, IsUnknownBeforeTheFirstWindowAndBetterWithEachNext) {
  const Lift lift = make_plan(0.55, Vector3(0.0, 0.01, 0.07));
  const PayloadSettings settings = settings_of(lift);
  PayloadEstimator estimator(settings);
  EXPECT_EQ(estimator.estimate().windows, 0);
  double last = 1e9;
  int windows = 0;
  for (const PayloadSample& sample : make_lift(lift)) {
    estimator.add(sample);
    const PayloadEstimate now = estimator.estimate();
    if (now.windows == windows) continue;
    windows = now.windows;
    EXPECT_LE(now.mass_deviation(), last * (1.0 + 1e-9));
    last = now.mass_deviation();
  }
  EXPECT_EQ(windows, 14);  // 1.5 s in halves of 0.2 s, the first whole
}

TEST(Payload, IsNearlyExactWithoutNoise) {
  const Lift lift = make_plan(0.9, Vector3(0.015, 0.01, 0.05));
  PayloadSettings settings = settings_of(lift);
  std::vector<PayloadSample> samples = make_lift(lift);
  const PayloadEstimate found = estimate_of(samples, settings);
  // What is left: sums for integrals at 2 ms and a cup without its damping in the law of the lip's place.
  EXPECT_NEAR(found.load_S.mass, 0.9, 2e-3);
  EXPECT_LE((found.load_S.com - lift.load_S.com).norm(), 1e-3) << found.load_S.com.transpose();
}

/// A rigid lip that lifts a box straight up, as a table: 10 draws of the noise.
std::string straight_lift(double mass, const Vector3& com_S, double length, Rng& rng) {
  std::string text = "t,x,y,z,qw,qx,qy,qz,fx,fy,fz,tx,ty,tz\n";
  const Matrix3 R_WE = Vector3(1.0, -1.0, -1.0).asDiagonal();
  for (int k = 0; k <= 750; ++k) {
    const double t = 0.002 * k, w = 2.0 * 3.14159265 / 1.5;
    const double height = 0.3 * (t / 1.5 - std::sin(w * t) / (1.5 * w)), acceleration = 0.3 / 1.5 * w * std::sin(w * t);
    const Vector3 force = R_WE.transpose() * Vector3(0.0, 0.0, mass * (9.81 + acceleration));
    const Vector3 torque = (com_S + Vector3(0.0, 0.0, length)).cross(force);
    text += std::to_string(t) + ",0.4,0.1," + std::to_string(0.5 + height) + ",0,1,0,0";
    for (int i = 0; i < 3; ++i) text += "," + std::to_string(force[i] + 0.3 * rng.normal());
    for (int i = 0; i < 3; ++i) text += "," + std::to_string(torque[i] + 0.02 * rng.normal());
    text += "\n";
  }
  return text;
}

TEST(PayloadFile, SaysWhatALiftStraightUpDoesNotTell) {
  const CupFrames frames = frames_of(kCup);
  const Pose X_ES = frames.X_ES2 * frames.X_SS1.inverse();
  Rng rng = Rng(5).split("straight");
  PayloadSettings settings;
  settings.frames = frames;
  for (int draw = 0; draw < 10; ++draw) {
    SCOPED_TRACE(draw);
    const Vector3 com(rng.uniform(-0.03, 0.03), rng.uniform(-0.03, 0.03), rng.uniform(0.03, 0.1));
    const double mass = rng.uniform(0.4, 1.5);
    const std::vector<PayloadSample> lift =
        with_rigid_lip(parse_lift(straight_lift(mass, com, X_ES.p.z(), rng), "lift.csv"), frames);
    const std::vector<Parameter> told = judge_payload(estimate_of(lift, settings));
    EXPECT_EQ(told[0].verdict, Verdict::Identified);
    EXPECT_NEAR(told[0].value, mass, 0.02 * mass);
    for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
      EXPECT_EQ(told[1 + axis].verdict, Verdict::Identified);
      EXPECT_NEAR(told[1 + axis].value, com[static_cast<Eigen::Index>(axis)], 0.005);
    }
    EXPECT_EQ(told[3].verdict, Verdict::NotIdentifiable);
    EXPECT_NE(told[3].advice.find("straight up"), std::string::npos);
  }
}

TEST(PayloadFile, ThatCannotBeUsedIsRefusedWithFileAndLine) {
  const std::string head = "t,x,y,z,qw,qx,qy,qz,fx,fy,fz,tx,ty,tz\n";
  const auto refused = [&](const std::string& text, const char* part) {
    test::expect_refused([&] { (void)parse_lift(text, "lift.csv"); }, part);
  };
  refused(head + "0,0,0,0,1,0,0,0,0,0,5,0,0,0\n", "0.2 s or more");
  refused(head + "0,0,0,0,1,0,0,0,0,0,5,0,0,0\n0,0,0,0,1,0,0,0,0,0,5,0,0,0\n", "lift.csv:3");
  refused(head + "0,0,0,0,2,0,0,0,0,0,5,0,0,0\n", "quaternion");
  refused("t,x\n0,0\n", "fx");
}

}  // namespace
}  // namespace snug::identification
