// Tests of the step: closed forms, conservation, resting contact, sleep, snapshots, and what goes wrong.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <numbers>

#include "scene.hpp"
#include "snug/core/rng.hpp"

namespace {
std::atomic<bool> is_forbidden{false};
std::atomic<int> allocations{0};
}  // namespace

[[gnu::noinline]] void* operator new(std::size_t size) {
  if (is_forbidden) ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace snug::physics::test {
namespace {

const Vector3 kB1(0.2, 0.2, 0.097);

TEST(FreeFlight, FollowsTheParabolaToRounding) {
  const WorldModel model = on_plane({}, {box(kB1, 0.55, {0.0, 0.0, 5.0})});
  Simulation run(model);
  set_twist(model, run.state, BodyId{1}, Twist{Vector3(1.0, -2.0, 3.0), Vector3::Zero()});
  run.steps(500);
  const Vector3 expected(0.5, -1.0, 5.0 + 1.5 - 0.5 * 9.81 * 0.25);
  EXPECT_LT((run.body(1).p_WBcm - expected).norm(), 1e-12);  // 500 roundings of numbers of size 5
}

double attitude_error_after_one_second(double dt) {
  WorldModel model = on_plane({}, {box({0.1, 0.2, 0.3}, 1.0, {0.0, 0.0, 100.0})});
  const auto rotate = [&](double step) {
    model.settings.dt = step;
    Simulation run(model);
    set_twist(model, run.state, BodyId{1}, Twist{Vector3::Zero(), Vector3(0.3, 4.0, 0.2)});
    run.steps(static_cast<int>(std::lround(1.0 / step)));
    return run.body(1).quat_WB.toRotationMatrix();
  };
  return angle_between(rotate(dt), rotate(1e-4));
}

TEST(FreeFlight, TurnsAnAsymmetricBodyWithSecondOrder) {
  const double coarse = attitude_error_after_one_second(8e-3), fine = attitude_error_after_one_second(4e-3);
  EXPECT_NEAR(coarse / fine, 4.0, 0.5);  // the next order of the error is dt^2 smaller
}

TEST(FreeFlight, KeepsTheEnergyOfATumblingBody) {
  WorldModel model = on_plane({}, {box({0.1, 0.2, 0.3}, 1.0, {0.0, 0.0, 100.0})});
  model.gravity.setZero();
  Simulation run(model);
  set_twist(model, run.state, BodyId{1}, Twist{Vector3::Zero(), Vector3(0.3, 4.0, 0.2)});
  const double before = kinetic_energy(model, run.state);
  run.steps(5000);
  // Exact in body axes; the turn back to W leaves the second-order difference of two rotations.
  EXPECT_NEAR(kinetic_energy(model, run.state) / before, 1.0, 1e-4);
}

/// Kinetic energy over that of the start, least and most of 2000 steps without gravity.
std::pair<double, double> energies_of_a_tumble(const Vector3& size, double dt, double rate) {
  WorldModel model = on_plane({}, {box(size, 1.0, {0.0, 0.0, 100.0})});
  model.gravity.setZero();
  model.settings.dt = dt;
  Simulation run(model);
  set_twist(model, run.state, BodyId{1}, Twist{Vector3::Zero(), rate * Vector3(0.5, 0.7, 0.51)});
  const double before = kinetic_energy(model, run.state);
  std::pair<double, double> worst(1.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    EXPECT_EQ(run.step().status, StepStatus::Converged);
    const double now = kinetic_energy(model, run.state) / before;
    worst = {std::min(worst.first, now), std::max(worst.second, now)};
  }
  return worst;
}

TEST(FreeFlight, KeepsTheEnergyOfABodyThatTurnsByATenthOfARadianToARadianInAStep) {
  for (const Vector3& size : {Vector3(0.1, 0.2, 0.3), Vector3(0.16, 0.03, 0.05)}) {
    for (const auto& [dt, rate] : {std::pair(1e-3, 200.0), std::pair(1e-3, 900.0), std::pair(5e-3, 50.0)}) {
      SCOPED_TRACE(dt * rate);
      const auto [least, most] = energies_of_a_tumble(size, dt, rate);
      EXPECT_GT(least, 1.0 - 1e-5);  // 2000 steps, each to 1e-9 of the angular velocity
      EXPECT_LT(most, 1.0 + 1e-5);
    }
  }
}

TEST(FreeFlight, StaysFiniteWhereABodyTurnsRoundMoreThanOnceInAStep) {
  for (const double rate : {2e3, 1e4}) {
    SCOPED_TRACE(rate);
    const auto [least, most] = energies_of_a_tumble({0.16, 0.03, 0.05}, 5e-3, rate);
    EXPECT_GT(least, 0.1);  // of the inertia of the axes: 1.2e-4 to 2.3e-3 kg m^2 at 1 kg
    EXPECT_LT(most, 10.0);
  }
}

TEST(Friction, StopsASlidingBoxWhereCoulombSaysInEveryDirection) {
  for (const double degrees : {0.0, 22.5, 45.0, 77.0}) {
    SCOPED_TRACE(degrees);
    const WorldModel model = on_plane({0.2, 0.0, 0.0, 0.0}, {box(kB1, 0.55, {0.0, 0.0, 0.0485})});
    Simulation run(model);
    run.steps(500);
    const Vector3 start = run.body(1).p_WBcm;
    const double angle = degrees * std::numbers::pi / 180.0;
    set_twist(model, run.state, BodyId{1}, Twist{Vector3(std::cos(angle), std::sin(angle), 0.0), Vector3::Zero()});
    run.steps(1000);
    const Vector3 way = run.body(1).p_WBcm - start;
    const double expected = 1.0 / (2.0 * 0.2 * 9.81);
    EXPECT_NEAR(way.head<2>().norm() / expected, 1.0, 5e-4);  // the target for S3
    EXPECT_NEAR(std::atan2(way.y(), way.x()), angle, 0.01 * std::numbers::pi / 180.0);
  }
}

TEST(Friction, HoldsBelowTheConeAndSlidesAboveIt) {
  for (const bool slides : {false, true}) {
    WorldModel model = on_plane({0.2, 0.0, 0.0, 0.0}, {box(kB1, 0.55, {0.0, 0.0, 0.0485})});
    const double slope = std::atan(slides ? 0.3 : 0.1);
    model.gravity = 9.81 * Vector3(std::sin(slope), 0.0, -std::cos(slope));
    Simulation run(model);
    run.steps(500);
    const Vector3 start = run.body(1).p_WBcm;
    const double speed = run.body(1).velocity.x();
    run.steps(1000);
    const double way = run.body(1).p_WBcm.x() - start.x();
    const double acceleration = slides ? 9.81 * (std::sin(slope) - 0.2 * std::cos(slope)) : 0.0;
    EXPECT_NEAR(way, speed + 0.5 * acceleration, slides ? 1e-5 : 1e-9);
  }
}

TEST(Bounce, ReachesTheHeightThatNewtonSays) {
  const WorldModel model = on_plane({0.2, 0.5, 0.0, 0.0}, {box(kB1, 0.55, {0.0, 0.0, 0.5485})});
  Simulation run(model);
  double apex = 0.0;
  bool has_hit = false;
  for (int i = 0; i < 700; ++i) {
    (void)run.step();
    has_hit = has_hit || run.body(1).velocity.z() > 0.0;
    if (has_hit) apex = std::max(apex, run.body(1).p_WBcm.z() - 0.0485);
  }
  EXPECT_NEAR(apex / 0.125, 1.0, 1e-4);
}

TEST(Stack, RestsWithoutDriftAndCarriesItsWeight) {
  const WorldModel model =
      on_plane({0.2, 0.05, 0.0, 0.0}, {box(kB1, 0.55, {0.0, 0.0, 0.0485}), box(kB1, 0.55, {0.02, 0.01, 0.1455}),
                                       box(kB1, 0.55, {-0.01, 0.02, 0.2425})});
  Simulation run(model);
  run.steps(1000);
  const Vector3 before = run.body(3).p_WBcm;
  StepReport report;
  for (int i = 0; i < 2000; ++i) report = run.step();
  EXPECT_LT((run.body(3).p_WBcm - before).norm(), 1e-9);
  EXPECT_LT(report.worst_penetration, 1e-5);
  Vector3 force = Vector3::Zero();
  for (const ContactReport& contact : run.work.contacts()) {
    if (contact.a == BodyId{0}) force += contact.force_W;
  }
  EXPECT_NEAR(force.z(), 3.0 * 0.55 * 9.81, 1e-4);
  EXPECT_LT(force.head<2>().norm(), 1e-4);
}

TEST(CompliantContact, SinksByWeightOverStiffness) {
  const WorldModel model = on_plane({0.2, 0.0, 2.0e4, 100.0}, {box(kB1, 0.55, {0.0, 0.0, 0.0485})});
  Simulation run(model);
  run.steps(4000);
  EXPECT_NEAR(0.0485 - run.body(1).p_WBcm.z(), 0.55 * 9.81 / 2.0e4, 1e-8);
}

TEST(PositionCorrection, SeparatesOverlappingBoxesWithoutThrowingThem) {
  const WorldModel model = on_plane({0.2, 0.0, 0.0, 0.0}, {box(kB1, 0.55, {0.0, 0.0, 0.0475})});
  Simulation run(model);
  double fastest = 0.0;
  for (int i = 0; i < 200; ++i) {
    (void)run.step();
    fastest = std::max(fastest, run.body(1).velocity.norm());
  }
  EXPECT_NEAR(run.body(1).p_WBcm.z(), 0.0485, 1e-6);
  EXPECT_LT(fastest, 1e-6);
}

std::vector<BodyModel> random_boxes(Rng& rng, int count) {
  std::vector<BodyModel> boxes;
  for (int i = 0; i < count; ++i) {
    BodyModel body = box({0.105, 0.12, 0.108}, 0.26, {rng.uniform(-0.2, 0.2), rng.uniform(-0.1, 0.1), 0.1 + 0.16 * i});
    body.X_WB.R = exp_rotation(Vector3(rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), rng.uniform(-3.0, 3.0)));
    boxes.push_back(body);
  }
  return boxes;
}

TEST(RandomDrops, StayInTheContainerAndLoseEnergy) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    Rng rng(seed);
    const WorldModel model = in_container(random_boxes(rng, 6));
    Simulation run(model);
    const double start = kinetic_energy(model, run.state) + potential_energy(model, run.state);
    for (int i = 0; i < 3000; ++i) {
      const StepReport report = run.step();
      ASSERT_NE(report.status, StepStatus::NotFinite);
      ASSERT_LT(report.worst_penetration, 2e-3);
      // Rest is reached by losing energy; pushing an overlap out may lift a box by that much.
      ASSERT_LT(kinetic_energy(model, run.state) + potential_energy(model, run.state), start + 6 * 0.26 * 9.81 * 2e-3);
    }
    for (std::size_t i = 5; i < model.bodies.size(); ++i) {
      const Vector3& p = run.state.bodies[i].p_WBcm;
      EXPECT_LT(std::abs(p.x()), 0.285);
      EXPECT_LT(std::abs(p.y()), 0.185);
      EXPECT_GT(p.z(), 0.0);
      EXPECT_LT(run.state.bodies[i].velocity.norm(), 0.05);
    }
  }
}

