// Rolling resistance and torsional friction: what rolls or spins comes to rest as the closed forms say, and stays
// there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene.hpp"

namespace snug::physics {
namespace {

using namespace test;

constexpr double kGravity = 9.81, kRadius = 0.05, kMass = 0.4;
constexpr double kBallFactor = 0.4, kRollFactor = 0.5;  ///< inertia over m r^2

BodyModel ball(const Vector3& p_WB) {
  BodyModel body;
  body.name = "ball";
  body.inertia.mass = kMass;
  body.inertia.inertia = kBallFactor * kMass * kRadius * kRadius * Matrix3::Identity();
  body.geoms = {{geometry::Capsule{0.0, kRadius}, Pose{}, 0, true}};
  body.X_WB.p = p_WB;
  return body;
}

/// A cylinder that lies along y.
BodyModel roll(const Vector3& p_WB) {
  constexpr double kHalf = 0.1;
  BodyModel body = ball(p_WB);
  body.name = "roll";
  const double across = kMass * (3.0 * kRadius * kRadius + 4.0 * kHalf * kHalf) / 12.0;
  body.inertia.inertia = Vector3(across, across, kRollFactor * kMass * kRadius * kRadius).asDiagonal();
  body.geoms[0].shape = geometry::Cylinder{kHalf, kRadius};
  body.X_WB.R = exp_rotation(Vector3(0.5 * std::numbers::pi, 0.0, 0.0));
  return body;
}

ContactLaw resisting(double rolling, double torsional = 0.0) {
  ContactLaw law{0.5, 0.0, 0.0, 0.0};
  law.rolling_resistance = rolling;
  law.torsional_friction = torsional;
  return law;
}

void tilt(WorldModel& model, double angle) {
  model.gravity = kGravity * Vector3(std::sin(angle), 0.0, -std::cos(angle));
}

void start_rolling(Simulation& run, double speed) {
  set_twist(run.model, run.state, BodyId{1}, {Vector3(speed, 0.0, 0.0), Vector3(0.0, speed / kRadius, 0.0)});
}

struct Roller {
  const char* name;
  BodyModel (*make)(const Vector3&);
  double factor;
};
constexpr Roller kRollers[] = {{"ball", ball, kBallFactor}, {"roll", roll, kRollFactor}};

TEST(RollingResistance, BringsBallsAndRollsToRestWhereTheClosedFormSays) {
  // Moments about the point of contact: (1 + factor) m r^2 times the angular deceleration is m g rho.
  const double speed = 0.5;
  for (const Roller& roller : kRollers) {
    for (const double rho : {0.5e-3, 2e-3}) {
      for (const double dt : {5e-4, 1e-3, 2e-3}) {
        SCOPED_TRACE(testing::Message() << roller.name << ", " << rho << " m, step " << dt);
        WorldModel model = on_plane(resisting(rho), {roller.make({-5.0, 0.0, kRadius})});
        model.settings.dt = dt;
        Simulation run(model);
        start_rolling(run, speed);
        const double deceleration = kGravity * rho / (kRadius * (1.0 + roller.factor));
        const double stop = speed / deceleration;
        run.steps(static_cast<int>(0.5 * stop / dt));
        EXPECT_NEAR(run.body(1).velocity.x(), speed - deceleration * dt * static_cast<int>(0.5 * stop / dt),
                    1e-4 * speed);
        run.steps(static_cast<int>(0.6 * stop / dt));
        EXPECT_LT(run.body(1).velocity.norm(), 1e-6);
        EXPECT_NEAR(run.body(1).p_WBcm.x() + 5.0, 0.5 * speed * stop,
                    0.6 * deceleration * dt * dt + 1e-4 * speed * stop);
        EXPECT_NEAR(run.body(1).p_WBcm.y(), 0.0, 1e-6);
      }
    }
  }
}

TEST(RollingResistance, HoldsOnASlopeUpToItsAngleAndNotBeyond) {
  const double rho = 2e-3;
  for (const Roller& roller : kRollers) {
    SCOPED_TRACE(roller.name);
    const double limit = std::atan(rho / kRadius);
    WorldModel model = on_plane(resisting(rho), {roller.make({-5.0, 0.0, kRadius})});
    tilt(model, 0.98 * limit);
    Simulation held(model);
    held.steps(3000);
    EXPECT_LT(std::abs(held.body(1).p_WBcm.x() + 5.0), 1e-8);
    EXPECT_LT(held.body(1).velocity.norm(), 1e-7);
    tilt(model, 1.5 * limit);
    Simulation rolls(model);
    rolls.steps(2000);
    const double acceleration =
        kGravity * (std::sin(1.5 * limit) - rho / kRadius * std::cos(1.5 * limit)) / (1.0 + roller.factor);
    EXPECT_NEAR(rolls.body(1).velocity.x(), 2.0 * acceleration, 2e-3 * 2.0 * acceleration);
  }
}

TEST(RollingResistance, MovesTheLineAboutWhichABoxTipsOutward) {
  // Upright, 60 mm deep and 200 mm high: tips beyond tan(angle) = (30 mm + rho) / 100 mm.
  const double rho = 5e-3;
  const auto top_after = [&](double angle) {
    ContactLaw law = resisting(rho);
    law.friction = 1.0;
    WorldModel model = on_plane(law, {box({0.06, 0.1, 0.2}, 0.5, {0.0, 0.0, 0.1})});
    tilt(model, angle);
    Simulation run(model);
    run.steps(3000);
    return run.body(1).p_WBcm.z();
  };
  const double limit = std::atan((0.03 + rho) / 0.1);
  EXPECT_NEAR(top_after(limit - 1e-3), 0.1, 1e-6);
  EXPECT_LT(top_after(limit + 1e-3), 0.05);
}

TEST(RollingResistance, LetsWhatItHoldsSleep) {
  WorldModel model = on_plane(resisting(2e-3), {ball({0.0, 0.0, kRadius})});
  model.settings.sleep.enabled = true;
  tilt(model, 0.03);
  Simulation run(model);
  run.steps(1000);
  EXPECT_GE(run.body(1).sleep_group, 0);
}

TEST(RollingResistance, DoesNotActOnABallThatBouncesOff) {
  // Restitution 0.8: the impulse of the impact must not bound moments in the steps after it.
  ContactLaw law = resisting(5e-3);
  law.restitution = 0.8;
  law.friction = 0.0;
  const WorldModel model = on_plane(law, {ball({0.0, 0.0, kRadius + 0.2})});
  Simulation run(model);
  const double spin = 40.0;
  set_twist(model, run.state, BodyId{1}, {Vector3::Zero(), Vector3(0.0, spin, 0.0)});
  double before = 0.0;
  while (run.body(1).velocity.z() <= 0.0) {
    before = run.body(1).velocity.z();
    (void)run.step();
  }
  const double after = run.body(1).angular_velocity.y();
  const double impulse = kMass * (run.body(1).velocity.z() - before + kGravity * model.settings.dt);
  EXPECT_NEAR(after, spin - law.rolling_resistance * impulse / (kBallFactor * kMass * kRadius * kRadius), 1e-9 * spin);
  run.steps(100);
  EXPECT_NEAR(run.body(1).angular_velocity.y(), after, 1e-12 * spin);  // impulses put in and taken out again
}

TEST(TorsionalFriction, StopsASpinningBallAtTheTimeOfTheClosedForm) {
  const double sigma = 1e-3, spin = 20.0;
  const double deceleration = sigma * kGravity / (kBallFactor * kRadius * kRadius);
  const WorldModel model = on_plane(resisting(0.0, sigma), {ball({0.0, 0.0, kRadius})});
  Simulation run(model);
  set_twist(model, run.state, BodyId{1}, {Vector3::Zero(), Vector3(0.0, 0.0, spin)});
  run.steps(1000);
  EXPECT_NEAR(run.body(1).angular_velocity.z(), spin - deceleration * 1.0, 1e-4 * spin);
  run.steps(static_cast<int>(1e3 * spin / deceleration) - 990);
  EXPECT_LT(run.body(1).angular_velocity.norm(), 1e-5);
  EXPECT_LT((run.body(1).p_WBcm - Vector3(0.0, 0.0, kRadius)).norm(), 1e-6);
}

TEST(TorsionalFriction, AddsToWhatThePointsOfALyingRollDo) {
  const auto time_to_rest = [](double sigma) {
    const WorldModel model = on_plane(resisting(0.0, sigma), {roll({0.0, 0.0, kRadius})});
    Simulation run(model);
    set_twist(model, run.state, BodyId{1}, {Vector3::Zero(), Vector3(0.0, 0.0, 10.0)});
    int steps = 0;
    while (run.body(1).angular_velocity.norm() > 1e-3 && steps < 5000) run.steps(1), ++steps;
    return steps;
  };
  EXPECT_LT(time_to_rest(20e-3), time_to_rest(0.0));
}

TEST(RollingResistance, ActsBetweenTwoBodiesThatMoveAndKeepsTheirMomentum) {
  // Two balls pressed together by wrenches, in free space, turning against each other about an axis across.
  WorldModel model = world(resisting(2e-3, 1e-3), resisting(0.0));
  model.bodies = {ball({-kRadius, 0.0, 0.0}), ball({kRadius, 0.0, 0.0})};
  model.gravity.setZero();
  model.finalize();
  Simulation run(model);
  set_twist(model, run.state, BodyId{0}, {Vector3::Zero(), Vector3(2.0, 0.0, 3.0)});
  set_twist(model, run.state, BodyId{1}, {Vector3::Zero(), Vector3(-2.0, 0.0, -3.0)});
  const double start = kinetic_energy(model, run.state);
  double before = start;
  for (int i = 0; i < 500; ++i) {
    const Vector3 across = (run.body(1).p_WBcm - run.body(0).p_WBcm).normalized();
    const ExternalWrench wrenches[] = {{BodyId{0}, Wrench{2.0 * across, Vector3::Zero()}},
                                       {BodyId{1}, Wrench{-2.0 * across, Vector3::Zero()}}};
    WorldInput input;
    input.wrenches = wrenches;
    (void)run.step(input);
    const double now = kinetic_energy(model, run.state);
    ASSERT_LE(now, before + 1e-9) << i;
    before = now;
  }
  EXPECT_LT(before, 0.5 * start);
  const Vector3 momentum = kMass * (run.body(0).velocity + run.body(1).velocity);
  EXPECT_LT(momentum.norm(), 1e-9);
  const Vector3 spin = run.body(0).angular_velocity + run.body(1).angular_velocity;
  EXPECT_LT(spin.norm(), 1e-6);
}

TEST(RollingResistance, IsTheSameWithAnotherWorkspaceAndFromASnapshot) {
  std::vector<BodyModel> bodies;
  for (int i = 0; i < 12; ++i) {
    BodyModel body = i % 2 == 0 ? ball({0.02 * i, 0.01 * i, 0.1 + 0.12 * i}) : roll({-0.01 * i, 0.0, 0.1 + 0.12 * i});
    bodies.push_back(body);
  }
  WorldModel model = on_plane(resisting(5e-3, 0.5e-3), bodies);
  model.settings.sleep.enabled = true;
  WorldState one = make_state(model), turns = make_state(model);
  Workspace work_one(model), work_a(model), work_b(model, 2);
  const auto is_asleep = [](const BodyState& body) { return body.sleep_group >= 0; };
  int i = 0;
  for (; i < 30000 && !std::all_of(one.bodies.begin() + 1, one.bodies.end(), is_asleep); ++i) {
    const StepReport report = step(model, {}, one, work_one);
    (void)step(model, {}, turns, i % 3 == 0 ? work_a : work_b);
    ASSERT_EQ(report.status, StepStatus::Converged) << i;
    ASSERT_EQ(hash_of(one), hash_of(turns)) << i;
  }
  EXPECT_TRUE(one == turns);
  EXPECT_LT(i, 30000) << "all come to rest";
}

}  // namespace
}  // namespace snug::physics
