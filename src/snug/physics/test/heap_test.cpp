// Heaps: large groups of boxes held to the laws by other code, what stands a hair's breadth apart, and memory.
#include <gtest/gtest.h>

#include "scene.hpp"
#include "second_opinion.hpp"
#include "snug/core/rng.hpp"
#include "snug/core/test/peak_memory.hpp"
#include "snug/physics/internal/contact_newton.hpp"

namespace snug::physics::test {
namespace {

/// `side` x `side` x `layers` boxes in a tote that they just fit into, dropped from a little above each other.
WorldModel heap(int side, int layers) {
  constexpr double kSpread = 0.16, kLayer = 0.15;  // m
  Rng rng = Rng(3).split("heap");
  WorldModel model = world({0.4, 0.0, 0.0, 0.0}, {0.4, 0.0, 0.0, 0.0});
  const double inner = 0.5 * side * kSpread, height = layers * kLayer + 0.5;
  model.bodies.push_back(fixed_box({2.0 * inner + 0.4, 2.0 * inner + 0.4, 0.1}, {0.0, 0.0, -0.05}));
  for (const double sign : {-1.0, 1.0}) {
    model.bodies.push_back(fixed_box({0.2, 2.0 * inner + 0.4, height}, {sign * (inner + 0.1), 0.0, 0.5 * height}));
    model.bodies.push_back(fixed_box({2.0 * inner, 0.2, height}, {0.0, sign * (inner + 0.1), 0.5 * height}));
  }
  for (int i = 0; i < side * side * layers; ++i) {
    const Vector3 size(rng.uniform(0.09, 0.14), rng.uniform(0.09, 0.14), rng.uniform(0.09, 0.14));
    const int place = i % (side * side);
    const double middle = 0.5 * (side - 1);
    BodyModel body = box(
        size, 300.0 * size.prod(),
        {(place / side - middle) * kSpread, (place % side - middle) * kSpread, 0.09 + kLayer * (i / (side * side))});
    const double x = rng.uniform(-0.2, 0.2), y = rng.uniform(-0.2, 0.2), z = rng.uniform(-0.2, 0.2);
    body.X_WB.R = exp_rotation(Vector3(x, y, z));
    model.bodies.push_back(body);
  }
  model.settings.dt = 2e-3;
  model.settings.tolerance = 1e-5;
  model.settings.contact_margin = 2e-3;
  model.finalize();
  return model;
}

TEST(Heap, IsSolvedToTheLawsInLargeGroups) {
  WorldModel model = heap(6, 5);
  model.settings.position_slop = 0.0;  // the other code does not know of contacts that are closed within it
  WorldState one = make_state(model), two = make_state(model);
  Workspace work_one(model), work_two(model, 2);
  int most = 0;
  for (int i = 0; i < 240; ++i) {
    const WorldState before = one;
    const StepReport report = step(model, {}, one, work_one);
    (void)step(model, {}, two, work_two);
    ASSERT_EQ(report.status, StepStatus::Converged) << i;
    ASSERT_TRUE(one == two) << i;
    if (i % 6 != 0) continue;
    const StepProblem problem(model, before, work_one.contacts());
    const auto impulses = problem.reported_impulses();
    const auto bears = [](const Vector3& impulse) { return impulse.norm() > 0.0; };
    most = std::max(most, static_cast<int>(std::count_if(impulses.begin(), impulses.end(), bears)));
    ASSERT_LE(problem.violation(impulses, problem.motion_from(impulses)), 1.01 * model.settings.tolerance) << i;
  }
  EXPECT_GE(most, 450) << "too few bear on each other for the method of large groups";
}

TEST(Heap, HasTheSameBytesByTwoThreadsThatSweepItsHalves) {
  const WorldModel model = heap(9, 6);
  WorldState one = make_state(model), two = make_state(model);
  Workspace work_one(model), work_two(model, 2);
  long most = 0;
  for (int i = 0; i < 240; ++i) {
    const StepReport report = step(model, {}, one, work_one);
    const StepReport same = step(model, {}, two, work_two);
    ASSERT_EQ(report.status, StepStatus::Converged) << i;
    ASSERT_EQ(report.residual, same.residual) << i;
    ASSERT_TRUE(one == two) << i;
    const auto contacts = work_one.contacts();
    most = std::max(most, std::count_if(contacts.begin(), contacts.end(),
                                        [](const auto& contact) { return contact.force_W.norm() > 0.0; }));
  }
  EXPECT_GE(most, internal::kSharedGroup) << "too few bear on each other for halves";
}

/// Bricks in running bond, `courses` of them, each a gap [m] above those that carry it.
WorldModel wall(int courses, int length, double gap) {
  std::vector<BodyModel> bricks;
  for (int course = 0; course < courses; ++course) {
    const double z = 0.05 + course * (0.1 + gap), offset = course % 2 == 0 ? 0.0 : 0.1;
    for (int i = 0; i < length; ++i) bricks.push_back(box({0.198, 0.1, 0.1}, 1.0, {0.2 * i + offset, 0.0, z}));
  }
  WorldModel model = on_plane({0.5, 0.0, 0.0, 0.0}, bricks);
  model.settings.position_slop = 1e-6;
  return model;
}

/// Mean gap between courses after some steps, m.
double mean_gap(const WorldModel& model, int courses) {
  Simulation run(model);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(run.step().status, StepStatus::Converged);
  const double top = run.state.bodies.back().p_WBcm.z(), bottom = run.state.bodies[1].p_WBcm.z();
  return (top - bottom) / (courses - 1) - 0.1;
}

TEST(Heap, HoldsWhatStandsWithinTheSlopWhereItStands) {
  // Rows of contacts: 10 courses of 10 bricks bear on each other at 8 points each, more than a heap's 512.
  EXPECT_NEAR(mean_gap(wall(10, 10, 5e-7), 10), 5e-7, 1e-7);
  EXPECT_NEAR(mean_gap(wall(10, 10, 1e-5), 10), 0.0, 1.1e-6) << "a gap beyond the slop closes";
  EXPECT_LT(mean_gap(wall(3, 3, 5e-7), 3), 1e-7) << "no heap: closes";
}

TEST(Heap, TakesLittleMemoryAtTheStart) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers keep notes of memory that nobody has touched";
#endif
  const WorldModel model = heap(20, 5);
  const auto peak = snug::test::peak_memory([&] {
    WorldState state = make_state(model);
    Workspace work(model);
    (void)step(model, {}, state, work);
  });
  ASSERT_TRUE(peak);
  EXPECT_LE(*peak / model.bodies.size(), 5'000U);
}

TEST(Heap, TakesLittleMemoryWhileItComesToRest) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers keep notes of memory that nobody has touched";
#endif
  const WorldModel model = heap(8, 6);
  const auto peak = snug::test::peak_memory([&] {
    WorldState state = make_state(model);
    Workspace work(model);
    for (int i = 0; i < 150; ++i) (void)step(model, {}, state, work);
  });
  ASSERT_TRUE(peak);
  EXPECT_LE(*peak / model.bodies.size(), 14'000U);
}

}  // namespace
}  // namespace snug::physics::test