TEST(Step, DoesNotAllocate) {
  Rng rng(3);
  const WorldModel model = in_container(random_boxes(rng, 8));
  Simulation run(model);
  allocations = 0;
  is_forbidden = true;
  run.steps(1500);
  is_forbidden = false;
  EXPECT_EQ(allocations, 0);
}

TEST(Snapshot, ContinuesWithTheSameBytes) {
  Rng rng(5);
  const WorldModel model = in_container(random_boxes(rng, 6));
  Simulation run(model);
  run.steps(600);
  Simulation copy(model);
  copy.state = run.state;
  for (int i = 0; i < 500; ++i) {
    (void)run.step();
    (void)copy.step();
  }
  EXPECT_TRUE(run.state == copy.state);
  EXPECT_EQ(hash_of(run.state), hash_of(copy.state));
  copy.body(6).velocity.x() = std::nextafter(copy.body(6).velocity.x(), 1.0);
  EXPECT_NE(hash_of(run.state), hash_of(copy.state));
}

WorldModel sleeping_pair() {
  WorldModel model = on_plane(
      {0.2, 0.05, 0.0, 0.0},
      {box(kB1, 0.55, {0.0, 0.0, 0.0485}), box(kB1, 0.55, {0.0, 0.0, 0.1455}), box(kB1, 0.55, {0.01, 0.0, 1.0})});
  model.settings.sleep.enabled = true;
  return model;
}

