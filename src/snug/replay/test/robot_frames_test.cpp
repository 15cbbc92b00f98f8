// RobotFrames: links hang on each other as the URDF says, and stand where the recording's bodies do.
#include "snug/replay/internal/robot_frames.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace snug::replay::internal {
namespace {

constexpr const char* kUrdf =
    "<robot name='r'><link name='base'/><link name='arm'/><link name='E'/><link name='S'/>"
    "<joint name='turn' type='revolute'><parent link='base'/><child link='arm'/><origin xyz='0 0 1'/>"
    "<axis xyz='0 0 1'/></joint>"
    "<joint name='end' type='fixed'><parent link='arm'/><child link='E'/><origin xyz='1 0 0'/></joint>"
    "<joint name='cup' type='fixed'><parent link='E'/><child link='S'/></joint></robot>";

record::RecordingHeader make_header(const std::string& body = "robot/arm") {
  record::RecordingHeader header;
  header.bodies.push_back({body, "", record::BodyKind::Kinematic, 0.0, Vector3::Zero(), {}});
  header.joints = {"turn"};
  return header;
}

/// The base stands at (5, 0, 0), its joint is at q.
record::Frame make_frame(double q) {
  record::Frame frame;
  frame.joints.resize(1);
  frame.joints[0].position = q;
  frame.bodies.resize(1);
  frame.bodies[0].X_WB = Pose{exp_rotation(q * Vector3::UnitZ()), {5.0, 0.0, 1.0}};
  frame.X_WE = Pose{exp_rotation(q * Vector3::UnitZ()), {5.0 + std::cos(q), std::sin(q), 1.0}};
  return frame;
}

TEST(RobotFrames, StandWhereTheBodiesDoAndTurnWithTheJoints) {
  const RobotFrames frames(make_header(), kUrdf, make_frame(0.7));
  const auto still = frames.still();
  ASSERT_EQ(still.size(), 2U);
  EXPECT_EQ(still[0].parent, "W");
  EXPECT_EQ(still[0].child, "base");
  EXPECT_LT((still[0].X_PC.p - Vector3(5.0, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_EQ(still[1].child, "E");  // which is where the tool is
  const auto moving = frames.moving(make_frame(std::numbers::pi / 2));
  ASSERT_EQ(moving.size(), 1U);
  EXPECT_EQ(moving[0].parent, "base");
  EXPECT_LT((moving[0].X_PC.pose() * Vector3::UnitX() - Vector3(0.0, 1.0, 1.0)).norm(), 1e-12);
}

TEST(RobotFrames, LeaveOutWhatIsCalledLikeSomethingElse) {
  const RobotFrames frames(make_header(), kUrdf, make_frame(0.7));
  EXPECT_FALSE(frames.has("S"));
  EXPECT_TRUE(frames.has("E"));
  record::Frame elsewhere = make_frame(0.7);
  elsewhere.X_WE.p.x() += 0.1;
  EXPECT_FALSE(RobotFrames(make_header(), kUrdf, elsewhere).has("E"));
  record::RecordingHeader header = make_header();
  header.bodies.push_back({"E", "", record::BodyKind::Dynamic, 1.0, Vector3::Zero(), {}});
  record::Frame two = make_frame(0.7);
  two.bodies.resize(2);
  EXPECT_FALSE(RobotFrames(header, kUrdf, two).has("E"));
}

TEST(RobotFrames, AreNoneWhereNothingTellsWhereTheRobotStands) {
  EXPECT_TRUE(RobotFrames(make_header("robot/other"), kUrdf, make_frame(0.0)).still().empty());
  EXPECT_TRUE(RobotFrames(make_header(), "", make_frame(0.0)).still().empty());
  EXPECT_TRUE(RobotFrames().moving(make_frame(0.0)).empty());
}

}  // namespace
}  // namespace snug::replay::internal
