// Extremes: fast bodies and thin walls, heavy on light, empty worlds, many force elements, forced overlaps.
#include <gtest/gtest.h>

#include <cmath>

#include "scene.hpp"

namespace snug::physics::test {
namespace {

const Vector3 kCube(0.1, 0.1, 0.1);

TEST(Fast, BoxesDoNotPassThroughAThinWallAtAnyStepThatTheIssueNames) {
  for (const double dt : {1e-3, 4e-3, 20e-3}) {
    for (const double speed : {0.5, 2.0, 10.0, 40.0}) {
      for (const double start : {-0.3, -0.5, -0.523}) {
        SCOPED_TRACE(testing::Message() << "dt " << dt << ", speed " << speed << ", start " << start);
        WorldModel model = world({0.2, 0.0, 0.0, 0.0}, {0.2, 0.0, 0.0, 0.0});
        model.bodies = {fixed_box({0.005, 2.0, 2.0}, Vector3::Zero()), box(kCube, 0.5, {start, 0.0, 0.0})};
        model.gravity.setZero();
        model.settings.dt = dt;
        model.finalize();
        Simulation run(model);
        set_twist(model, run.state, BodyId{1}, Twist{Vector3(speed, 0.0, 0.0), Vector3::Zero()});
        run.steps(static_cast<int>(0.6 / (speed * dt)) + 5);
        // In the step that stops it, it goes on with half of its speed: up to v dt / 2 of gap is left.
        EXPECT_LE(run.body(1).p_WBcm.x(), -0.0525 + 2.0 * model.settings.position_slop);
        EXPECT_GE(run.body(1).p_WBcm.x(), -0.0525 - 0.5 * speed * dt - 2.0 * model.settings.position_slop);
        EXPECT_NEAR(run.body(1).velocity.x(), 0.0, model.settings.tolerance);
      }
    }
  }
}

TEST(Fast, BoxesThatMeetDoNotPassThroughEachOther) {
  for (const double dt : {1e-3, 4e-3, 20e-3}) {
    for (const double speed : {2.0, 20.0}) {
      SCOPED_TRACE(testing::Message() << "dt " << dt << ", speed " << speed);
      WorldModel model = world({0.2, 0.0, 0.0, 0.0}, {});
      model.bodies = {box(kCube, 0.5, {-0.5, 0.0, 0.0}), box(kCube, 0.5, {0.5, 0.0, 0.0})};
      model.gravity.setZero();
      model.settings.dt = dt;
      model.finalize();
      Simulation run(model);
      set_twist(model, run.state, BodyId{0}, Twist{Vector3(speed, 0.0, 0.0), Vector3::Zero()});
      set_twist(model, run.state, BodyId{1}, Twist{Vector3(-speed, 0.0, 0.0), Vector3::Zero()});
      run.steps(static_cast<int>(1.0 / (speed * dt)) + 5);
      const double gap = run.body(1).p_WBcm.x() - run.body(0).p_WBcm.x() - 0.1;
      EXPECT_GE(gap, -2.0 * model.settings.position_slop);
      EXPECT_LE(gap, speed * dt + 2.0 * model.settings.position_slop);          // as above, at twice the speed
      EXPECT_NEAR(run.body(1).p_WBcm.x() + run.body(0).p_WBcm.x(), 0.0, 1e-7);  // as symmetric as it was
    }
  }
}

TEST(Fast, BoxesThatFallByMoreThanTheirFatBoxInAStepAreStoppedAtTheGround) {
  for (int i = 0; i < 80; ++i) {  // every phase between steps and updates of the pairs
    SCOPED_TRACE(i);
    WorldModel model = on_plane({0.3, 0.0, 0.0, 0.0}, {box({0.1, 0.1, 0.1}, 0.5, {0.0, 0.0, 0.6 + 0.05 * i})});
    model.settings.dt = 5e-3;
    Simulation run(model);
    double worst = 0.0;
    for (int step = 0; step < 250; ++step) worst = std::max(worst, run.step().worst_penetration);
    EXPECT_LT(worst, 1e-9);
    // A landing leaves the gap that the last step would have fallen through.
    EXPECT_NEAR(run.body(1).p_WBcm.z(), 0.05, 0.5 * 9.81 * model.settings.dt * model.settings.dt + 1e-9);
  }
}

TEST(MassRatio, HeavyOnLightStandsWhereItWasPut) {
  for (const double ratio : {1e-4, 1e-2, 1e2, 1e4}) {
    SCOPED_TRACE(ratio);
    const WorldModel model =
        on_plane({0.3, 0.0, 0.0, 0.0}, {box(kCube, 0.1, {0.0, 0.0, 0.05}), box(kCube, 0.1 * ratio, {0.01, 0.0, 0.15})});
    Simulation run(model);
    for (int i = 0; i < 500; ++i) ASSERT_EQ(run.step().status, StepStatus::Converged) << i;
    Vector3 force = Vector3::Zero();
    for (const ContactReport& contact : run.work.contacts()) {
      if (contact.a == BodyId{0}) force += contact.force_W;
    }
    // A body of mass m rests to the solver's tolerance: m tolerance / dt of force.
    const double mass = 0.1 * (1.0 + ratio);
    EXPECT_NEAR(force.z() / (mass * 9.81), 1.0, 8.0 * model.settings.tolerance / (9.81 * model.settings.dt));
    EXPECT_NEAR(run.body(2).p_WBcm.z(), 0.15, 3.0 * model.settings.position_slop);
    EXPECT_LT(run.body(2).p_WBcm.head<2>().norm(), 0.01 + 500 * 1e-3 * 8.0 * model.settings.tolerance);
  }
}

TEST(EmptyWorld, Steps) {
  WorldModel model = world({}, {});
  model.finalize();
  Simulation nothing(model);
  EXPECT_EQ(nothing.step().status, StepStatus::Converged);
  EXPECT_EQ(nothing.state.step_index, 1);
  model.bodies = {fixed_box(kCube, Vector3::Zero())};
  model.finalize();
  Simulation fixed(model);
  EXPECT_EQ(fixed.step().status, StepStatus::Converged);
  BodyModel point = box(kCube, 1.0, {0.0, 0.0, 1.0});
  point.geoms.clear();  // falls through everything
  model.bodies.push_back(point);
  model.finalize();
  Simulation ghost(model);
  ghost.steps(1000);
  EXPECT_NEAR(ghost.body(1).p_WBcm.z(), 1.0 - 0.5 * 9.81, 1e-11);  // 1000 roundings of numbers of size 5
  set_present(ghost.state, BodyId{1}, false);
  EXPECT_EQ(ghost.step().awake, 0);
}

TEST(Absent, BodiesDoNotMoveTouchOrCount) {
  const WorldModel model = on_plane({0.2, 0.0, 0.0, 0.0}, {box(kCube, 0.5, {0.0, 0.0, 0.05}),
                                                           box(kCube, 0.5, {0.0, 0.0, 0.12}),  // overlaps the first
                                                           box(kCube, 0.5, {0.0, 0.0, 0.3})});
  Simulation run(model);
  set_present(run.state, BodyId{2}, false);
  const double energy = potential_energy(model, run.state);
  EXPECT_NEAR(energy, 0.5 * 9.81 * 0.35, 1e-12);  // two of the three; rounding
  const BodyState before = run.body(2);
  for (int i = 0; i < 300; ++i) {
    const StepReport report = run.step();
    ASSERT_EQ(report.awake, 2);
    ASSERT_LE(report.worst_penetration, 1e-6);
    for (const ContactReport& contact : run.work.contacts()) {
      ASSERT_NE(contact.a, BodyId{2});
      ASSERT_NE(contact.b, BodyId{2});
    }
  }
  EXPECT_TRUE(run.body(2) == before);
  EXPECT_NEAR(run.body(3).p_WBcm.z(), 0.15, 1e-6);  // landed on the first, through the absent one
}

TEST(ForcedOverlap, BetweenAWallAndAKinematicPusherDoesNotExplode) {
  // A press that closes to less than the box: no solution exists; nothing may become fast or not a number.
  WorldModel model = world({0.3, 0.0, 0.0, 0.0}, {0.3, 0.0, 0.0, 0.0});
  BodyModel press = fixed_box({0.5, 0.5, 0.05}, {0.0, 0.0, 0.1751});
  press.kind = BodyKind::Kinematic;
  model.bodies = {fixed_box({1.0, 1.0, 0.1}, {0.0, 0.0, -0.05}), press, box(kCube, 0.5, {0.0, 0.0, 0.05})};
  model.finalize();
  Simulation run(model);
  double fastest = 0.0;
  for (int i = 1; i <= 600; ++i) {
    const double z = 0.1751 - 1e-4 * std::min(i, 600);
    const KinematicTarget target{BodyId{1}, {Matrix3::Identity(), Vector3(0.0, 0.0, z)}};
    WorldInput input;
    input.kinematic = {&target, 1};
    const StepReport report = run.step(input);
    ASSERT_NE(report.status, StepStatus::NotFinite);
    ASSERT_NE(report.status, StepStatus::LostBody);
    if (i < 400) fastest = std::max(fastest, run.body(2).velocity.norm());
  }
  EXPECT_LT(fastest, 0.2);  // twice the press, until the overlap is nearly half of the box
}

struct CentringSpring final : ForceElement {
  [[nodiscard]] ElementResponse evaluate(const ElementQuery& query) const noexcept override {
    ElementResponse response;
    response.wrench.head<3>() = -200.0 * (query.p_WBcm - query.X_WE.p);
    response.stiffness.topLeftCorner<3, 3>() = 200.0 * Matrix3::Identity();
    return response;
  }
};

TEST(ForceElements, OfManyOnOneBodyAddUp) {
  const CentringSpring spring;
  WorldModel model = world({}, {});
  BodyModel carrier = fixed_box({0.01, 0.01, 0.01}, {0.0, 0.0, 1.0});
  carrier.kind = BodyKind::Kinematic;
  carrier.geoms.clear();  // it is inside of the box
  model.bodies = {carrier, box(kCube, 2.0, {0.0, 0.0, 1.0})};
  model.finalize();
  Simulation run(model);
  const std::vector<ElementUse> uses(20, {&spring, BodyId{0}, {}, BodyId{1}});
  WorldInput input;
  input.elements = uses;
  double lowest = 1.0;
  for (int i = 0; i < 400; ++i) {
    (void)run.step(input);
    lowest = std::min(lowest, run.body(1).p_WBcm.z());
  }
  // Swings to twice the depth of rest; seen at instants up to w dt / 2 from the lowest: 1 - cos.
  const double depth = 2.0 * 2.0 * 9.81 / (20.0 * 200.0), w_dt = std::sqrt(20.0 * 200.0 / 2.0) * 1e-3;
  EXPECT_NEAR((1.0 - lowest) / depth, 1.0, w_dt * w_dt);
}

}  // namespace
}  // namespace snug::physics::test