TEST(Sleep, ComesToRestingStacksAndEndsWhenSomethingLands) {
  const WorldModel model = sleeping_pair();
  Simulation run(model);
  set_present(run.state, BodyId{3}, false);
  run.steps(600);
  EXPECT_GE(run.body(1).sleep_group, 0);
  EXPECT_EQ(run.body(1).sleep_group, run.body(2).sleep_group);
  EXPECT_EQ(run.step().awake, 0);
  set_present(run.state, BodyId{3}, true);
  bool has_woken = false;
  for (int i = 0; i < 600 && !has_woken; ++i) has_woken = run.step().awake == 3;
  EXPECT_TRUE(has_woken);
}

TEST(Sleep, ChangesTheResultByLessThanAMicrometre) {
  WorldModel awake = sleeping_pair();
  awake.settings.sleep.enabled = false;
  const WorldModel asleep = sleeping_pair();
  Simulation a(awake), b(asleep);
  a.steps(3000);
  b.steps(3000);
  for (int i = 1; i <= 3; ++i) EXPECT_LT((a.body(i).p_WBcm - b.body(i).p_WBcm).norm(), 1e-6) << i;
}

TEST(Sleep, EndsWhenANeighbourIsTakenAway) {
  const WorldModel model = sleeping_pair();
  Simulation run(model);
  set_present(run.state, BodyId{3}, false);
  run.steps(600);
  set_present(run.state, BodyId{1}, false);
  run.steps(300);
  EXPECT_NEAR(run.body(2).p_WBcm.z(), 0.0485, 1e-4);
}

