// Inverse kinematics: all branches, exact on disturbed arms, singular and unreachable poses, arms without closed form.
#include "snug/robot/inverse.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include "shipped_arm.hpp"

namespace snug::robot {
namespace {

using test::disturbed;
using test::miss;
using test::random_joints;
using test::shipped_arm;
using test::turn_distance;

constexpr double kTurn = 2.0 * std::numbers::pi;

/// How near the joints are to where two branches meet: sines of elbow and wrist.
double branch_margin(const JointVector& q) { return std::min(std::abs(std::sin(q(2))), std::abs(std::sin(q(4)))); }

void expect_all_branches(const ArmModel& arm, Rng& rng, int count, double smallest_measure) {
  const InverseKinematics inverse(arm);
  ASSERT_TRUE(inverse.has_closed_form());
  int with_eight = 0;
  for (int k = 0; k < count; ++k) {
    SCOPED_TRACE(k);
    const JointVector q = random_joints(rng, 6, std::numbers::pi);
    // On arms that are not ideal two branches that almost meet may not be told apart (inverse.hpp).
    if (singularity_measure(tool_jacobian(arm, forward(arm, q))) < smallest_measure) continue;
    const Pose X_WE = forward_tool(arm, q);
    const IkBranches found = inverse.branches(X_WE, q);
    bool has_q = false;
    for (int i = 0; i < found.count; ++i) {
      const JointVector& branch = found.q[static_cast<std::size_t>(i)];
      EXPECT_LT(miss(arm, branch, X_WE), 1e-10);  // kIkTolerance
      // Joints follow the pose within 1e-10 / smallest singular value, which is above 0.01 here.
      has_q = has_q || turn_distance(branch, q) < 1e-8;
    }
    EXPECT_TRUE(has_q);
    with_eight += found.count == 8 ? 1 : 0;
  }
  EXPECT_GT(with_eight, count / 4);  // a third of all poses has eight
}

TEST(Inverse, FindsTheJointsAndAllOtherBranchesOfTheIdealArm) {
  Rng rng = Rng(11).split("ideal");
  expect_all_branches(shipped_arm(), rng, 2000, 1e-3);
}

TEST(Inverse, FindsThemOnArmsWithTheDeviationsOfACalibration) {
  Rng rng = Rng(12).split("calibrated");
  for (int k = 0; k < 10; ++k) expect_all_branches(disturbed(shipped_arm(), rng, 0.002, 0.01), rng, 200, 0.06);
}

TEST(Inverse, IsExactInClosedFormOnTheIdealArm) {
  Rng rng = Rng(13).split("closed form");
  ArmModel arm = shipped_arm();
  const auto geometry = find_ur_geometry(arm);
  ASSERT_TRUE(geometry.has_value());
  EXPECT_NEAR(geometry->upper_arm, 0.612, 1e-12);
  EXPECT_NEAR(geometry->forearm, 0.5723, 1e-12);
  EXPECT_NEAR(geometry->offset, 0.163941, 1e-12);
  EXPECT_NEAR(geometry->wrist, 0.1157, 1e-12);
  for (int k = 0; k < 500; ++k) {
    const JointVector q = random_joints(rng, 6, std::numbers::pi);
    if (branch_margin(q) < 0.05) continue;
    const Pose X_WE = forward_tool(arm, q);
    const ClosedBranches found = solve_ur(*geometry, arm.X_WB.inverse() * X_WE, 0.0, 0.0);
    EXPECT_GE(found.count, 2);
    for (int i = 0; i < found.count; ++i)  // rounding, through the elbow's acos near its ends
      EXPECT_LT(miss(arm, Eigen::Map<const Vector6>(found.q[static_cast<std::size_t>(i)].data()), X_WE), 1e-11);
  }
}

TEST(Inverse, TakesTheFreeJointFromNearbyWhereTheWristIsSingular) {
  const ArmModel& arm = shipped_arm();
  const InverseKinematics inverse(arm);
  JointVector q(6);
  q << 0.4, -1.2, 1.1, -0.7, 0.0, 0.3;  // q5 = 0: axes 4 and 6 are parallel
  EXPECT_LT(singularity_measure(tool_jacobian(arm, forward(arm, q))), 1e-9);
  const auto found = inverse.nearest(forward_tool(arm, q), q);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT(miss(arm, *found, forward_tool(arm, q)), 1e-10);
  EXPECT_LT((*found - q).cwiseAbs().maxCoeff(), 1e-6);  // the pose fixes the others to the square root of rounding
}

TEST(Inverse, SaysHowFarAPoseIsOutOfReach) {
  const ArmModel& arm = shipped_arm();
  const InverseKinematics inverse(arm);
  const JointVector q = JointVector::Zero(6);
  Pose X_WE = forward_tool(arm, q);
  X_WE.p *= 3.0;
  const auto found = inverse.nearest(X_WE, q);
  ASSERT_FALSE(found.has_value());
  EXPECT_EQ(found.error(), NoReach::OutOfReach);
  EXPECT_GT(inverse.branches(X_WE, q).shortfall, 0.5);
  // Straight above the base the wrist cannot be nearer to the first axis than its offset of 0.163941 m.
  const Pose above{Vector3(1, -1, -1).asDiagonal(), Vector3(0.0, 0.0, 0.2)};
  EXPECT_FALSE(inverse.nearest(above, q).has_value());
  EXPECT_NEAR(inverse.branches(above, q).shortfall, 0.163941, 1e-12);
}

TEST(Inverse, RefusesWhatOnlyJointsBeyondTheirLimitsReach) {
  ArmModel arm = shipped_arm();
  JointVector q(6);
  q << 0.5, -1.2, 1.4, -0.7, 1.0, 0.3;
  const Pose X_WE = forward_tool(arm, q);
  arm.joints[1].lower = 0.123;
  arm.joints[1].upper = 0.124;
  const auto found = InverseKinematics(arm).nearest(X_WE, q);
  ASSERT_FALSE(found.has_value());
  EXPECT_EQ(found.error(), NoReach::BeyondLimits);
}

TEST(Inverse, PrefersFullTurnsNearTheJointsAsked) {
  const ArmModel& arm = shipped_arm();
  JointVector q(6);
  q << 5.0, -1.2 - kTurn / 2, 1.4, -4.0, 1.0, 6.0;
  const auto found = InverseKinematics(arm).nearest(forward_tool(arm, q), q);
  ASSERT_TRUE(found.has_value());
  EXPECT_LT((*found - q).cwiseAbs().maxCoeff(), 1e-8);
}

/// Six joints with a wrist whose axes do not meet in one point: neither UR-like nor with a spherical wrist.
ArmModel offset_wrist_arm() {
  ArmModel arm = shipped_arm();
  arm.joints[3].X_SJ = {exp_rotation(Vector3(0.0, 0.5 * std::numbers::pi, 0.0)), Vector3(-0.1, 0.0, 0.0)};
  arm.joints[4].X_SJ = {exp_rotation(Vector3(0.5 * std::numbers::pi, 0.0, 0.0)), Vector3(0.0, 0.0, -0.5)};
  arm.joints[5].X_SJ = {exp_rotation(Vector3(-0.5 * std::numbers::pi, 0.0, 0.0)), Vector3(0.08, 0.0, 0.0)};
  return arm;
}

TEST(Inverse, SearchesAnArmWithoutClosedForm) {
  const ArmModel arm = offset_wrist_arm();
  const InverseKinematics inverse(arm);
  EXPECT_FALSE(inverse.has_closed_form());
  Rng rng = Rng(14).split("search");
  int found_count = 0;
  constexpr int kCount = 60;
  for (int k = 0; k < kCount; ++k) {
    const JointVector q = random_joints(rng, 6, 2.0);
    const Pose X_WE = forward_tool(arm, q);
    const auto found = inverse.nearest(X_WE, random_joints(rng, 6, 2.0));
    if (!found) continue;
    ++found_count;
    EXPECT_LT(miss(arm, *found, X_WE), 1e-10);
    for (int i = 0; i < 6; ++i) {
      EXPECT_GE((*found)(i), arm.joints[static_cast<std::size_t>(i)].lower);
      EXPECT_LE((*found)(i), arm.joints[static_cast<std::size_t>(i)].upper);
    }
  }
  EXPECT_EQ(found_count, kCount);
}

TEST(Inverse, TakesWhatASearchFromNearbyLeadsTo) {
  const ArmModel arm = offset_wrist_arm();
  const InverseKinematics inverse(arm);
  Rng rng = Rng(15).split("nearby");
  for (int k = 0; k < 60; ++k) {
    const JointVector q = random_joints(rng, 6, 1.5);
    const Pose X_WE = forward_tool(arm, q);
    const auto found = inverse.nearest(X_WE, q + random_joints(rng, 6, 0.02));
    ASSERT_TRUE(found.has_value());
    if (singularity_measure(tool_jacobian(arm, forward(arm, q))) < 0.06) continue;
    EXPECT_LT((*found - q).cwiseAbs().maxCoeff(), 1e-8) << k;
  }
}

TEST(Inverse, DoesNotConvergeToAPoseThatIsNotThere) {
  const ArmModel arm = offset_wrist_arm();
  const auto found = InverseKinematics(arm).nearest(Pose{Matrix3::Identity(), Vector3(5, 0, 0)}, JointVector::Zero(6));
  ASSERT_FALSE(found.has_value());
  EXPECT_EQ(found.error(), NoReach::NotConverged);
}

TEST(Inverse, SurvivesPosesThatAreNotNumbers) {
  const InverseKinematics inverse(shipped_arm());
  Pose X_WE;
  X_WE.p.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(inverse.nearest(X_WE, JointVector::Zero(6)).has_value());
  X_WE.p.setConstant(1e300);
  EXPECT_FALSE(inverse.nearest(X_WE, JointVector::Zero(6)).has_value());
  X_WE = Pose{};
  X_WE.p.setZero();  // on the first axis
  EXPECT_FALSE(inverse.nearest(X_WE, JointVector::Zero(6)).has_value());
}

TEST(Inverse, ReachesEveryWaypointOfTheDemonstratorFromItsPosture) {
  const std::filesystem::path folder = SNUG_SOURCE_DIR "/../shared/data/waypoints";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no reference data at " << folder;
  const InverseKinematics inverse(shipped_arm());
  double worst_measure = 1.0;
  std::string worst_name;
  int count = 0;
  for (const auto& file : std::filesystem::directory_iterator(folder)) {
    if (!file.path().filename().string().starts_with("poses")) continue;
    std::ifstream rows(file.path());
    JointVector q = joint_vector(test::demonstrator().robot->posture);
    for (std::string row; std::getline(rows, row);) {
      std::istringstream cells(row);
      std::array<double, 6> v{};
      std::string cell;
      for (double& value : v) {
        ASSERT_TRUE(std::getline(cells, cell, ','));
        value = std::stod(cell);
      }
      std::getline(cells, cell, ',');
      const Pose X_WE{exp_rotation({v[3], v[4], v[5]}), {v[0], v[1], v[2]}};
      const auto found = inverse.nearest(X_WE, q);
      ASSERT_TRUE(found.has_value()) << file.path().filename() << " " << cell << ": " << describe(found.error());
      q = *found;
      const double measure = singularity_measure(tool_jacobian(shipped_arm(), forward(shipped_arm(), q)));
      if (measure < worst_measure) worst_name = file.path().filename().string() + " " + cell;
      worst_measure = std::min(worst_measure, measure);
      ++count;
    }
  }
  EXPECT_GT(count, 500);
  // Away from singular everywhere; the lowest there is.
  EXPECT_GT(worst_measure, 0.02) << worst_name;
}

}  // namespace
}  // namespace snug::robot
