// Second opinion: KDL (liborocos-kdl-dev, libkdl-parser-dev) reads the same URDF and must give the same numbers.
#include <gtest/gtest.h>

#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <kdl/tree.hpp>
#include <kdl_parser/kdl_parser.hpp>

#include "shipped_arm.hpp"
#include "snug/robot/dynamics.hpp"

namespace snug::robot {
namespace {

using test::random_joints;

const char* const kUrdf = SNUG_SOURCE_DIR "/scenarios/robots/ur10.urdf";

/// base_link to E as KDL sees it; ours stands with base_link in the world, as there.
struct Both {
  ArmModel ours = load_urdf(kUrdf);
  KDL::Chain theirs;
  Both() {
    KDL::Tree tree;
    EXPECT_TRUE(kdl_parser::treeFromFile(kUrdf, tree));
    EXPECT_TRUE(tree.getChain("base_link", "suction_cup", theirs));
    EXPECT_EQ(theirs.getNrOfJoints(), 6u);
  }
};

KDL::JntArray to_kdl(const JointVector& q) {
  KDL::JntArray array(static_cast<unsigned>(q.size()));
  array.data = q;
  return array;
}

// Everything below is of size 1 to 100 and sums a few dozen products: rounding stays below 1e-12 of that.

TEST(ArmAgainstKdl, HasTheSamePoseAndJacobian) {
  Both both;
  KDL::ChainFkSolverPos_recursive fk(both.theirs);
  KDL::ChainJntToJacSolver jacobian(both.theirs);
  Rng rng = Rng(21).split("kdl");
  for (int k = 0; k < 500; ++k) {
    const JointVector q = random_joints(rng, 6, 6.0);
    const ArmPose at = forward(both.ours, q);
    KDL::Frame frame;
    ASSERT_GE(fk.JntToCart(to_kdl(q), frame), 0);
    for (int r = 0; r < 3; ++r) {
      EXPECT_NEAR(frame.p(r), at.X_WE.p(r), 1e-12);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(frame.M(r, c), at.X_WE.R(r, c), 1e-12);
    }
    KDL::Jacobian theirs(6);
    ASSERT_GE(jacobian.JntToJac(to_kdl(q), theirs), 0);
    EXPECT_LT((theirs.data - tool_jacobian(both.ours, at)).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(ArmAgainstKdl, NeedsTheSameTorques) {
  Both both;
  const Vector3 gravity(0.3, -0.2, -9.81);
  KDL::ChainIdSolver_RNE rne(both.theirs, KDL::Vector(gravity.x(), gravity.y(), gravity.z()));
  Rng rng = Rng(22).split("kdl dynamics");
  for (int k = 0; k < 300; ++k) {
    const ArmMotion motion{random_joints(rng, 6, 3.0), random_joints(rng, 6, 3.0), random_joints(rng, 6, 10.0)};
    const Wrench F{Vector3(rng.normal(), rng.normal(), rng.normal()) * 20.0,
                   Vector3(rng.normal(), rng.normal(), rng.normal()) * 3.0};
    const JointVector tau = inverse_dynamics(both.ours, motion, F, gravity);
    // KDL takes wrenches on each segment in its own frame; the last one is the cup, whose frame is E.
    const Matrix3 R_EW = forward(both.ours, motion.q).X_WE.R.transpose();
    const Vector3 f = R_EW * F.force, t = R_EW * F.torque;
    KDL::Wrenches wrenches(both.theirs.getNrOfSegments(), KDL::Wrench::Zero());
    wrenches.back() = {KDL::Vector(f.x(), f.y(), f.z()), KDL::Vector(t.x(), t.y(), t.z())};
    KDL::JntArray theirs(6);
    ASSERT_GE(rne.CartToJnt(to_kdl(motion.q), to_kdl(motion.qd), to_kdl(motion.qdd), wrenches, theirs), 0);
    EXPECT_LT((theirs.data - tau).cwiseAbs().maxCoeff(), 1e-12 * (1.0 + tau.cwiseAbs().maxCoeff()));
  }
}

}  // namespace
}  // namespace snug::robot
