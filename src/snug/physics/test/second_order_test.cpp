// Rolling discs and balls, and boxes that ride on a turntable: second order in the step, and no loss by it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

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

struct Rocked {
  std::vector<double> speeds;    ///< of each impact: the fraction of the angular speed at the flat pose that is left
  std::vector<double> energies;  ///< the same by the energy 30 ms after it and after the one before
};

/// A block that rocks on a plane without slipping, from rest at a tilt, for four impacts.
Rocked rock(const Vector3& size, double tilt, double dt) {
  BodyModel block = box(size, 1.0, Vector3::Zero());
  block.X_WB.R = exp_rotation(Vector3(0.0, tilt, 0.0));
  const Vector3 corner = block.X_WB.R * Vector3(std::copysign(0.5 * size.x(), tilt), 0.0, -0.5 * size.z());
  block.X_WB.p = Vector3(0.0, 0.0, -corner.z());
  const WorldModel model = ground_with(1.0, dt, block);
  Simulation run(model);
  const double about_edge = (size.x() * size.x() + size.z() * size.z()) / 3.0;  // inertia
  const auto speed_at_flat = [&](double angle) {
    const double risen = 0.5 * size.z() * (std::cos(angle) - 1.0) + 0.5 * size.x() * std::sin(std::abs(angle));
    const double speed = run.body(1).angular_velocity.y();
    return std::sqrt(speed * speed + 2.0 * 9.81 * risen / about_edge);
  };
  const double flat =
      9.81 * 0.5 * size.z() + energy_of(run) - kinetic_energy(model, run.state) - 9.81 * run.body(1).p_WBcm.z();
  double energy = energy_of(run) - flat, angle = tilt, speed = 0.0;
  Rocked rocked;
  int since = -1;
  for (int i = 0; i < static_cast<int>(3.0 / dt) && rocked.energies.size() < 4; ++i) {
    (void)run.step();
    const double now = 2.0 * run.body(1).quat_WB.y();
    if (now * angle < 0.0) since = 0;
    if (since < 0) speed = speed_at_flat(now);
    angle = now;
    if (since < 0) continue;
    ++since;
    if (since == static_cast<int>(0.003 / dt)) rocked.speeds.push_back(speed_at_flat(now) / speed);
    if (since < static_cast<int>(0.03 / dt)) continue;
    rocked.energies.push_back(std::sqrt((energy_of(run) - flat) / energy));
    energy = energy_of(run) - flat;
    since = -1;
  }
  return rocked;
}

TEST(SecondOrder, ABlockThatRocksKeepsHousnersRatioOnBothSides) {
  for (const Vector3& size : {Vector3(0.1, 0.2, 0.5), Vector3(0.12, 0.3, 0.4)}) {
    const double slender = std::atan(size.x() / size.z()), sine = std::sin(slender);
    const double expected = 1.0 - 1.5 * sine * sine;
    for (const double start : {0.36, -0.36, 0.52, -0.52, 0.71, -0.71}) {
      for (const double dt : {1e-3, 5e-4}) {
        SCOPED_TRACE(testing::Message() << size.x() << " m wide, from " << start << " of its slenderness, " << dt);
        const Rocked rocked = rock(size, start * slender, dt);
        EXPECT_GE(rocked.energies.size(), 3U);
        for (const double ratio : rocked.speeds) EXPECT_NEAR(ratio, expected, 2e-4);
        for (const double ratio : rocked.energies) EXPECT_NEAR(ratio, expected, 2e-4);
      }
    }
  }
}

TEST(SecondOrder, ABoxThatSlidesStopsAtTheWallThatItStrikes) {
  WorldModel model = ground_with(0.2, 1e-3, box(kBox, 1.0, {0.0, 0.0, 0.05}));
  model.bodies.push_back(fixed_box({0.1, 2.0, 1.0}, {0.1937, 0.0, 0.5}));
  model.finalize();
  Simulation run(model);
  run.body(1).velocity = Vector3(0.7, 0.0, 0.0);
  for (int i = 0; i < 200; ++i) {
    (void)run.step();
    EXPECT_LT(run.body(1).p_WBcm.x(), 0.0437 + 1e-6);
  }
  EXPECT_NEAR(run.body(1).p_WBcm.x(), 0.0437, 1e-6);
  EXPECT_LT(run.body(1).velocity.norm(), 1e-6);
}

}  // namespace
}  // namespace snug::physics::test
