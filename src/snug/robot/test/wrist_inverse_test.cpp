// Arms with a spherical wrist: all branches, exact on disturbed arms, singular and unreachable poses, and arms that
// only look like one.
#include "snug/robot/wrist_inverse.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "shipped_arm.hpp"
#include "snug/robot/inverse.hpp"
#include "snug/robot/kinematics.hpp"

namespace snug::robot {
namespace {

using test::disturbed;
using test::miss;
using test::random_joints;
using test::turn_distance;

/// Where an axis stands at q = 0, in the root link.
struct Axis {
  Vector3 p, axis;
};

/// An arm whose segment frames all have the axes of the root at q = 0.
ArmModel make_arm(const std::array<Axis, 6>& axes, const Vector3& p_BE) {
  ArmModel arm;
  arm.X_WB = {exp_rotation(Vector3(0.3, -0.2, 0.9)), {0.1, 0.2, 0.3}};
  Vector3 before = Vector3::Zero();
  for (const Axis& one : axes) {
    Joint joint;
    joint.name = "j" + std::to_string(arm.joints.size() + 1);
    joint.X_SJ.p = one.p - before;
    joint.axis = one.axis.normalized();
    joint.lower = -2.0 * std::numbers::pi;
    joint.upper = 2.0 * std::numbers::pi;
    joint.max_speed = 1.0;
    arm.joints.push_back(joint);
    before = one.p;
  }
  arm.segments.assign(7, SpatialInertia{0.0, Vector3::Zero(), Matrix3::Zero()});
  arm.X_SE = {exp_rotation(Vector3(0.1, 1.4, 0.2)), p_BE - before};
  return arm;
}

/// An arm of industry: shoulder beside the first axis, elbow above the forearm, a wrist that is 0.1 m short of E, and
/// the second axis on the other side of the first or not.
ArmModel industrial(double shoulder = 0.15, double aside = 0.0, double elbow_sign = 1.0) {
  return make_arm({Axis{{0, 0, 0.2}, {0, 0, 1}}, Axis{{shoulder, 0.05, 0.45}, {0, 1, 0}},
                   Axis{{shoulder, 0.09, 1.05}, {0, elbow_sign, 0}}, Axis{{0.4, aside, 1.2}, {1, 0, 0}},
                   Axis{{shoulder + 0.65, aside, 1.2}, {0, 1, 0}}, Axis{{0.9, aside, 1.2}, {1, 0, 0}}},
                  {0.95, aside, 1.25});
}

void expect_every_branch(const ArmModel& arm, const char* what) {
  SCOPED_TRACE(what);
  const InverseKinematics inverse(arm);
  ASSERT_TRUE(inverse.has_closed_form());
  Rng rng = Rng(5).split(what);
  int with_eight = 0, counted = 0;
  for (int k = 0; k < 300; ++k) {
    SCOPED_TRACE(k);
    const JointVector q = random_joints(rng, 6, std::numbers::pi);
    if (singularity_measure(tool_jacobian(arm, forward(arm, q))) < 0.06) continue;
    const Pose X_WE = forward_tool(arm, q);
    const IkBranches found = inverse.branches(X_WE, q);
    bool has_q = false;
    for (int i = 0; i < found.count; ++i) {
      const JointVector& branch = found.q[static_cast<std::size_t>(i)];
      EXPECT_LT(miss(arm, branch, X_WE), kIkTolerance);
      has_q = has_q || turn_distance(branch, q) < 1e-8;
      for (int j = 0; j < i; ++j) EXPECT_GT(turn_distance(branch, found.q[static_cast<std::size_t>(j)]), 1e-6);
    }
    EXPECT_TRUE(has_q);
    EXPECT_LE(found.shortfall, 0.0);
    with_eight += found.count == 8 ? 1 : 0;
    ++counted;
  }
  EXPECT_GT(counted, 150);
  EXPECT_GT(with_eight, counted / 6);
}

TEST(WristInverse, FindsTheJointsAndAllOtherBranches) {
  expect_every_branch(industrial(), "shoulder beside the axis");
  expect_every_branch(industrial(0.0), "shoulder on the axis");
  expect_every_branch(industrial(0.15, 0.07), "wrist beside the plane of the arm");
  expect_every_branch(industrial(0.15, 0.07, -1.0), "third axis the other way round");
  // A wrist whose axes are not at right angles.
  ArmModel skew = industrial();
  skew.joints[3].axis = Vector3(1.0, 0.4, 0.2).normalized();
  skew.joints[3].X_SJ.p = Vector3(0.65, -0.09, 0.15) - 0.3 * skew.joints[3].axis;
  skew.joints[4].X_SJ.p = 0.3 * skew.joints[3].axis;
  expect_every_branch(skew, "skew wrist");
}

TEST(WristInverse, FindsThemOnArmsWithTheDeviationsOfACalibration) {
  Rng rng(7);
  for (int i = 0; i < 5; ++i) expect_every_branch(disturbed(industrial(), rng, 0.002, 0.005), "disturbed");
}

TEST(WristInverse, IsExactInClosedForm) {
  const ArmModel arm = industrial(0.15, 0.07);
  ArmModel at_root = arm;
  at_root.X_WB = Pose{};
  const auto geometry = find_wrist_geometry(arm);
  ASSERT_TRUE(geometry);
  Rng rng(11);
  for (int k = 0; k < 200; ++k) {
    const JointVector q = random_joints(rng, 6, std::numbers::pi);
    const Pose X_BE = forward_tool(at_root, q);
    const ClosedBranches found = solve_wrist_arm(*geometry, X_BE, q(5), 0.0);
    ASSERT_GT(found.count, 0) << k;
    for (int i = 0; i < found.count; ++i)
      EXPECT_LT(miss(at_root, Eigen::Map<const Vector6>(found.q[static_cast<std::size_t>(i)].data()), X_BE), 1e-7) << k;
  }
}

TEST(WristInverse, TakesTheFreeJointFromNearbyWhereTheWristIsSingular) {
  const ArmModel arm = industrial();
  const InverseKinematics inverse(arm);
  JointVector q(6);
  q << 0.3, 0.4, -0.5, 0.7, 0.0, 0.2;  // the fifth: fourth and sixth axis in one line
  const Pose X_WE = forward_tool(arm, q);
  const auto near = inverse.nearest(X_WE, q);
  ASSERT_TRUE(near);
  EXPECT_LT(miss(arm, *near, X_WE), 1e-9);
  EXPECT_NEAR((*near)(5), 0.2, 1e-6);
  EXPECT_NEAR((*near)(3), 0.7, 1e-6);
}

TEST(WristInverse, SaysHowFarAPoseIsOutOfReach) {
  const ArmModel arm = industrial();
  const InverseKinematics inverse(arm);
  const JointVector zero = JointVector::Zero(6);
  for (const double far : {0.1, 1.0, 5.0}) {
    // The arm stretched from its second axis, and farther by `far`: of all branches the nearest lacks as much.
    ArmModel at_root = arm;
    at_root.X_WB = Pose{};
    const auto g = find_wrist_geometry(arm);
    ASSERT_TRUE(g);
    const double longest = std::hypot(0.0, 0.6) + std::hypot(0.65, 0.15);
    Pose X_BE = forward_tool(at_root, zero);
    const Vector3 wrist(0.15 + longest + far, 0.0, 0.45);
    X_BE.p = wrist - X_BE.R * g->p_EC_E;
    const IkBranches found = inverse.branches(arm.X_WB * X_BE, zero);
    EXPECT_EQ(found.count, 0);
    EXPECT_NEAR(found.shortfall, far, 0.002 + 0.001 * far);
  }
}

TEST(WristInverse, LeavesOtherArmsToTheSearch) {
  EXPECT_FALSE(find_wrist_geometry(test::shipped_arm())) << "a UR has no spherical wrist";
  ArmModel offset = industrial();
  offset.joints[5].X_SJ.p.z() += 0.06;  // the last axis passes the point of the others
  EXPECT_FALSE(find_wrist_geometry(offset));
  ArmModel tilted = industrial();
  tilted.joints[2].axis = Vector3(0.2, 1.0, 0.0).normalized();
  EXPECT_FALSE(find_wrist_geometry(tilted));
  ArmModel sliding = industrial();
  sliding.joints[0].kind = JointKind::Prismatic;
  EXPECT_FALSE(find_wrist_geometry(sliding));
  ArmModel five = industrial();
  five.joints.pop_back();
  five.segments.pop_back();
  EXPECT_FALSE(find_wrist_geometry(five));
  ArmModel short_arm = industrial();
  short_arm.joints[2].X_SJ.p = Vector3(0.0, 0.04, 0.01);
  EXPECT_FALSE(find_wrist_geometry(short_arm));
}

TEST(WristInverse, SurvivesPosesThatAreNotNumbers) {
  const InverseKinematics inverse(industrial());
  Pose X_WE;
  X_WE.p.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(inverse.branches(X_WE, JointVector::Zero(6)).count, 0);
  X_WE.p.x() = 1e300;
  EXPECT_EQ(inverse.branches(X_WE, JointVector::Zero(6)).count, 0);
}

}  // namespace
}  // namespace snug::robot
