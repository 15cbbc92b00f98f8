// JointDrive: targets are followed within speed, acceleration and range; torques do what the equations of motion say.
#include "snug/control/joint_drive.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "demonstrator.hpp"
#include "snug/core/rng.hpp"
#include "snug/robot/dynamics.hpp"

namespace snug::control {
namespace {

using robot::JointVector;

constexpr double kTick = 0.008;
constexpr double kMost = 15.0;  // rad/s^2

struct Drive {
  robot::ArmModel arm = test::make_controller().arm();
  JointDrive drive{arm, kMost, kTick};
  JointMotion motion;
  JointVector before;

  explicit Drive(double q = 0.3) {
    motion.q = JointVector::Constant(6, q);
    motion.qd = motion.qdd = JointVector::Zero(6);
  }
  JointWay follow(DriveKind kind, const JointVector& target) {
    return drive.follow({std::vector<DriveKind>(6, kind), target}, before, motion);
  }
};

TEST(JointDrive, ReachesASpeedAsFastAsItsAccelerationAllows) {
  Drive drive;
  const JointVector target = JointVector::Constant(6, 0.5);
  int ticks = 0;
  for (; drive.motion.qd[0] < 0.5 && ticks < 100; ++ticks) (void)drive.follow(DriveKind::Speed, target);
  EXPECT_EQ(ticks, 5);  // 0.5 / (15 * 0.008) = 4.2
  EXPECT_EQ(drive.motion.qd, target);
  // parabola of four full ticks, then a part of one: q = sum of dt (v_k + v_k+1) / 2
  EXPECT_NEAR(drive.motion.q[0], 0.3 + kTick * (0.5 * 0.12 + 0.18 + 0.30 + 0.42 + 0.5 * (0.48 + 0.5)), 1e-12);
}

TEST(JointDrive, SendsAMeasuredSpeedBackUnchanged) {
  Drive drive;
  Rng rng = Rng(3).split("speeds");
  for (int i = 0; i < 2000; ++i) {
    const JointMotion start = drive.motion;
    JointVector wanted = drive.motion.qd;
    for (double& speed : wanted) speed += rng.uniform(-0.3, 0.3);
    (void)drive.drive.follow_speed(wanted, drive.motion);
    // Who commands the speed that came out gets the same motion, bit by bit: what runs in one process runs in two.
    JointMotion other = start;
    JointVector before;
    (void)drive.drive.follow({std::vector<DriveKind>(6, DriveKind::Speed), drive.motion.qd}, before, other);
    ASSERT_EQ(other, drive.motion) << i;
  }
}

TEST(JointDrive, IsWhereASmoothTargetIs) {
  Drive drive(0.0);
  double worst_speed = 0.0;
  for (int i = 1; i <= 1000; ++i) {
    const double t = kTick * i;  // at most 1 rad/s and 2 rad/s^2
    (void)drive.follow(DriveKind::Position, JointVector::Constant(6, 0.5 * std::sin(2.0 * t) * std::min(1.0, t)));
    if (i < 200) continue;
    EXPECT_EQ(drive.motion.q[2], 0.5 * std::sin(2.0 * t)) << i;
    worst_speed = std::max(worst_speed, std::abs(drive.motion.qd[2] - std::cos(2.0 * t)));
  }
  EXPECT_LT(worst_speed, 0.5 * 2.0 * kTick + 1e-9);  // the mean over a tick: half a tick behind at 2 rad/s^2
}

TEST(JointDrive, CatchesUpWithAJumpWithoutGoingBeyond) {
  for (const double jump : {1e-4, 1e-3, 0.02, 0.3, 2.0, -1.5}) {
    SCOPED_TRACE(jump);
    Drive drive(0.0);
    const JointVector target = JointVector::Constant(6, jump);
    double beyond = 0.0;
    int ticks = 0;
    for (; ticks < 2000 && drive.motion.q[1] != jump; ++ticks) {
      const JointMotion before = drive.motion;
      (void)drive.follow(DriveKind::Position, target);
      EXPECT_LE((drive.motion.qd - before.qd).cwiseAbs().maxCoeff(), kMost * kTick + 1e-12);
      for (int j = 0; j < 6; ++j)
        EXPECT_LE(std::abs(drive.motion.qd[j]), drive.arm.joints[static_cast<std::size_t>(j)].max_speed);
      beyond = std::max(beyond, (drive.motion.q[1] - jump) * (jump > 0.0 ? 1.0 : -1.0));
    }
    EXPECT_EQ(drive.motion.q[1], jump);
    EXPECT_LT(beyond, 0.5 * kMost * kTick * kTick);  // what a tick of full acceleration moves
    // Not slower than a quarter more than the fastest way there and to a stop, and some ticks.
    const double v = drive.arm.joints[1].max_speed, length = std::abs(jump);
    const double fastest = length < v * v / kMost ? 2.0 * std::sqrt(length / kMost) : length / v + v / kMost;
    EXPECT_LT(ticks * kTick, 1.25 * fastest + 10 * kTick);
    for (int i = 0; i < 10; ++i) (void)drive.follow(DriveKind::Position, target);
    EXPECT_EQ(drive.motion.q, target);
    EXPECT_EQ(drive.motion.qd.norm(), 0.0);
  }
}

TEST(JointDrive, StopsAtTheEndOfItsRange) {
  for (const DriveKind kind : {DriveKind::Speed, DriveKind::Position}) {
    Drive drive;
    const double upper = drive.arm.joints[3].upper, lower = drive.arm.joints[3].lower;
    for (const double target : {1e3, -1e3}) {
      for (int i = 0; i < 3000; ++i) {
        (void)drive.follow(kind, JointVector::Constant(6, target));
        EXPECT_LE(drive.motion.q[3], upper + 1e-9);
        EXPECT_GE(drive.motion.q[3], lower - 1e-9);
      }
      EXPECT_NEAR(drive.motion.q[3], target > 0.0 ? upper : lower, 1e-3);
      EXPECT_NEAR(drive.motion.qd[3], 0.0, 1e-3);
    }
  }
}

TEST(JointDrive, TorquesOfTheInverseDynamicsGiveTheAccelerationsBack) {
  const robot::ArmModel arm = test::make_controller().arm();
  const Vector3 gravity(0.0, 0.0, -9.81);
  Rng rng = Rng(5).split("torques");
  const auto random = [&](double size) {
    JointVector v(6);
    for (double& x : v) x = rng.uniform(-size, size);
    return v;
  };
  for (int i = 0; i < 100; ++i) {
    const JointMotion motion{random(3.0), random(2.0), random(10.0)};
    const Wrench F_Eo_W{Vector3(3.0, -20.0, 5.0), Vector3(0.5, 1.0, -2.0)};
    const robot::Jacobian J_WE = robot::tool_jacobian(arm, robot::forward(arm, motion.q));
    const JointVector felt =
        J_WE.topRows<3>().transpose() * F_Eo_W.force + J_WE.bottomRows<3>().transpose() * F_Eo_W.torque;
    DriveCommand command{std::vector<DriveKind>(6, DriveKind::Torque),
                         robot::inverse_dynamics(arm, {motion.q, motion.qd, motion.qdd}, F_Eo_W, gravity)};
    for (const int driven : {6, 3, 1}) {  // the others move as they are told
      for (int j = driven; j < 6; ++j) command.kinds[static_cast<std::size_t>(j)] = DriveKind::Speed;
      const JointVector qdd = compute_torque_accelerations(arm, command, motion, felt, gravity);
      EXPECT_LT((qdd - motion.qdd).norm(), 1e-8) << driven;
    }
  }
}

}  // namespace
}  // namespace snug::control