TEST(Step, NamesTheBodyThatIsNotANumberOrLost) {
  const WorldModel model = on_plane({}, {box(kB1, 0.55, {0.0, 0.0, 1.0}), box(kB1, 0.55, {1.0, 0.0, 1.0})});
  Simulation run(model);
  run.body(2).velocity.x() = std::numeric_limits<double>::quiet_NaN();
  StepReport report = run.step();
  EXPECT_EQ(report.status, StepStatus::NotFinite);
  EXPECT_EQ(report.culprit, BodyId{2});
  Simulation thrown(model);
  set_twist(model, thrown.state, BodyId{1}, Twist{Vector3(0.0, 2e6, 0.0), Vector3::Zero()});
  report = thrown.step();
  EXPECT_EQ(report.status, StepStatus::LostBody);
  EXPECT_EQ(report.culprit, BodyId{1});
}

TEST(Solver, SaysWhenItStoppedEarly) {
  Rng rng(9);
  WorldModel model = in_container(random_boxes(rng, 8));
  model.settings.max_sweeps = 1;
  Simulation run(model);
  bool has_said_so = false;
  for (int i = 0; i < 1500; ++i) {
    const StepReport report = run.step();
    if (report.status == StepStatus::NotConverged) has_said_so = true;
    if (report.status == StepStatus::Converged) {
      ASSERT_LE(report.residual, model.settings.tolerance);
    }
  }
  EXPECT_TRUE(has_said_so);
}

}  // namespace
}  // namespace snug::physics::test
