// Rolling discs and balls, and boxes that ride on a turntable: second order in the step, and no loss by it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene.hpp"

namespace snug::physics::test {
namespace {

double energy_of(const Simulation& run) {
  return kinetic_energy(run.model, run.state) + potential_energy(run.model, run.state);
}

WorldModel ground_with(double friction, double dt, const BodyModel& body) {
  WorldModel model = on_plane({friction, 0.0, 0.0, 0.0}, {body});
  model.settings.dt = dt;
  return model;
}

struct Spun {
  double energy = 0.0;    ///< of the start, above that of the disc flat on the ground
  double inclined = 0.0;  ///< rad, of the axis against the vertical
};

/// Euler's disc in steady motion at 30 degrees: w along the diameter through the point of touch, w^2 = 4 g / (R sin a)
/// of a thin disc, and what its thickness adds.
Spun roll_disc(double dt, double seconds) {
  BodyModel disc;
  disc.name = "disc";
  disc.inertia.mass = 0.1;
  disc.inertia.inertia = Vector3(3.518958333333333e-05, 3.518958333333333e-05, 7.03125e-05).asDiagonal();
  disc.geoms = {{geometry::Cylinder{0.001, 0.0375}, Pose{}, 0, true}};
  disc.X_WB.p = Vector3(0.0, 0.0, 0.019616025403784435);
  disc.X_WB.R = exp_rotation(Vector3(0.0, std::numbers::pi / 6.0, 0.0));
  const WorldModel model = ground_with(0.6, dt, disc);
  Simulation run(model);
  run.body(1).angular_velocity = Vector3(-19.809088823063014, 0.0, 11.436782764396632);
  const double flat = 0.1 * 9.81 * 0.001, start = energy_of(run) - flat;
  run.steps(static_cast<int>(std::lround(seconds / dt)));
  return {(energy_of(run) - flat) / start, std::acos(run.body(1).quat_WB.toRotationMatrix()(2, 2))};
}

TEST(SecondOrder, EulersDiscKeepsItsEnergyAndItsInclination) {
  for (const double dt : {1e-3, 5e-4}) {
    SCOPED_TRACE(dt);
    const Spun spun = roll_disc(dt, 1.0);
    if (dt == 1e-3) RecordProperty("energy_kept", std::to_string(spun.energy));
    EXPECT_GE(spun.energy, 0.999);
    EXPECT_LE(spun.energy, 1.0005);
    EXPECT_NEAR(spun.inclined, std::numbers::pi / 6.0, 0.5 * std::numbers::pi / 180.0);
  }
}

TEST(SecondOrder, AnEccentricBallSpinsOnNearItsUprightAxis) {
  BodyModel ball;
  ball.name = "ball";
  ball.inertia.mass = 0.015;
  ball.inertia.com = Vector3(0.0, 0.0, -0.004);
  ball.inertia.inertia = Vector3(2.16e-6, 2.16e-6, 2.4e-6).asDiagonal();
  ball.geoms = {{geometry::Capsule{0.0, 0.02}, Pose{}, 0, true}};
  ball.X_WB = {exp_rotation(Vector3(0.0, 0.1, 0.0)), Vector3(0.0, 0.0, 0.02)};
  const WorldModel model = ground_with(0.3, 1e-3, ball);
  Simulation run(model);
  set_twist(model, run.state, BodyId{1},
            Twist{Vector3::Zero(), Vector3(200.0 * std::sin(0.1), 0.0, 200.0 * std::cos(0.1))});
  const double start = energy_of(run);
  double last = start;
  for (int i = 0; i < 1500; ++i) {
    (void)run.step();
    EXPECT_LE(energy_of(run), last + 1e-4 * start) << i;  // beyond what single steps err by
    last = energy_of(run);
  }
  // An integration at 1e-10: 2.4 degrees; it lies down at 110 where arms are those of the start of the step.
  const double tilt = std::acos(run.body(1).quat_WB.toRotationMatrix()(2, 2)) * 180.0 / std::numbers::pi;
  RecordProperty("tilt_deg", std::to_string(tilt));
  EXPECT_LE(tilt, 2.5);
  EXPECT_GT(last, 0.99 * start);  // what it slid at first
}

/// Farthest from its place on the table, m.
double creep_on_turntable(double angular, double radius, double friction, double seconds, const Vector3& size) {
  WorldModel model = world({friction, 0.0, 0.0, 0.0}, {friction, 0.0, 0.0, 0.0});
  BodyModel table = fixed_box({3.0, 3.0, 0.1}, {0.0, 0.0, -0.05});
  table.kind = BodyKind::Kinematic;
  model.bodies = {table, box(size, 1.0, {radius, 0.0, 0.5 * size.z()})};
  model.finalize();
  Simulation run(model);
  run.body(1).velocity = Vector3(0.0, angular * radius, 0.0);
  run.body(1).angular_velocity = Vector3(0.0, 0.0, angular);
  double worst = 0.0;
  const double dt = model.settings.dt;
  for (int i = 1; i <= static_cast<int>(std::lround(seconds / dt)); ++i) {
    const Vector3 turn(0.0, 0.0, angular * i * dt);
    const KinematicTarget target{
        BodyId{0}, {exp_rotation(turn), Vector3(0.0, 0.0, -0.05)}, Twist{Vector3::Zero(), turn / (i * dt)}};
    WorldInput input;
    input.kinematic = {&target, 1};
    (void)run.step(input);
    const Vector3 place = exp_rotation(-turn) * run.body(1).p_WBcm;
    worst = std::max(worst, (place - Vector3(radius, 0.0, place.z())).norm());
  }
  return worst;
}

TEST(SecondOrder, ABoxOnATurntableStaysInItsPlace) {
  const double drift = creep_on_turntable(1.0, 1.0, 0.3, 10.0, kBox);
  RecordProperty("drift_um", std::to_string(1e6 * drift));
  EXPECT_LE(drift, 5e-5);
  EXPECT_LE(creep_on_turntable(-0.5, 1.0, 0.3, 10.0, kBox), 5e-5);
}

TEST(SecondOrder, ABoxLeavesATurntableWhereFrictionIsTooLittle) {
  // 3 rad/s at 0.5 m ask for 4.5 m/s^2: friction of 0.4587.
  EXPECT_LE(creep_on_turntable(3.0, 0.5, 0.47, 2.0, {0.02, 0.02, 0.01}), 1e-3);
  EXPECT_GE(creep_on_turntable(3.0, 0.5, 0.45, 2.0, {0.02, 0.02, 0.01}), 0.1);
}

}  // namespace
}  // namespace snug::physics::test
