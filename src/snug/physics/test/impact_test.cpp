// Impact: restitution and its threshold, and what a collision of two free bodies must keep.
#include <gtest/gtest.h>

#include <cmath>

#include "scene.hpp"
#include "second_opinion.hpp"
#include "snug/core/rng.hpp"

namespace snug::physics::test {
namespace {

/// Speed after a flat box hit the plane with this speed, without gravity, from a gap it closes within the step.
double rebound(double speed, const ContactLaw& law, double gap_share, double sideways = 0.0) {
  WorldModel model = on_plane(law, {box(kBox, 0.5, {0.0, 0.0, 0.05 + gap_share * speed * 1e-3})});
  model.gravity.setZero();
  Simulation run(model);
  set_twist(model, run.state, BodyId{1}, Twist{Vector3(sideways, 0.0, -speed), Vector3::Zero()});
  (void)run.step();
  return run.body(1).velocity.z();
}

TEST(Restitution, OfZeroStopsABoxAtAnySpeed) {
  for (const double speed : {1e-4, 0.01, 0.049, 0.051, 1.0, 5.0, 30.0}) {
    for (const double gap : {0.0, 0.3, 0.9}) {
      EXPECT_NEAR(rebound(speed, {0.2, 0.0, 0.0, 0.0}, gap), 0.0, 1e-7) << speed;  // the solver's tolerance
    }
  }
}

TEST(Restitution, CountsAboveTheThresholdSpeedAndNotBelowIt) {
  const double threshold = StepSettings{}.restitution_threshold;
  for (const double e : {0.1, 0.5, 1.0}) {
    for (const double gap : {0.0, 0.5, 0.99}) {
      SCOPED_TRACE(testing::Message() << "e " << e << ", gap " << gap);
      EXPECT_NEAR(rebound(threshold * (1.0 - 1e-9), {0.2, e, 0.0, 0.0}, gap), 0.0, 1e-7);  // the solver's tolerance
      const double above = threshold * (1.0 + 1e-9);
      EXPECT_NEAR(rebound(above, {0.2, e, 0.0, 0.0}, gap), e * above, 1e-7);
      EXPECT_NEAR(rebound(2.0, {0.2, e, 0.0, 0.0}, gap), 2.0 * e, 1e-7);
    }
  }
}

TEST(Restitution, JudgesTheNormalSpeedAlone) {
  // Friction 0.1: an impulse of m (1 + e) v lies within what 5 m/s of sliding can use up.
  EXPECT_NEAR(rebound(0.049, {0.1, 0.8, 0.0, 0.0}, 0.5, 5.0), 0.0, 1e-7);
  EXPECT_NEAR(rebound(0.049, {0.0, 0.8, 0.0, 0.0}, 0.5, 5.0), 0.0, 1e-7);
  EXPECT_NEAR(rebound(0.3, {0.0, 0.8, 0.0, 0.0}, 0.5, 5.0), 0.24, 1e-7);
}

TEST(Restitution, OfZeroDoesNotRaiseABoxAfterALanding) {
  const WorldModel model = on_plane({0.2, 0.0, 0.0, 0.0}, {box(kBox, 0.5, {0.0, 0.0, 0.35})});
  Simulation run(model);
  bool has_landed = false;
  double highest = 0.0;
  for (int i = 0; i < 600; ++i) {
    (void)run.step();
    has_landed = has_landed || run.body(1).velocity.z() > -1e-3;
    if (has_landed && i > 10) highest = std::max(highest, run.body(1).p_WBcm.z() - 0.05);
  }
  EXPECT_TRUE(has_landed);
  EXPECT_LE(highest, model.settings.position_slop);
}

TEST(Restitution, BouncesLoseTheirHeightByTheSquare) {
  WorldModel model = on_plane({0.2, 0.7, 0.0, 0.0}, {box(kBox, 0.5, {0.0, 0.0, 0.55})});
  Simulation run(model);
  std::vector<double> apexes;
  double before = 0.0;
  for (int i = 0; i < 3000 && apexes.size() < 4; ++i) {
    (void)run.step();
    const double now = run.body(1).velocity.z();
    if (before > 0.0 && now <= 0.0) apexes.push_back(run.body(1).p_WBcm.z() - 0.05);
    before = now;
  }
  ASSERT_EQ(apexes.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    // At an instant up to dt from the apex: 0.5 g dt^2 lower. Each impact is exact in time and height.
    EXPECT_NEAR(apexes[i], 0.5 * std::pow(0.49, static_cast<double>(i + 1)), 0.5 * 9.81 * 1e-6 + 1e-6) << i;
  }
}

/// Two free bodies on their way to each other, turning, one or two steps before they touch.
WorldModel collision(Rng& rng, double restitution, bool cubes) {
  WorldModel model = world({rng.uniform(0.0, 1.0), restitution, 0.0, 0.0}, {});
  const auto size = [&] {
    const double edge = rng.uniform(0.05, 0.3);
    return cubes ? Vector3::Constant(edge).eval() : Vector3(edge, rng.uniform(0.05, 0.3), rng.uniform(0.05, 0.3));
  };
  for (const double side : {-1.0, 1.0}) {
    BodyModel body = box(size(), rng.uniform(0.1, 3.0), {side * 0.35, rng.uniform(-0.03, 0.03), 0.02 * side});
    body.X_WB.R = exp_rotation(Vector3(rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0), rng.uniform(-2.0, 2.0)));
    model.bodies.push_back(body);
  }
  model.gravity.setZero();
  model.finalize();
  return model;
}

void set_off(Rng& rng, const WorldModel& model, WorldState& state) {
  for (int i = 0; i < 2; ++i) {
    const auto turn = [&rng] { return rng.uniform(-3.0, 3.0); };
    const Vector3 w(turn(), turn(), turn());
    set_twist(model, state, BodyId{i}, Twist{Vector3(i == 0 ? 1.5 : -1.0, 0.0, rng.uniform(-0.2, 0.2)), w});
  }
}

Vector3 momentum(const WorldModel& model, const WorldState& state) {
  Vector3 sum = Vector3::Zero();
  for (std::size_t i = 0; i < state.bodies.size(); ++i) sum += model.bodies[i].inertia.mass * state.bodies[i].velocity;
  return sum;
}

/// About the origin of W.
Vector3 angular_momentum(const WorldModel& model, const WorldState& state) {
  Vector3 sum = Vector3::Zero();
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    const BodyState& body = state.bodies[i];
    const Matrix3 R = body.quat_WB.toRotationMatrix();
    sum += body.p_WBcm.cross(model.bodies[i].inertia.mass * body.velocity) +
           R * model.bodies[i].inertia.inertia * R.transpose() * body.angular_velocity;
  }
  return sum;
}

