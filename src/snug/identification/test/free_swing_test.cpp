// FreeSwing: frequencies and decays in closed form, energy, symmetry, and times that may be cut as one likes.
#include "snug/identification/free_swing.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "snug/core/rng.hpp"
#include "snug/cup/law.hpp"
#include "snug/identification/internal/at_rest.hpp"
#include "snug/identification/virtual_experiments.hpp"

namespace snug::identification {
namespace {

constexpr model::CupElasticity kSwingCup{2300.0, 5500.0, 5.5, 2.8, -20.0};
const Matrix3 kSwingDown = Vector3(1.0, -1.0, -1.0).asDiagonal();

FreeSwing hanging_box() {
  FreeSwing swing;
  swing.load_S = {0.8, Vector3(0.0, 0.0, 0.06), Vector3(0.0021, 0.0025, 0.0038).asDiagonal()};
  swing.R_WE = kSwingDown;
  swing.frames = frames_of({});
  swing.K = cup::as_matrix(kSwingCup);
  return swing;
}

std::vector<double> even_times(int count, double period) {
  std::vector<double> times;
  for (int i = 0; i < count; ++i) times.push_back(i * period);
  return times;
}

/// Of spring, gravity and motion, J.
double energy_of(const FreeSwing& swing, const SwingSample& at) {
  const Pose H = swing.frames.X_ES2.inverse() * at.X_ES * swing.frames.X_SS1;
  const Pose X_S1S = swing.frames.X_SS1.inverse();
  const Vector3 w = at.twist_S1.tail<3>(), p_S1Scm = X_S1S * swing.load_S.com;
  const Vector3 v = at.twist_S1.head<3>() + w.cross(p_S1Scm);
  const Matrix3 I = X_S1S.R * swing.load_S.inertia * X_S1S.R.transpose();
  const Vector3 p_W = swing.R_WE * (at.X_ES * swing.load_S.com);
  return cup::potential(H, swing.K) + 0.5 * swing.load_S.mass * v.squaredNorm() + 0.5 * w.dot(I * w) -
         swing.load_S.mass * swing.gravity_W.dot(p_W);
}

Pose rest_of(const FreeSwing& swing) { return internal::hang(swing.load_S, swing.R_WE, swing.K, swing.frames).X_ES; }

/// Twist that moves the lip by `p` and turns it by `turn` from where it rests.
Pose displaced(const FreeSwing& swing, const Vector3& p, const Vector3& turn) {
  const Pose rest = rest_of(swing);
  return {rest.R * exp_rotation(turn), rest.p + p};
}

TEST(FreeSwing, StaysWhereTheLoadIsAtRest) {
  FreeSwing swing = hanging_box();
  swing.load_S.com = Vector3(0.02, -0.01, 0.06);
  const Pose rest = rest_of(swing);
  for (const SwingSample& sample : simulate_swing(swing, rest, Vector6::Zero(), even_times(20, 0.05))) {
    EXPECT_LT((sample.X_ES.p - rest.p).norm(), 1e-10);
    EXPECT_LT(angle_between(sample.X_ES.R, rest.R), 1e-9);
  }
}

TEST(FreeSwing, AlongTheAxisIsAMassOnASpring) {
  // m z'' = -k z - d z': along the axis the law is linear, and nothing else moves.
  for (const double damping : {0.0, 6.0, 15.0}) {
    SCOPED_TRACE(damping);
    FreeSwing swing = hanging_box();
    swing.D = cup::as_matrix({.axial = damping});
    const double k = kSwingCup.axial, m = swing.load_S.mass, a = 0.003;
    const double decay = 0.5 * damping / m, w = std::sqrt(k / m - decay * decay);
    const std::vector<double> times = even_times(200, 0.002);
    const std::vector<SwingSample> samples =
        simulate_swing(swing, displaced(swing, Vector3(0.0, 0.0, a), Vector3::Zero()), Vector6::Zero(), times);
    const double rest = rest_of(swing).p.z();
    for (std::size_t i = 0; i < times.size(); ++i) {
      const double t = times[i];
      const double z = a * std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t));
      // 2e-6 of the amplitude a step (free_swing.hpp) of 1/4 of the rate: 133 steps in 0.4 s.
      EXPECT_NEAR(samples[i].X_ES.p.z() - rest, z, 3e-4 * a);
      EXPECT_LT(samples[i].X_ES.p.head<2>().norm(), 1e-12);
    }
  }
}

