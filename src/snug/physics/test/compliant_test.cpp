// Compliant contacts: decay, frequency and equilibrium of the spring and damper that the law describes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "scene.hpp"

namespace snug::physics {
namespace {

using namespace test;

struct Decay {
  double stiffness, damping, mass;
  Vector3 size;
};

/// Rate at which a bouncing box that never leaves the floor loses amplitude, 1/s: from the heights above equilibrium at
/// the first and the last of its turning points.
double measured_decay(const Decay& decay, double dt) {
  WorldModel model = on_plane({0.2, 0.0, decay.stiffness, decay.damping}, {});
  model.settings.dt = dt;
  const double sink = decay.mass * 9.81 / decay.stiffness;
  const double rest = 0.5 * decay.size.z() - sink;
  model.bodies.push_back(box(decay.size, decay.mass, {0.0, 0.0, rest - 0.9 * sink}));
  model.finalize();
  Simulation run(model);
  struct Peak {
    double time, height;
  };
  std::vector<Peak> peaks;
  double before = 0.0, last = run.body(1).p_WBcm.z() - rest;
  for (int i = 1; i < 20000 && peaks.size() < 12; ++i) {
    (void)run.step();
    const double now = run.body(1).p_WBcm.z() - rest;
    if (i > 1 && (last - before) * (now - last) < 0.0) {  // parabola through three points
      const double bend = before - 2.0 * last + now, slope = 0.5 * (now - before);
      peaks.push_back({(i - 1 - slope / bend) * dt, std::abs(last - 0.5 * slope * slope / bend)});
    }
    before = last, last = now;
  }
  return std::log(peaks.front().height / peaks.back().height) / (peaks.back().time - peaks.front().time);
}

TEST(CompliantContact, DecaysAsItsDampingSaysAtAnyStep) {
  const Vector3 cube(0.1, 0.1, 0.1);
  const Decay decays[] = {{1e4, 20.0, 1.0, cube},
                          {1.2e4, 50.0, 0.55, cube},
                          {4e4, 10.0, 1.0, cube},
                          {1e5, 40.0, 2.0, cube},
                          {1.2e4, 10.0, 0.26, {0.2, 0.15, 0.05}}};
  for (const Decay& decay : decays) {
    SCOPED_TRACE(decay.stiffness);
    const double expected = 0.5 * decay.damping / decay.mass;
    // Parabolas through three samples of a sine miss its height by the square of the phase between them.
    EXPECT_NEAR(measured_decay(decay, 5e-4) / expected, 1.0, 0.01);
    EXPECT_NEAR(measured_decay(decay, 1e-3) / expected, 1.0, 0.01);
    EXPECT_NEAR(measured_decay(decay, 2e-3) / expected, 1.0, 0.02);
  }
}

TEST(CompliantContact, KeepsItsEnergyWithoutDamping) {
  const WorldModel model = on_plane({0.0, 0.0, 2e4, 0.0}, {box({0.1, 0.1, 0.1}, 1.0, {0.0, 0.0, 0.0492})});
  Simulation run(model);
  const auto energy = [&] {
    const double depth = 0.05 - run.body(1).p_WBcm.z();
    return kinetic_energy(model, run.state) + potential_energy(model, run.state) + 0.5 * 2e4 * depth * depth;
  };
  const double start = energy();
  for (int i = 0; i < 5000; ++i) {
    (void)run.step();
    ASSERT_NEAR(energy(), start, 1e-9);
  }
}

TEST(CompliantContact, StaysInTheEquilibriumItStartsIn) {
  for (const double dt : {5e-4, 1e-3, 5e-3}) {
    SCOPED_TRACE(dt);
    WorldModel model = on_plane({0.2, 0.0, 1.2e4, 50.0}, {});
    model.settings.dt = dt;
    const double height = 0.05 - 0.55 * 9.81 / 1.2e4;
    model.bodies.push_back(box({0.1, 0.1, 0.1}, 0.55, {0.0, 0.0, height}));
    model.finalize();
    Simulation run(model);
    run.steps(1000);
    EXPECT_NEAR(run.body(1).p_WBcm.z(), height, 1e-10);
    EXPECT_LT(run.body(1).velocity.norm(), 1e-8);
  }
}

TEST(CompliantContact, CreepsBackByTheRatioOfStiffnessAndDamping) {
  // Damping that a step cannot resolve: m/d = 0.2 ms. The box rises out of 5 mm with the time constant d/k = 50 ms; its
  // weight keeps it on the floor while it slows down.
  const WorldModel model = on_plane({0.2, 0.0, 1e4, 500.0}, {box({0.1, 0.1, 0.1}, 0.1, {0.0, 0.0, 0.045})});
  Simulation run(model);
  run.steps(50);
  const double sink = 0.1 * 9.81 / 1e4;
  EXPECT_NEAR(0.05 - run.body(1).p_WBcm.z(), sink + (5e-3 - sink) * std::exp(-1.0), 0.02 * 5e-3);
}

TEST(CompliantContact, DoesNotRingWhenItsDampingIsFarBeyondTheStep) {
  WorldModel model = on_plane({0.2, 0.0, 1e4, 1e4}, {box({0.1, 0.1, 0.1}, 0.1, {0.0, 0.0, 0.0505})});
  model.gravity.setZero();
  model.finalize();
  Simulation run(model);
  set_twist(model, run.state, BodyId{1}, {{0.0, 0.0, -1.0}, Vector3::Zero()});
  for (int i = 0; i < 100; ++i) {
    (void)run.step();
    ASSERT_LT(run.body(1).velocity.z(), 0.05);
  }
}

TEST(CompliantContact, ReboundsAsASpringWithADamperDoesWhereverInTheStepItTouches) {
  // What lands with v on a spring and a damper that do not pull leaves them with v exp(-tan(f) (pi - 2 f)), sin(f) the
  // damping ratio.
  struct Impact {
    double stiffness, damping, mass;
  };
  const Impact impacts[] = {{1e4, 50.0, 0.37}, {1.5e4, 50.0, 2.0}, {3e4, 30.0, 0.2}};
  for (const Impact& impact : impacts) {
    SCOPED_TRACE(impact.stiffness);
    const double f = std::asin(0.5 * impact.damping / std::sqrt(impact.stiffness * impact.mass));
    const double expected = std::exp(-std::tan(f) * (M_PI - 2.0 * f));
    for (const double dt : {1e-3, 5e-4, 2e-4}) {
      for (const double part : {0.05, 0.35, 0.65, 0.95}) {
        SCOPED_TRACE(part);
        WorldModel model = on_plane({0.2, 0.0, impact.stiffness, impact.damping}, {});
        model.bodies.push_back(box({0.1, 0.1, 0.1}, impact.mass, {0.0, 0.0, 0.05 + (5.0 + part) * dt}));
        model.settings.dt = dt;
        model.gravity.setZero();
        model.finalize();
        Simulation run(model);
        set_twist(model, run.state, BodyId{1}, {{0.0, 0.0, -1.0}, Vector3::Zero()});
        run.steps(5);
        ASSERT_NEAR(run.body(1).velocity.z(), -1.0, 1e-12);  // nothing is felt before it touches
        run.steps(static_cast<int>(0.05 / dt));
        // The step in which it leaves may lose what the spring still holds half a step from its end, k (v dt/2)^2 / 2,
        // which is (w dt)^2 / 8 of the speed; that in which it touches is as exact.
        const double per_step = dt * dt * impact.stiffness / impact.mass;
        EXPECT_NEAR(run.body(1).velocity.z(), expected, 0.125 * per_step);
      }
    }
  }
}

TEST(CompliantContact, ReboundsFromACornerByItsDampingRatioWhateverTheMassAndTheLever) {
  // One point without friction: its effective mass is that of body and lever, and the closed form above has the ratio.
  const double speed = 0.05;  // m/s: it hardly turns while it touches
  const Vector3 corner = Vector3::Constant(-0.05);
  for (const double ratio : {0.2, 0.5}) {
    const double f = std::asin(ratio), rebound = std::exp(-std::tan(f) * (M_PI - 2.0 * f));
    for (const double mass : {0.3, 3.0}) {
      for (const double turn : {0.0, 0.2, 0.4}) {
        SCOPED_TRACE(turn);
        ContactLaw law{0.0, 0.0, 1e5 * mass, 0.0};
        law.damping_ratio = ratio;
        BodyModel cube = box({0.1, 0.1, 0.1}, mass, Vector3::Zero());
        cube.X_WB.R = exp_rotation({turn, 0.0, 0.0}) *
                      Eigen::Quaterniond::FromTwoVectors(corner, -Vector3::UnitZ()).toRotationMatrix();
        const Vector3 lever = cube.X_WB.R * corner;
        cube.X_WB.p.z() = 2e-5 - lever.z();
        WorldModel model = on_plane(law, {cube});
        model.gravity.setZero();
        model.settings.dt = 2e-4;
        model.finalize();
        Simulation run(model);
        set_twist(model, run.state, BodyId{1}, {{0.0, 0.0, -speed}, Vector3::Zero()});
        run.steps(75);
        const double moment = mass * 0.01 / 6.0;
        const double effective = 1.0 / (1.0 / mass + lever.head<2>().squaredNorm() / moment);
        const double push = mass * (run.body(1).velocity.z() + speed);
        EXPECT_NEAR(push / (effective * speed) - 1.0, rebound, 0.01);  // it turns by 0.005 rad: 0.005 of the lever
      }
    }
  }
}

TEST(CompliantContact, IsAsStiffHoweverFastAnythingElseMoves) {
  // A box that lands on an edge, alone and with another that flies by far away.
  const ContactLaw law{0.2, 0.0, 1e4, 30.0};
  const auto end_with = [&law](double speed) {
    BodyModel tilted = box({0.1, 0.1, 0.1}, 0.5, {0.0, 0.0, 0.0});
    tilted.X_WB.R = exp_rotation({0.0, 0.03, 0.01});
    tilted.X_WB.p.z() = 0.0525;
    WorldModel model = on_plane(law, {tilted, box({0.1, 0.1, 0.1}, 0.5, {5.0, 0.0, 1.0})});
    Simulation run(model);
    set_twist(model, run.state, BodyId{2}, {{speed, 0.0, 0.0}, Vector3::Zero()});
    run.steps(60);
    return run.body(1).p_WBcm;
  };
  EXPECT_LT((end_with(0.0) - end_with(4.0)).norm(), 1e-7);  // what the solver leaves in 60 steps is 6e-9 m
}

/// Soft for 1 mm, then ten times as stiff.
ContactLaw stiffening() {
  ContactLaw law{0.2, 0.0, 2e4, 400.0};
  law.travel = 1e-3;
  law.stiffness_beyond = 2e5;
  return law;
}

TEST(CompliantContact, SinksByItsTravelAndThenOnTheStifferSlope) {
  for (const double dt : {5e-4, 1e-3, 2e-3}) {
    SCOPED_TRACE(dt);
    const double light = 1.0, heavy = 6.0;  // kg: within the travel, and beyond it
    WorldModel model = on_plane(
        stiffening(), {box({0.1, 0.1, 0.1}, light, {-1.0, 0.0, 0.05}), box({0.1, 0.1, 0.1}, heavy, {1.0, 0.0, 0.05})});
    model.settings.dt = dt;
    Simulation run(model);
    run.steps(static_cast<int>(1.0 / dt));
    EXPECT_NEAR(0.05 - run.body(1).p_WBcm.z(), light * 9.81 / 2e4, 1e-7);
    EXPECT_NEAR(0.05 - run.body(2).p_WBcm.z(), 1e-3 + (heavy * 9.81 - 2e4 * 1e-3) / 2e5, 1e-7);
  }
}

TEST(CompliantContact, AddsNoMoreEnergyWhereItStiffensThanASpringTakenForTheOther) {
  // Undamped and never off the floor: a step that begins on one slope and ends on the other takes the wrong one for at
  // most v dt, which is worth (k2 - k1) (v dt)^2 / 2 twice in a period.
  ContactLaw law = stiffening();
  law.damping = 0.0;
  const double mass = 4.0;
  const WorldModel model = on_plane(law, {box({0.1, 0.1, 0.1}, mass, {0.0, 0.0, 0.0495})});
  Simulation run(model);
  const auto energy = [&] {
    const double depth = 0.05 - run.body(1).p_WBcm.z(), more = std::max(0.0, depth - law.travel);
    const double less = std::min(depth, law.travel);
    return kinetic_energy(model, run.state) + potential_energy(model, run.state) + 0.5 * law.stiffness * less * less +
           law.stiffness * law.travel * more + 0.5 * law.stiffness_beyond * more * more;
  };
  const double start = energy();
  double bound = 1e-9, before = 5e-4;
  for (int i = 0; i < 2000; ++i) {
    (void)run.step();
    const double depth = 0.05 - run.body(1).p_WBcm.z(), way = depth - before;
    if ((depth > law.travel) != (before > law.travel))
      bound += 0.5 * (law.stiffness_beyond - law.stiffness) * way * way;
    before = depth;
    ASSERT_LE(std::abs(energy() - start), bound) << "step " << i;
  }
}

TEST(CompliantContact, EdgesCarryInProportionToWhatOfThemOverlaps) {
  // A plank of 300 x 100 mm across two ledges that carry 4 mm of it at either end; whole faces begin at 2000 mm^2.
  ContactLaw law{0.2, 0.0, 2e4, 40.0};
  law.full_area = 2e-3;
  law.edge_share = 0.05;
  for (const double width : {4e-3, 10e-3, 50e-3, 0.5e-3}) {
    SCOPED_TRACE(width);
    WorldModel model = world(law, law);
    model.bodies.push_back(fixed_box({0.2, 0.4, 0.1}, {-0.25 + width, 0.0, -0.05}));
    model.bodies.push_back(fixed_box({0.2, 0.4, 0.1}, {0.25 - width, 0.0, -0.05}));
    model.bodies.push_back(box({0.3, 0.1, 0.1}, 0.05, {0.0, 0.0, 0.05}));
    model.finalize();
    Simulation run(model);
    run.steps(2000);
    const double share = std::clamp(width * 0.1 / law.full_area, law.edge_share, 1.0);
    const double sink = 0.05 * 9.81 / (2.0 * share * law.stiffness);
    ASSERT_LT(sink, width);  // else the ends would be pressed apart, not down
    EXPECT_NEAR(0.05 - run.body(2).p_WBcm.z(), sink, 1e-3 * sink);
  }
}

TEST(CompliantContact, LetsABoxThatIsTooWideByLessThanItsTravelIntoASlotByItsOwnWeight) {
  // 0.4 mm too wide on either side, let go 0.1 mm above the rim. Edges that carry like faces keep it up.
  const auto depth_with = [](double full_area) {
    ContactLaw law{0.1, 0.0, 2e4, 40.0};
    law.full_area = full_area;
    WorldModel model = world(law, law);
    model.bodies.push_back(fixed_box({0.2, 0.4, 0.2}, {-0.1996, 0.0, -0.1}));
    model.bodies.push_back(fixed_box({0.2, 0.4, 0.2}, {0.1996, 0.0, -0.1}));
    model.bodies.push_back(box({0.2, 0.2, 0.1}, 1.0, {0.0, 0.0, 0.0501}));
    model.finalize();
    Simulation run(model);
    run.steps(500);
    return 0.05 - run.body(2).p_WBcm.z();
  };
  EXPECT_LT(depth_with(0.0), 1e-3);
  EXPECT_GT(depth_with(5e-3), 0.02);
}

}  // namespace
}  // namespace snug::physics