TEST(Collision, KeepsLinearMomentumToRounding) {
  Rng rng = Rng(11).split("linear");
  int hits = 0;
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    const WorldModel model = collision(rng, 0.5 * (i % 3), false);
    Simulation run(model);
    set_off(rng, model, run.state);
    const Vector3 before = momentum(model, run.state);
    for (int k = 0; k < 400; ++k) {
      (void)run.step();
      if (run.work.contacts().size() > 0 && run.work.contacts()[0].force_W.norm() > 0.0) ++hits;
      ASSERT_LE((momentum(model, run.state) - before).norm(), 400 * 1e-15);  // 400 roundings of about 3 kg m/s
    }
  }
  EXPECT_GT(hits, 60);
}

TEST(Collision, ReportsForcesThatAreTheChangeOfMomentumOfEitherBody) {
  Rng rng = Rng(12).split("third law");
  double largest = 0.0;
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    const WorldModel model = collision(rng, 0.0, false);
    Simulation run(model);
    set_off(rng, model, run.state);
    for (int k = 0; k < 300; ++k) {
      const WorldState before = run.state;
      const StepReport report = run.step();
      ASSERT_EQ(report.status, StepStatus::Converged);
      Vector3 on_b = Vector3::Zero();
      for (const ContactReport& contact : run.work.contacts()) on_b += contact.force_W;
      const auto change = [&](std::size_t b) -> Vector3 {
        return model.bodies[b].inertia.mass * (run.state.bodies[b].velocity - before.bodies[b].velocity) / 1e-3;
      };
      // Differences of velocities near 2 m/s, a few roundings each, over dt.
      ASSERT_LE((change(1) - on_b).norm(), 1e-11 + 1e-13 * on_b.norm());
      ASSERT_LE((change(0) + on_b).norm(), 1e-11 + 1e-13 * on_b.norm());
      largest = std::max(largest, on_b.norm());
      const StepProblem problem(model, before, run.work.contacts());
      const auto motion = problem.motion_from(problem.reported_impulses());
      for (std::size_t b = 0; b < 2; ++b) {  // and their moments the change of the turning
        ASSERT_LE((motion[b].w - run.state.bodies[b].angular_velocity).norm(), 1e-11);
      }
      ASSERT_LE(problem.violation(problem.reported_impulses(), motion), 2.0 * model.settings.tolerance);
    }
  }
  EXPECT_GT(largest, 100.0);  // there were collisions
}

