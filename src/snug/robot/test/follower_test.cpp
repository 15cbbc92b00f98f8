// Joints that mimic others between base and tool, against the same arm whose joints all move by themselves.
#include <gtest/gtest.h>

#include "shipped_arm.hpp"
#include "snug/core/input_error.hpp"
#include "snug/robot/dynamics.hpp"
#include "snug/robot/inverse.hpp"

namespace snug::robot {
namespace {

std::string palletiser_link(const std::string& name, double mass) {
  return "<link name=\"" + name + "\"><inertial><origin xyz=\"0.1 0.02 0.2\"/><mass value=\"" + std::to_string(mass) +
         "\"/><inertia ixx=\"0.3\" iyy=\"0.2\" izz=\"0.25\"/></inertial></link>";
}

std::string palletiser_joint(const std::string& name, const std::string& parent, const std::string& child,
                             const std::string& axis, const std::string& xyz, const std::string& more) {
  return "<joint name=\"" + name + "\" type=\"revolute\"><parent link=\"" + parent + "\"/><child link=\"" + child +
         "\"/><axis xyz=\"" + axis + "\"/><origin xyz=\"" + xyz + "\"/>" + more + "</joint>\n";
}

constexpr const char* kWide = "<limit lower=\"-2\" upper=\"2\" effort=\"100\" velocity=\"3\"/>";

/// A palletiser of four axes: two joints in a row keep its flange level. `elbow` and `shoulder` are their mimics.
std::string palletiser(const std::string& elbow, const std::string& shoulder) {
  return "<robot name=\"palletiser\"><link name=\"base\"/><link name=\"E\"/>" + palletiser_link("column", 20) +
         palletiser_link("lower", 15) + palletiser_link("upper", 10) + palletiser_link("rods", 1) +
         palletiser_link("wrist", 4) + palletiser_link("flange", 1) +
         palletiser_joint("j1", "base", "column", "0 0 1", "0 0 0.4", kWide) +
         palletiser_joint("j2", "column", "lower", "0 1 0", "0.15 0 0", kWide) +
         palletiser_joint("j3", "lower", "upper", "0 1 0", "0 0 0.6", kWide) +
         palletiser_joint("level_j3", "upper", "rods", "0 1 0", "0.6 0 0",
                          "<limit lower=\"-1.5\" upper=\"2.5\" effort=\"1\" velocity=\"1\"/>" + elbow) +
         palletiser_joint("level_j2", "rods", "wrist", "0 1 0", "0 0 0", kWide + shoulder) +
         palletiser_joint("j4", "wrist", "flange", "0 0 1", "0.1 0 -0.1", kWide) +
         "<joint name=\"tip\" type=\"fixed\"><parent link=\"flange\"/><child link=\"E\"/><origin xyz=\"0 0 -0.1\" "
         "rpy=\"3.141592653589793 0 0\"/></joint></robot>";
}

const char* const kLevelElbow = "<mimic joint=\"j3\" multiplier=\"-1\" offset=\"0.2\"/>";
const char* const kLevelShoulder = "<mimic joint=\"j2\" multiplier=\"-1\" offset=\"-0.2\"/>";

ArmModel coupled() { return parse_urdf(palletiser(kLevelElbow, kLevelShoulder), "palletiser.urdf"); }
ArmModel uncoupled() { return parse_urdf(palletiser("", ""), "palletiser.urdf"); }

/// Six numbers for the free arm from four of the coupled one, and the matrix of their rates.
Eigen::Matrix<double, 6, 4> coupling() {
  Eigen::Matrix<double, 6, 4> C = Eigen::Matrix<double, 6, 4>::Zero();
  C(0, 0) = C(1, 1) = C(2, 2) = C(5, 3) = 1.0;
  C(3, 2) = C(4, 1) = -1.0;
  return C;
}
JointVector freed(const JointVector& q) {
  JointVector all = coupling() * q;
  all(3) += 0.2;
  all(4) -= 0.2;
  return all;
}

TEST(Follower, MovesAsTheSameArmWhoseJointsAreMovedSo) {
  const ArmModel arm = coupled(), free = uncoupled();
  ASSERT_EQ(arm.joint_count(), 4);
  ASSERT_EQ(arm.last_segment(), 6);
  Rng rng = Rng(5).split("follower");
  const auto C = coupling();
  for (int k = 0; k < 20; ++k) {
    const JointVector q = test::random_joints(rng, 4, 1.5), qd = test::random_joints(rng, 4, 1.0),
                      qdd = test::random_joints(rng, 4, 1.0);
    const ArmPose at = forward(arm, q), at_free = forward(free, freed(q));
    EXPECT_LT((at.X_WE.p - at_free.X_WE.p).norm() + (at.X_WE.R - at_free.X_WE.R).norm(), 1e-14);
    EXPECT_LT((forward_tool(arm, q).p - at.X_WE.p).norm(), 1e-15);
    EXPECT_NEAR(at.X_WE.R(2, 2), -1.0, 1e-14) << "the flange stays level";
    EXPECT_LT((tool_jacobian(arm, at) - tool_jacobian(free, at_free) * C).norm(), 1e-13);
    const JointVector qd_free = C * qd, qdd_free = C * qdd;
    EXPECT_LT((tool_bias_acceleration(arm, at, qd) - tool_bias_acceleration(free, at_free, qd_free)).norm(), 1e-13);
    const Wrench F{Vector3(rng.normal(), rng.normal(), rng.normal()), Vector3(rng.normal(), rng.normal(), 0.3)};
    const Vector3 gravity(0.1, 0.2, -9.81);
    const JointVector tau = inverse_dynamics(arm, {q, qd, qdd}, F, gravity);
    const JointVector tau_free = inverse_dynamics(free, {freed(q), qd_free, qdd_free}, F, gravity);
    EXPECT_LT((tau - C.transpose() * tau_free).norm(), 1e-11);
    const Eigen::MatrixXd M = C.transpose() * mass_matrix(free, freed(q)) * C;
    EXPECT_LT((mass_matrix(arm, q) - M).norm(), 1e-11);
  }
}

TEST(Follower, IsReachedBySearch) {
  const ArmModel arm = coupled();
  const InverseKinematics inverse(arm);
  EXPECT_FALSE(inverse.has_closed_form());
  Rng rng = Rng(6).split("follower");
  for (int k = 0; k < 20; ++k) {
    const JointVector q = test::random_joints(rng, 4, 1.2);
    const auto found = inverse.nearest(forward_tool(arm, q), q + test::random_joints(rng, 4, 0.1));
    ASSERT_TRUE(found.has_value());
    EXPECT_LT((forward_tool(arm, *found).p - forward_tool(arm, q).p).norm(), 1e-9);
  }
}

TEST(Follower, ItsLimitsAreThoseOfItsLeader) {
  const ArmModel arm = coupled();
  // -q + 0.2 within -1.5 .. 2.5, and 1 rad/s.
  EXPECT_NEAR(arm.joints[2].lower, -2.0, 1e-15);
  EXPECT_NEAR(arm.joints[2].upper, 1.7, 1e-15);
  EXPECT_EQ(arm.joints[2].max_speed, 1.0);
  EXPECT_NEAR(arm.joints[1].lower, -2.0, 1e-15);
  EXPECT_NEAR(arm.joints[1].upper, 1.8, 1e-15);
}

TEST(Follower, MayBeLedThroughAnotherOne) {
  const ArmModel arm = parse_urdf(
      palletiser("<mimic joint=\"level_j2\" multiplier=\"2\" offset=\"0.1\"/>", "<mimic joint=\"j2\" offset=\"0.3\"/>"),
      "palletiser.urdf");
  ASSERT_EQ(arm.followers.size(), 2u);
  EXPECT_EQ(arm.followers[0].leader, 1);
  EXPECT_NEAR(arm.followers[0].ratio, 2.0, 1e-15);
  EXPECT_NEAR(arm.followers[0].offset, 0.7, 1e-15);
}

TEST(Follower, RefusesWhatCannotBe) {
  const auto refused = [](const std::string& elbow, const std::string& shoulder, const std::string& part) {
    try {
      (void)parse_urdf(palletiser(elbow, shoulder), "palletiser.urdf");
      ADD_FAILURE() << "accepted: " << part;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  };
  refused("<mimic joint=\"level_j2\"/>", "<mimic joint=\"level_j3\"/>", "in a circle");
  refused("<mimic joint=\"j7\"/>", "", "'j7', which is not there");
  refused("<mimic joint=\"j3\" offset=\"50\"/>", "", "no range");
}

TEST(Follower, OfAJointThatStandsStandsToo) {
  const ArmModel arm = parse_urdf(
      palletiser("<mimic joint=\"tip\" offset=\"0.3\"/>", "<mimic joint=\"j2\" multiplier=\"0\"/>"), "palletiser.urdf");
  EXPECT_TRUE(arm.followers.empty());
  EXPECT_EQ(arm.joint_count(), 4);
  EXPECT_NEAR(forward_tool(arm, JointVector::Zero(4)).R(2, 0), -std::sin(0.3), 1e-12);
}

}  // namespace
}  // namespace snug::robot
