// Compliant contacts: decay, frequency and equilibrium of the spring and damper that the law describes.
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace snug::physics