TEST(FreeSwing, AboutTheAxisTurnsWithTheTorsionAndTheMomentOfInertia) {
  FreeSwing swing = hanging_box();
  const double w = std::sqrt(kSwingCup.torsion / swing.load_S.inertia(2, 2)), a = 0.01;
  const std::vector<double> times = even_times(200, 0.002);
  const std::vector<SwingSample> samples =
      simulate_swing(swing, displaced(swing, Vector3::Zero(), Vector3(0.0, 0.0, a)), Vector6::Zero(), times);
  for (std::size_t i = 0; i < times.size(); ++i)
    EXPECT_NEAR(log_rotation(samples[i].X_ES.R).z(), a * std::cos(w * times[i]), 1e-3 * a);  // sin a for a: 2e-5
}

TEST(FreeSwing, KeepsItsEnergyWithoutDampingAndLosesItWith) {
  FreeSwing swing = hanging_box();
  swing.load_S.com = Vector3(0.015, 0.01, 0.07);
  const Pose start = displaced(swing, Vector3(0.002, -0.001, 0.002), Vector3(0.1, 0.08, 0.05));
  const std::vector<double> times = even_times(150, 0.01);
  const std::vector<SwingSample> free = simulate_swing(swing, start, Vector6::Zero(), times);
  const Pose rest = rest_of(swing);
  const double least = energy_of(swing, {rest, Vector6::Zero(), {}});
  const double first = energy_of(swing, free.front()) - least;
  ASSERT_GT(first, 1e-3);
  // The fastest mode loses (1/4)^6 / 72 of its energy a step, some 500 steps a second.
  for (const SwingSample& sample : free) EXPECT_NEAR(energy_of(swing, sample) - least, first, 3e-3 * first);
  swing.D = cup::as_matrix({10.0, 15.0, 0.04, 0.025, 0.0});
  double before = HUGE_VAL;
  for (const SwingSample& sample : simulate_swing(swing, start, Vector6::Zero(), times)) {
    const double now = energy_of(swing, sample) - least;
    EXPECT_LT(now, before);
    before = now;
  }
  EXPECT_LT(before, 0.05 * first);
}

TEST(FreeSwing, LosesWhatItsDamperTakes) {
  // dE/dt = -nu^T D nu, over a span short enough for the trapezoidal rule.
  FreeSwing swing = hanging_box();
  swing.D = cup::as_matrix({10.0, 15.0, 0.04, 0.025, 0.2});
  const Pose start = displaced(swing, Vector3(0.003, 0.0, 0.001), Vector3(0.05, 0.1, 0.0));
  const std::vector<SwingSample> samples = simulate_swing(swing, start, 0.1 * Vector6::Ones(), even_times(2000, 1e-4));
  double taken = 0.0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const auto power = [&](const SwingSample& at) { return at.twist_S1.dot(swing.D * at.twist_S1); };
    taken += 0.5e-4 * (power(samples[i - 1]) + power(samples[i]));
  }
  const double lost = energy_of(swing, samples.front()) - energy_of(swing, samples.back());
  EXPECT_NEAR(lost, taken, 1e-4 * taken);
}

