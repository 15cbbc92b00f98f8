// Friction: spinning and sliding boxes against closed forms, and what a contact says about its own sliding.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene.hpp"

namespace snug::physics::test {
namespace {

constexpr double kGravity = 9.81;

struct Spin {
  Vector3 size;
  double mass, friction, speed;
  [[nodiscard]] double corner() const { return 0.5 * size.head<2>().norm(); }
  [[nodiscard]] double inertia() const { return mass * size.head<2>().squaredNorm() / 12.0; }
  /// All four points are equally far from the axis: however they share the weight N, the moment is mu N r.
  [[nodiscard]] double deceleration() const { return friction * mass * kGravity * corner() / inertia(); }
};

WorldModel world_of(const Spin& spin) {
  return on_plane({spin.friction, 0.0, 0.0, 0.0}, {box(spin.size, spin.mass, {0.0, 0.0, 0.5 * spin.size.z()})});
}

const Spin kSpins[] = {
    {{0.2, 0.2, 0.097}, 0.55, 0.2, 10.0}, {{0.3, 0.1, 0.05}, 1.7, 0.5, -15.0}, {{0.05, 0.05, 0.2}, 0.1, 0.05, 3.0}};

TEST(EdgeFriction, SlowsWhatSlidesOnAnEdgeOrACornerAndNotWhatLiesOnAFace) {
  const double half = 0.05, speed = 1.0;
  struct Slide {
    Vector3 rotation;  ///< rad
    double height, friction;
  };
  const Matrix3 on_corner = Eigen::Quaterniond::FromTwoVectors(Vector3(1.0, 1.0, 1.0), Vector3::UnitZ()).matrix();
  const Slide slides[] = {{Vector3::Zero(), half, 0.3},
                          {{0.25 * std::numbers::pi, 0.0, 0.0}, half * std::sqrt(2.0), 0.1},
                          {log_rotation(on_corner), half * std::sqrt(3.0), 0.1}};
  for (const double stiffness : {0.0, 2e4}) {
    SCOPED_TRACE(stiffness);
    for (const Slide& slide : slides) {
      SCOPED_TRACE(slide.height);
      ContactLaw law{0.3, 0.0, stiffness, 0.0};
      law.edge_friction = 0.1;
      BodyModel cube = box(Vector3::Constant(2.0 * half), 1.0, {0.0, 0.0, slide.height});
      if (stiffness > 0.0) cube.X_WB.p.z() -= kGravity / stiffness;  // in balance
      cube.X_WB.R = exp_rotation(slide.rotation);
      cube.inertia.inertia = 1e6 * Matrix3::Identity();  // does not tip
      const WorldModel model = on_plane(law, {cube});
      Simulation run(model);
      set_twist(model, run.state, BodyId{1}, {{speed, 0.0, 0.0}, Vector3::Zero()});
      run.steps(200);
      EXPECT_NEAR(run.body(1).velocity.x(), speed - slide.friction * kGravity * 200 * model.settings.dt,
                  200 * model.settings.tolerance);
    }
  }
}

TEST(TorsionalFriction, SlowsASpinningBoxAsItsFourCornersSay) {
  for (const Spin& spin : kSpins) {
    SCOPED_TRACE(spin.size.transpose());
    const WorldModel model = world_of(spin);
    Simulation run(model);
    run.steps(50);  // the weight is on the corners
    set_twist(model, run.state, BodyId{1}, Twist{Vector3::Zero(), Vector3(0.0, 0.0, spin.speed)});
    const double dt = model.settings.dt;
    const int stop = static_cast<int>(std::abs(spin.speed) / (spin.deceleration() * dt));
    for (int i = 1; i < stop; ++i) {
      (void)run.step();
      const double expected = spin.speed - std::copysign(spin.deceleration(), spin.speed) * i * dt;
      // The solver leaves `tolerance` of velocity at a corner in every step.
      ASSERT_NEAR(run.body(1).angular_velocity.z(), expected, i * model.settings.tolerance / spin.corner()) << i;
    }
    run.steps(2);  // the step in which it stops, and one to stick
    EXPECT_LT(std::abs(run.body(1).angular_velocity.z()), 2.0 * model.settings.tolerance / spin.corner());
    // It stays where it is: the centre was not driven by anything but what the solver leaves.
    EXPECT_LT(run.body(1).p_WBcm.head<2>().norm(), stop * dt * stop * model.settings.tolerance);
  }
}

TEST(TorsionalFriction, TurnsABoxByTheAngleOfTheClosedForm) {
  for (const Spin& spin : kSpins) {
    SCOPED_TRACE(spin.size.transpose());
    const WorldModel model = world_of(spin);
    Simulation run(model);
    run.steps(50);
    set_twist(model, run.state, BodyId{1}, Twist{Vector3::Zero(), Vector3(0.0, 0.0, spin.speed)});
    const double dt = model.settings.dt, time = std::abs(spin.speed) / spin.deceleration();
    double turned = 0.0;
    Matrix3 last = run.body(1).quat_WB.toRotationMatrix();
    for (int i = 0; i < static_cast<int>(time / dt) + 3; ++i) {
      (void)run.step();
      const Matrix3 now = run.body(1).quat_WB.toRotationMatrix();
      turned += log_rotation(now * last.transpose()).z();
      last = now;
    }
    // Mean velocity of a step is exact under constant deceleration but in the step that ends it, where the angle is
    // a part of w dt with w < a dt.
    EXPECT_NEAR(turned, 0.5 * spin.speed * std::abs(spin.speed) / spin.deceleration(),
                0.5 * spin.deceleration() * dt * dt + time * time / dt * model.settings.tolerance / spin.corner());
  }
}

TEST(TorsionalFriction, HoldsATorqueBelowItsLimitAndYieldsAboveIt) {
  const Spin spin = kSpins[0];
  const WorldModel model = world_of(spin);
  const double limit = spin.friction * spin.mass * kGravity * spin.corner();
  for (const double share : {0.99, 1.05}) {
    SCOPED_TRACE(share);
    Simulation run(model);
    run.steps(50);
    const ExternalWrench wrench{BodyId{1}, {Vector3::Zero(), Vector3(0.0, 0.0, share * limit)}};
    WorldInput input;
    input.wrenches = {&wrench, 1};
    for (int i = 0; i < 500; ++i) (void)run.step(input);
    const double expected = share < 1.0 ? 0.0 : (share - 1.0) * limit / spin.inertia() * 0.5;
    EXPECT_NEAR(run.body(1).angular_velocity.z(), expected, 500 * model.settings.tolerance / spin.corner());
  }
}

TEST(Friction, BesidesSpinningLetsASlidingBoxGoFarther) {
  // Turning corners turn part of the friction away from the path: both motions last longer than alone, and end
  // together.
  const Spin spin = kSpins[0];
  const WorldModel model = world_of(spin);
  Simulation run(model);
  run.steps(50);
  const Vector3 start = run.body(1).p_WBcm;
  set_twist(model, run.state, BodyId{1}, Twist{Vector3(1.0, 0.0, 0.0), Vector3(0.0, 0.0, 10.0)});
  int slides = 0, turns = 0;
  for (int i = 0; i < 1500; ++i) {
    (void)run.step();
    if (run.body(1).velocity.norm() > 1e-5) slides = i + 1;
    if (run.body(1).angular_velocity.norm() > 1e-4) turns = i + 1;
  }
  EXPECT_GT((run.body(1).p_WBcm - start).norm(), 1.0 / (2.0 * spin.friction * kGravity));
  EXPECT_GT(slides, 510);  // alone: 1 / (mu g) = 0.5097 s
  EXPECT_GT(turns, 241);   // alone: 10 / 41.6 s
  EXPECT_NEAR(slides, turns, 2);
}

TEST(Friction, OnASpinningKinematicDiscCarriesABoxInsideTheConeAndLosesItOutside) {
  // A box on a turntable at radius R needs w^2 R of centripetal acceleration: the cone gives mu g.
  for (const double share : {0.9, 1.1}) {
    SCOPED_TRACE(share);
    WorldModel model = world({0.3, 0.0, 0.0, 0.0}, {0.3, 0.0, 0.0, 0.0});
    BodyModel table = fixed_box({2.0, 2.0, 0.1}, {0.0, 0.0, -0.05});
    table.kind = BodyKind::Kinematic;
    const double radius = 0.5, speed = std::sqrt(share * 0.3 * kGravity / radius);
    model.bodies = {table, box({0.02, 0.02, 0.004}, 0.1, {radius, 0.0, 0.002})};
    model.finalize();
    Simulation run(model);
    set_twist(model, run.state, BodyId{1}, Twist{Vector3(0.0, speed * radius, 0.0), Vector3(0.0, 0.0, speed)});
    for (int i = 1; i <= 1000; ++i) {
      const KinematicTarget target{BodyId{0},
                                   {exp_rotation(Vector3(0.0, 0.0, i * 1e-3 * speed)), Vector3(0.0, 0.0, -0.05)}};
      WorldInput input;
      input.kinematic = {&target, 1};
      (void)run.step(input);
    }
    const double now = run.body(1).p_WBcm.head<2>().norm();
    if (share < 1.0) {
      // Arms are those at A (docs/theory/contact.md, 8): the mean velocity of a step is that of half a step ago and
      // not of half a step ahead, a chord that leads outward by (w dt)^2 R a step. No more than that may be lost.
      EXPECT_GE(now, radius - 1e-6);
      EXPECT_LE(now - radius, 1.01 * 1000 * speed * speed * 1e-6 * radius);
    } else {
      EXPECT_GT(now, 1.1 * radius);
    }
  }
}

std::vector<bool> slides_of(const Simulation& run) {
  std::vector<bool> slides;
  for (const ContactReport& contact : run.work.contacts()) slides.push_back(contact.slides);
  return slides;
}

TEST(ContactReport, SaysSlidesWhereABoxSlidesAndOnlyThere) {
  const WorldModel model = on_plane(
      {0.2, 0.0, 0.0, 0.0}, {box({0.2, 0.2, 0.1}, 0.5, {0.0, 0.0, 0.05}), box({0.2, 0.2, 0.1}, 0.5, {1.0, 0.0, 0.05})});
  Simulation run(model);
  run.steps(20);
  EXPECT_EQ(slides_of(run), std::vector<bool>(8, false));  // at rest
  set_twist(model, run.state, BodyId{2}, Twist{Vector3(0.0, 0.5, 0.0), Vector3::Zero()});
  run.steps(100);
  ASSERT_EQ(run.work.contacts().size(), 8U);
  for (const ContactReport& contact : run.work.contacts()) {
    EXPECT_EQ(contact.slides, contact.b == BodyId{2});
    const Vector3 normal = contact.n_AB_W * contact.n_AB_W.dot(contact.force_W);
    const Vector3 tangential = contact.force_W - normal;
    if (!contact.slides) {
      EXPECT_LE(tangential.norm(), 0.2 * normal.norm());
    } else {
      EXPECT_NEAR(tangential.norm(), 0.2 * normal.norm(), 1e-9 * normal.norm());  // on the edge of the disc
      EXPECT_LT(tangential.y(), 0.0);                                             // against the motion
      EXPECT_LT(std::abs(tangential.x()), 1e-6 * tangential.norm() + 1e-6);
    }
  }
  run.steps(300);  // stopped after 0.5 / (0.2 g) = 0.25 s
  EXPECT_EQ(slides_of(run), std::vector<bool>(8, false));
}

TEST(ContactReport, SaysSlidesForEveryCornerOfASpinningBox) {
  const WorldModel model = world_of(kSpins[0]);
  Simulation run(model);
  run.steps(20);
  set_twist(model, run.state, BodyId{1}, Twist{Vector3::Zero(), Vector3(0.0, 0.0, 5.0)});
  run.steps(20);
  EXPECT_EQ(slides_of(run), std::vector<bool>(4, true));
  for (const ContactReport& contact : run.work.contacts()) {
    const Vector3 arm = contact.p_WQ - run.body(1).p_WBcm;
    EXPECT_LT(arm.cross(contact.force_W).z(), 0.0);
  }
}

TEST(EdgeContact, SharpPlatesLeanOnEachOther) {
  // Two plates at 15 degrees on a floor of friction 0.4; where their sharp edges meet 0.128 is needed.
  const ContactLaw ridge{0.2, 0.0, 0.0, 0.0}, floor{0.4, 0.0, 0.0, 0.0};
  WorldModel model = world(ridge, floor);
  model.bodies = {fixed_box({4.0, 4.0, 0.1}, {0.0, 0.0, -0.05})};
  for (const double side : {1.0, -1.0}) {
    const Vector3 p_WB(-0.011871000897655446 * side, 0.0, 0.04263014587927026);
    model.bodies.push_back(box({0.001, 0.063, 0.088}, 0.0018, p_WB));
    model.bodies.back().X_WB.R = exp_rotation(Vector3(0.0, side * std::numbers::pi / 12.0, 0.0));
  }
  model.finalize();
  Simulation run(model);
  run.steps(1000);
  for (const int i : {1, 2}) EXPECT_NEAR(run.body(i).p_WBcm.z(), 0.04263, 1e-4);  // fallen: 0.0005
}

}  // namespace
}  // namespace snug::physics::test
