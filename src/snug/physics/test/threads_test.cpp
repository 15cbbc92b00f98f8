// Threads: a world stepped on several has the same bytes as on one.
#include <gtest/gtest.h>

#include "scene.hpp"
#include "snug/core/rng.hpp"

namespace snug::physics {
namespace {

using namespace test;

/// Boxes that fall onto a plane in heaps beside each other: islands of every size, more than are solved on one thread.
WorldModel heaps(int count, int height) {
  Rng rng(5);
  std::vector<BodyModel> boxes;
  for (int heap = 0; heap < count; ++heap) {
    for (int i = 0; i < height; ++i) {
      BodyModel body = box({0.1, 0.12, 0.08}, 0.3, {0.4 * heap, rng.uniform(-0.02, 0.02), 0.06 + 0.13 * i});
      body.X_WB.R = exp_rotation(Vector3(rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), rng.uniform(-3.0, 3.0)));
      boxes.push_back(body);
    }
  }
  WorldModel model = on_plane({0.3, 0.1, 0.0, 0.0}, boxes);
  model.settings.sleep.enabled = true;
  return model;
}

TEST(Threads, DoNotChangeTheBytes) {
  const WorldModel model = heaps(24, 6);
  WorldState one = make_state(model), many = make_state(model), turns = make_state(model);
  Workspace work_one(model), work_many(model, 3), work_turns(model, 2);
  int most = 0;
  for (int i = 0; i < 700; ++i) {
    const StepReport report = step(model, {}, one, work_one);
    const StepReport same = step(model, {}, many, work_many);
    (void)step(model, {}, turns, i % 2 == 0 ? work_one : work_turns);  // a workspace that does not know the state
    most = std::max(most, report.contacts);
    ASSERT_EQ(report.status, same.status);
    ASSERT_EQ(report.residual, same.residual);
    ASSERT_EQ(report.sweeps, same.sweeps);
    ASSERT_EQ(report.worst_penetration, same.worst_penetration);
    ASSERT_TRUE(one == many) << "step " << i;
  }
  EXPECT_TRUE(one == turns);
  EXPECT_GT(most, 400);  // enough to be shared
}

TEST(Threads, NameTheSameBodyWhenSomethingIsNoNumber) {
  const WorldModel model = heaps(24, 4);
  for (const int threads : {1, 3}) {
    SCOPED_TRACE(threads);
    WorldState state = make_state(model);
    Workspace work(model, threads);
    for (int i = 0; i < 200; ++i) (void)step(model, {}, state, work);
    state.bodies[40].velocity.x() = std::numeric_limits<double>::quiet_NaN();
    state.bodies[70].velocity.x() = std::numeric_limits<double>::infinity();
    const StepReport report = step(model, {}, state, work);
    EXPECT_EQ(report.status, StepStatus::NotFinite);
    EXPECT_EQ(report.culprit, BodyId{40});
  }
}

}  // namespace
}  // namespace snug::physics