TEST(FreeSwing, IsTheSameFromAllSidesOfASymmetricCup) {
  FreeSwing swing = hanging_box();
  swing.D = cup::as_matrix({10.0, 15.0, 0.04, 0.025, 0.0});
  swing.load_S.com = Vector3(0.02, 0.005, 0.06);
  const Vector6 twist = (Vector6() << 0.05, -0.03, 0.02, 0.3, 0.2, -0.4).finished();
  const Pose start = displaced(swing, Vector3(0.001, 0.002, 0.001), Vector3(0.05, -0.08, 0.03));
  const std::vector<double> times = even_times(60, 0.01);
  const std::vector<SwingSample> samples = simulate_swing(swing, start, twist, times);
  const Matrix3 R = exp_rotation(Vector3(0.0, 0.0, 0.7));
  FreeSwing turned = swing;
  turned.load_S.com = R * swing.load_S.com;
  turned.load_S.inertia = R * swing.load_S.inertia * R.transpose();
  turned.R_WE = swing.R_WE * R.transpose();
  Vector6 turned_twist;
  turned_twist << R * twist.head<3>(), R * twist.tail<3>();
  const std::vector<SwingSample> there =
      simulate_swing(turned, {R * start.R * R.transpose(), R * start.p}, turned_twist, times);
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_LT((there[i].X_ES.p - R * samples[i].X_ES.p).norm(), 1e-9);
    EXPECT_LT((there[i].X_ES.R - R * samples[i].X_ES.R * R.transpose()).norm(), 1e-7);
  }
}

TEST(FreeSwing, GoesOnFromAnySampleAsIfItHadNotStopped) {
  FreeSwing swing = hanging_box();
  swing.D = cup::as_matrix({10.0, 15.0, 0.04, 0.025, 0.0});
  const std::vector<double> times = even_times(40, 0.01);
  const std::vector<SwingSample> whole = simulate_swing(
      swing, displaced(swing, Vector3(0.004, 0.0, 0.0), Vector3(0.0, 0.1, 0.02)), Vector6::Zero(), times);
  std::vector<double> rest(times.begin() + 15, times.end());
  for (double& time : rest) time += 100.0;  // the clock of the second part is another one
  const std::vector<SwingSample> second = simulate_swing(swing, whole[15].X_ES, whole[15].twist_S1, rest);
  for (std::size_t i = 0; i < second.size(); ++i) {
    EXPECT_LT((second[i].X_ES.p - whole[15 + i].X_ES.p).norm(), 1e-9);
    EXPECT_LT((second[i].twist_S1 - whole[15 + i].twist_S1).norm(), 1e-6);
  }
}

TEST(FreeSwing, OfMoreSamplesPassesThroughTheSamePoints) {
  const FreeSwing swing = hanging_box();
  const Pose start = displaced(swing, Vector3(0.002, 0.001, 0.003), Vector3(0.03, 0.06, -0.02));
  const std::vector<SwingSample> few = simulate_swing(swing, start, Vector6::Zero(), even_times(11, 0.02)),
                                 many = simulate_swing(swing, start, Vector6::Zero(), even_times(101, 0.002));
  for (std::size_t i = 0; i < few.size(); ++i)
    EXPECT_LT((few[i].X_ES.p - many[10 * i].X_ES.p).norm(), 2e-6);  // of 4 mm, steps 1 to 3 ms long
}

TEST(FreeSwing, CountsItsDirections) {
  SwingDirections directions;
  EXPECT_EQ(directions.count(), 0);
  directions.damping.assign(4, Matrix6::Identity());
  directions.stiffness.assign(5, Matrix6::Identity());
  EXPECT_EQ(directions.count(), 9);
  directions.by_start = directions.by_velocity = true;
  EXPECT_EQ(directions.count(), 21);
  const FreeSwing swing = hanging_box();
  const std::vector<SwingSample> samples =
      simulate_swing(swing, rest_of(swing), Vector6::Zero(), even_times(2, 0.01), directions);
  EXPECT_EQ(samples.back().by_what.cols(), 21);
  // Where it starts it is moved by the start alone, and by that entirely.
  EXPECT_EQ(samples.front().by_what.leftCols(9).norm(), 0.0);
  EXPECT_EQ(samples.front().by_what.rightCols(6).norm(), 0.0);
  EXPECT_GT(samples.front().by_what.middleCols(9, 6).norm(), 1.0);
}

TEST(FreeSwing, DoesNotFeelADamperThatNothingMoves) {
  const FreeSwing swing = hanging_box();
  SwingDirections directions;
  directions.damping = {cup::as_matrix({.axial = 1.0})};
  for (const SwingSample& sample :
       simulate_swing(swing, rest_of(swing), Vector6::Zero(), even_times(20, 0.01), directions))
    EXPECT_LT(sample.by_what.norm(), 1e-9);
}

}  // namespace
}  // namespace snug::identification
