// Allocation: step() takes no memory, counted at malloc itself: Eigen's dynamic matrices do not use operator new.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <atomic>
#include <cstdlib>
#include <vector>

#include "jam_scene.hpp"
#include "snug/core/rng.hpp"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)
#define SNUG_COUNTS_MALLOC 0  // sanitizers bring a malloc of their own
#else
#define SNUG_COUNTS_MALLOC 1
#endif

namespace {
std::atomic<bool> is_counting{false};
std::atomic<int> count{0};

[[maybe_unused]] void note() {  // not with a sanitizer
  if (is_counting) ++count;
}
}  // namespace

#if SNUG_COUNTS_MALLOC
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t items, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) noexcept {
  note();
  return __libc_malloc(size);
}
void* calloc(std::size_t items, std::size_t size) noexcept {
  note();
  return __libc_calloc(items, size);
}
void* realloc(void* memory, std::size_t size) noexcept {
  note();
  return __libc_realloc(memory, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  note();
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  note();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
  note();
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? 12 : 0;  // ENOMEM
}
}
#endif

namespace snug::physics::test {
namespace {

double a_vector_of(int n) { return std::vector<double>(static_cast<std::size_t>(n), 1.0).back(); }

template <class F>
int allocations_in(const F& f) {
  count = 0;
  is_counting = true;
  f();
  is_counting = false;
  return count;
}

class Allocation : public testing::Test {
 protected:
  void SetUp() override {
    if (SNUG_COUNTS_MALLOC == 0) GTEST_SKIP() << "malloc belongs to a sanitizer here";
  }
};

TEST_F(Allocation, IsSeenWhoeverAsksForMemory) {
  // The hook must see what a careless change of step() would do.
  static volatile int n = 9;
  static double sum = 0.0;
  const auto use_eigen = [] {
    const Eigen::MatrixXd a = Eigen::MatrixXd::Identity(n, n);
    const Eigen::VectorXd b = a * Eigen::VectorXd::Ones(n);
    sum += b.sum();
  };
  EXPECT_GE(allocations_in(use_eigen), 2);
  EXPECT_GE(allocations_in([] { sum += a_vector_of(n); }), 1);
  EXPECT_GE(allocations_in([] {
              void* volatile memory = std::malloc(16);
              std::free(memory);
            }),
            1);
  EXPECT_EQ(allocations_in([] { sum += 1.0; }), 0);
}

TEST_F(Allocation, DoesNotHappenWhileBoxesFallLieSleepAndWake) {
  Rng rng = Rng(7).split("allocation");
  std::vector<BodyModel> boxes;
  for (int i = 0; i < 10; ++i) {
    boxes.push_back(box({0.15, 0.12, 0.1}, 0.4, {rng.uniform(-0.2, 0.2), rng.uniform(-0.1, 0.1), 0.1 + 0.14 * i}));
    boxes.back().X_WB.R = exp_rotation(Vector3(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0), rng.uniform(-3.0, 3.0)));
  }
  WorldModel model = in_container(boxes);
  model.settings.sleep.enabled = true;
  Simulation run(model);
  const int found = allocations_in([&] {
    run.steps(1500);
    set_present(run.state, BodyId{7}, false);
    set_pose(model, run.state, BodyId{8}, {Matrix3::Identity(), Vector3(0.0, 0.0, 0.8)});
    run.steps(300);
  });
  EXPECT_EQ(found, 0);
}

TEST_F(Allocation, DoesNotHappenWhereNewtonFinishesJammedBoxes) {
  const WorldModel model = jammed_boxes(2e-4);
  const Press press(100.0);
  Simulation run(model);
  int most_sweeps = 0;
  const int found = allocations_in([&] {
    for (int i = 0; i < 400; ++i) most_sweeps = std::max(most_sweeps, run.step(press.input()).sweeps);
  });
  EXPECT_EQ(found, 0);
  EXPECT_GT(most_sweeps, 20);  // Newton was at work
}

struct Spring final : ForceElement {
  [[nodiscard]] ElementResponse evaluate(const ElementQuery& query) const noexcept override {
    ElementResponse response;
    response.wrench.head<3>() = 500.0 * (query.X_WE.p - query.p_WBcm);
    response.stiffness.topLeftCorner<3, 3>() = 500.0 * Matrix3::Identity();
    return response;
  }
};

TEST_F(Allocation, DoesNotHappenWithForceElementsCompliantPairsAndLostBodies) {
  WorldModel model = world({0.3, 0.2, 2e4, 50.0}, {0.3, 0.2, 0.0, 0.0});
  model.bodies.push_back(fixed_box({2.0, 2.0, 0.1}, {0.0, 0.0, -0.05}));
  BodyModel carrier = fixed_box({0.05, 0.05, 0.05}, {0.0, 0.0, 0.6});
  carrier.kind = BodyKind::Kinematic;
  model.bodies.push_back(carrier);
  for (int i = 0; i < 4; ++i) model.bodies.push_back(box({0.2, 0.2, 0.1}, 0.5, {0.01 * i, 0.0, 0.06 + 0.12 * i}));
  model.finalize();
  Simulation run(model);
  const Spring spring;
  const ElementUse use{&spring, BodyId{1}, {}, BodyId{5}};
  const int found = allocations_in([&] {
    for (int i = 0; i < 500; ++i) {
      const KinematicTarget target{BodyId{1}, {Matrix3::Identity(), Vector3(2e-4 * i, 0.0, 0.6)}};
      WorldInput input;
      input.elements = {&use, 1};
      input.kinematic = {&target, 1};
      (void)run.step(input);
    }
    set_twist(model, run.state, BodyId{3}, Twist{Vector3(0.0, 1e9, 0.0), Vector3::Zero()});
    (void)run.step();
  });
  EXPECT_EQ(found, 0);
}

TEST_F(Allocation, DoesNotHappenWhenStatesAreCopiedIntoSnapshotsOfTheSameModel) {
  const WorldModel model = jammed_boxes(1e-3);
  Simulation run(model);
  run.steps(20);
  WorldState snapshot = run.state;
  EXPECT_EQ(allocations_in([&] {
              run.steps(20);
              run.state = snapshot;
              run.steps(20);
              snapshot = run.state;
            }),
            0);
}

}  // namespace
}  // namespace snug::physics::test
