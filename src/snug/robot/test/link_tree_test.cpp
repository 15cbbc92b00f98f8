// LinkTree: joints of a URDF in order, with all links where the arm's kinematics puts them; meshes inside the text.
#include "snug/robot/link_tree.hpp"

#include <gtest/gtest.h>

#include <map>

#include "snug/core/read_file.hpp"
#include "snug/core/rng.hpp"
#include "snug/robot/kinematics.hpp"
#include "snug/robot/test/shipped_arm.hpp"

namespace snug::robot {
namespace {

std::string joint(const std::string& name, const std::string& parent, const std::string& child,
                  const std::string& rest = "", const std::string& type = "fixed") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child + "'/>" +
         rest + "</joint>";
}

std::string robot_with(const std::string& joints) { return "<robot name='r'>" + joints + "</robot>"; }

TEST(LinkTree, PutsTheLinksOfTheShippedArmWhereItsKinematicsDoes) {
  const ArmModel arm = test::shipped_arm();
  const std::vector<LinkJoint> joints =
      parse_link_tree(read_file(SNUG_SOURCE_DIR "/scenarios/robots/ur10.urdf", "a URDF"));
  ASSERT_EQ(joints.size() + 1, arm.links.size());
  Rng rng = Rng(5).split("link tree");
  for (int k = 0; k < 50; ++k) {
    const JointVector q = test::random_joints(rng, arm.joint_count(), 3.0);
    const ArmPose at = forward(arm, q);
    std::map<std::string, Pose> X_WL = {{joints.front().parent, link_pose(arm, at, find_link(arm, "base_link"))}};
    for (const LinkJoint& one : joints) {
      const int index = find_joint(arm, one.name);
      X_WL[one.child] = X_WL.at(one.parent) * pose_at(one, index >= 0 ? q[index] : 0.0);
      const Pose expected = link_pose(arm, at, find_link(arm, one.child));
      EXPECT_LT((X_WL[one.child].p - expected.p).norm(), 1e-12) << one.child;
      EXPECT_LT((X_WL[one.child].R - expected.R).norm(), 1e-12) << one.child;
    }
  }
}

TEST(LinkTree, HasParentsFirstWhateverTheFilesOrder) {
  const auto joints = parse_link_tree(
      robot_with(joint("c", "b", "c", "<axis xyz='0 0 2'/><origin xyz='1 0 0'/>", "prismatic") + joint("b", "a", "b")));
  ASSERT_EQ(joints.size(), 2U);
  EXPECT_EQ(joints[0].child, "b");
  EXPECT_FALSE(joints[0].kind);
  EXPECT_EQ(pose_at(joints[1], 0.5).p, Vector3(1.0, 0.0, 0.5));
}

TEST(LinkTree, IsEmptyWhereThereIsNoTree) {
  EXPECT_TRUE(parse_link_tree("").empty());
  EXPECT_TRUE(parse_link_tree("<!-- nothing -->").empty());
  EXPECT_TRUE(parse_link_tree("<robot").empty());
  EXPECT_TRUE(parse_link_tree(robot_with("")).empty());
  EXPECT_TRUE(parse_link_tree(robot_with(joint("a", "a", "b") + joint("b", "b", "a"))).empty());  // a circle
  EXPECT_TRUE(parse_link_tree(robot_with(joint("a", "a", "c") + joint("b", "b", "c"))).empty());  // two parents
  EXPECT_TRUE(parse_link_tree(robot_with(joint("a", "a", "b") + joint("c", "c", "d"))).empty());  // two roots
  EXPECT_TRUE(parse_link_tree(robot_with(joint("a", "a", "b", "<axis xyz='0 0 0'/>", "revolute"))).empty());
  EXPECT_TRUE(parse_link_tree(robot_with(joint("a", "a", "b", "<origin xyz='nan 0 0'/>"))).empty());
}

TEST(EmbedMeshes, PutsFilesThatAreThereIntoTheTextAndLeavesTheRest) {
  const std::string urdf =
      "<robot name='r'><link name='a'><visual><geometry><mesh filename='x/M.STL' scale='2 2 2'/></geometry></visual>"
      "<visual><geometry><mesh filename='gone.dae'/></geometry></visual>"
      "<visual><geometry><box size='1 1 1'/></geometry></visual></link></robot>";
  const std::string inside = embed_meshes(urdf, {{"x/M.STL", "foo"}});
  EXPECT_NE(inside.find(R"(filename="data:model/stl;base64,Zm9v" scale="2 2 2")"), std::string::npos) << inside;
  EXPECT_NE(inside.find(R"(filename="gone.dae")"), std::string::npos);
  EXPECT_EQ(embed_meshes(urdf, {}), urdf);
  EXPECT_EQ(embed_meshes("no URDF", {{"a", "b"}}), "no URDF");
}

}  // namespace
}  // namespace snug::robot