/// Largest change of angular momentum of cubes that collide, over the bound 2 dt |P| |v| of one step.
double worst_share(double dt) {
  Rng rng = Rng(13).split("angular");
  double worst = 0.0;
  for (int i = 0; i < 40; ++i) {
    WorldModel model = collision(rng, 0.5 * (i % 3), true);
    model.settings.dt = dt;
    Simulation run(model);
    set_off(rng, model, run.state);
    Vector3 last = angular_momentum(model, run.state);
    for (int k = 0; k < static_cast<int>(0.4 / dt); ++k) {
      (void)run.step();
      double impulse = 0.0;
      for (const ContactReport& contact : run.work.contacts()) impulse += contact.force_W.norm() * dt;
      const Vector3 now = angular_momentum(model, run.state);
      const double change = (now - last).norm();
      last = now;
      // Arms are those at A, the impulse acts while the bodies move by at most v dt: |P| v dt, and as much again for
      // the overshoot that is undone. Bodies with 3 m/s at their corners and 2.5 m/s between their centres.
      worst = std::max(worst, change / (2.0 * impulse * 4.0 * dt + 1e-13));
    }
  }
  return worst;
}

TEST(Collision, KeepsAngularMomentumToWhatArmsAtTheStartOfTheStepCost) {
  EXPECT_LE(worst_share(1e-3), 1.0);
  EXPECT_LE(worst_share(2.5e-4), 1.0);  // proportional to dt: the bound shrinks with it
}

TEST(Collision, OfEqualCubesHeadOnExchangesTheirVelocities) {
  for (const double e : {0.0, 0.5, 1.0}) {
    SCOPED_TRACE(e);
    WorldModel model = world({0.3, e, 0.0, 0.0}, {});
    const Vector3 size = Vector3::Constant(0.1);
    model.bodies = {box(size, 1.0, {-0.0503, 0.0, 0.0}), box(size, 1.0, {0.0503, 0.0, 0.0})};
    model.gravity.setZero();
    model.finalize();
    Simulation run(model);
    set_twist(model, run.state, BodyId{0}, Twist{Vector3(1.0, 0.0, 0.0), Vector3::Zero()});
    run.steps(3);
    EXPECT_NEAR(run.body(0).velocity.x(), 0.5 * (1.0 - e), 1e-7);  // the solver's tolerance
    EXPECT_NEAR(run.body(1).velocity.x(), 0.5 * (1.0 + e), 1e-7);
    EXPECT_LT(run.body(0).angular_velocity.norm() + run.body(1).angular_velocity.norm(), 1e-6);
  }
}

}  // namespace
}  // namespace snug::physics::test
