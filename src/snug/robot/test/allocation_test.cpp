// Kinematics, dynamics and the closed-form inverse never allocate: global new is counted.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "shipped_arm.hpp"
#include "snug/robot/dynamics.hpp"
#include "snug/robot/inverse.hpp"

namespace {

std::atomic<long long> allocations{0};

void* counted(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) { return counted(size); }
void* operator new[](std::size_t size) { return counted(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

namespace snug::robot {
namespace {

TEST(Robot, NeverAllocatesOnceAnArmIsLoaded) {
  const ArmModel& arm = test::shipped_arm();
  const InverseKinematics inverse(arm);
  Rng rng = Rng(30).split("allocation");
  const SpatialInertia load = distal_inertia(arm, find_link(arm, "ft_sensor"));
  const int sensor = find_link(arm, "ft_sensor");
  double sum = 0.0;
  const long long before = allocations;
  for (int k = 0; k < 100; ++k) {
    const JointVector q = test::random_joints(rng, 6, 3.0);
    const ArmPose at = forward(arm, q);
    const Jacobian J = tool_jacobian(arm, at);
    const ArmMotion motion{q, q, q};
    sum += singularity_measure(J) + mass_matrix(arm, q)(0, 0) + tool_bias_acceleration(arm, at, q)(0);
    sum += inverse_dynamics(arm, motion, Wrench{}, Vector3::UnitZ())(0);
    sum += sensor_wrench(arm, motion, sensor, load, Wrench{}, Vector3::UnitZ()).force.x();
    const auto found = inverse.nearest(at.X_WE, q);
    sum += found ? (*found)(0) : 0.0;
  }
  EXPECT_EQ(allocations - before, 0);
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace snug::robot
