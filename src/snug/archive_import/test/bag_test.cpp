// Messages of bags become sources: order of joints, frames through their tree, clocks of their own, and slips.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "mutants.hpp"
#include "refusals.hpp"
#include "snug/archive_import/internal/readers.hpp"
#include "snug/core/test/scratch_folder.hpp"

namespace snug::archive_import::internal {
namespace {

using test::expect_refusal;

TEST(Bag, JointsOfAUrStandFromBaseToTool) {
  const std::string names =
      R"(["elbow_joint","shoulder_lift_joint","shoulder_pan_joint","wrist_1_joint","wrist_2_joint","wrist_3_joint"])";
  const std::string text = R"(["joints","/joint_states",1000000000,)" + names +
                           ",[3,2,1,4,5,6],[30,20,10,40,50,null],[]]\n" + R"(["joints","/joint_states",1000000000,)" +
                           names + ",[3,2,1,4,5,6],[],[]]\n" + R"(["joints","/joint_states",2000000000,)" + names +
                           ",[3,2,1,4,5,6],[],[]]\n";
  const record::RobotLog robot = read_bag_lines(text, "bag", {}).recording.robot;
  EXPECT_EQ(robot.times, (std::vector<double>{1.0, 2.0}));
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(robot.columns[i][0], static_cast<double>(i + 1));
  EXPECT_EQ(robot.names[6], "actual_qd_0");
  EXPECT_EQ(robot.columns[6][0], 10.0);
  EXPECT_TRUE(std::isnan(robot.columns[11][0]));
}

/// A crate on a turntable, which turns by 90 degrees in a second: the crate's messages come between those of the table.
std::string turntable() {
  return R"(["transform","/tf_static",0,"world","base",[1,0,0,0,0,0,1]]
["transform","/tf",1000000000,"base","table",[0,0,0,0,0,0,1]]
["transform","/tf",1500000000,"table","crate",[1,0,0,0,0,0,1]]
["transform","/tf",2000000000,"base","table",[0,0,0,0,0,0.7071067811865476,0.7071067811865476]]
["transform","/tf",2000000000,"table","crate",[1,0,0,0,0,0,1]]
)";
}

TEST(Bag, FramesAreFollowedToTheRootAtTheirOwnTimes) {
  const Imported imported = read_bag_lines(turntable(), "bag", {});
  const record::MotionCaptureLog& log = imported.recording.motion_capture;
  ASSERT_EQ(log.bodies.size(), 2U);
  EXPECT_EQ(log.bodies[0].name, "crate");
  const double c = std::sqrt(0.5);  // half of the quarter turn, by the shortest arc
  EXPECT_LT((log.bodies[0].poses[0].p - Vector3(1.0 + c, c, 0)).norm(), 1e-12) << "the base is 1 m off";
  Hints hints;
  hints.fixed_frame = "base";
  hints.tool = "table";
  const auto in_base = read_bag_lines(turntable(), "bag", hints).recording;
  EXPECT_LT((in_base.motion_capture.bodies.at(0).poses.at(0).p - Vector3(c, c, 0)).norm(), 1e-12);
  EXPECT_LT((in_base.motion_capture.bodies.at(0).poses.at(1).p - Vector3(0, 1, 0)).norm(), 1e-12);
  EXPECT_EQ(in_base.robot.tool.size(), 2U);
}

TEST(Bag, PosesOnClocksOfTheirOwnMeetOnTheFastest) {
  std::string text;
  for (int i = 0; i <= 8; ++i)
    text += fmt::format(R"(["pose","/mocap/box1/pose",{},"map",[{},0,0,0,0,0,1]])"
                        "\n",
                        100'000'000LL * i, 0.1 * i);
  for (int i = 0; i <= 4; ++i)
    text += fmt::format(R"(["pose","/mocap/box2/pose",{},"map",[0,{},0,0,0,0,1]])"
                        "\n",
                        150'000'000LL * i + 50'000'000LL, 1.0 * i);
  const record::MotionCaptureLog log = read_bag_lines(text, "bag", {}).recording.motion_capture;
  ASSERT_EQ(log.bodies.size(), 2U);
  EXPECT_EQ(log.times.size(), 9U);
  EXPECT_EQ(log.bodies[1].name, "box2");
  EXPECT_FALSE(record::is_tracked(log.bodies[1].poses[0]));
  EXPECT_NEAR(log.bodies[1].poses[1].p.y(), 1.0 / 3.0, 1e-9);
  EXPECT_FALSE(record::is_tracked(log.bodies[1].poses[8]));
}

TEST(Bag, SlipsAreRefusedByMessage) {
  const std::string wrench = R"(["wrench","/a",1000000000,"tool0",[0,0,-9,0,0,0]]
["wrench","/a",2000000000,"tool0",[0,0,-9,0,0,0]]
)";
  const struct {
    std::string text, part;
  } slips[] = {
      {"", "no two messages"},
      {"[\"left\",\"/camera\",\"sensor_msgs/msg/Image\"]\n", "/camera (sensor_msgs/msg/Image)"},
      {"x\n", "message 1"},
      {R"(["pose","/p",1,"map",[1,2]])", "seven numbers"},
      {R"(["pose","/p",1,"map",[0,0,0,0,0,0,0.5]])", "length 0.5"},
      {R"(["pose","/p",1,"map",[1e9,0,0,0,0,0,1]])", "1 km"},
      {wrench +
           R"(["wrench","/b",1000000000,"t",[0,0,0,0,0,0]])"
           "\n" +
           R"(["wrench","/b",2000000000,"t",[0,0,0,0,0,0]])",
       "--wrench"},
      {R"(["transform","/tf",1,"a","b",[0,0,0,0,0,0,1]])"
       "\n"
       R"(["transform","/tf",2,"b","a",[0,0,0,0,0,0,1]])",
       "no two messages"},
      {turntable() +
           R"(["transform","/tf",1,"moon","cat",[0,0,0,0,0,0,1]])"
           "\n" +
           R"(["transform","/tf",2,"moon","cat",[0,0,0,0,0,0,1]])",
       "--fixed-frame"},
  };
  for (const auto& slip : slips) {
    SCOPED_TRACE(slip.part);
    expect_refusal([&] { return read_bag_lines(slip.text, "bag", {}); }, slip.part);
  }
  Hints hints;
  hints.tool = "tabel";
  expect_refusal([&] { return read_bag_lines(turntable(), "bag", hints); }, "'table'");
}

TEST(Bag, LinesThatWereChangedAreReadOrRefused) {
  const std::string joints = R"(["joints","/joint_states",1000000000,["a","b"],[1,2],[3,null],[]])";
  const std::string seed = joints + "\n" + turntable() + R"(["pose","/p/pose",5,"map",[0,0,0,0,0,0,1]])" + "\n" +
                           R"(["wrench","/w",5,"t",[0,0,0,0,0,1]])" + "\n" + R"(["left","/c","d"])" + "\n";
  const std::vector<std::string> words = {"1e999", "-1",   "null", "[",   "]", "\"", ",", "99999999999999999999",
                                          "\n",    "\xff", "{}",   "true"};
  EXPECT_GT(
      test::expect_answers(seed, words, 3000, [](const std::string& text) { (void)read_bag_lines(text, "bag", {}); }),
      0);
}

TEST(Bag, WhatIsLeftOutIsSaidByKind) {
  std::string text = turntable();
  for (int i = 0; i < 9; ++i) text += fmt::format("[\"left\",\"/camera_{}/image_raw\",\"sensor_msgs/Image\"]\n", i);
  text += "[\"left\",\"/rosout\",\"rosgraph_msgs/Log\"]\n";
  const auto remarks = read_bag_lines(text, "bag", {}).remarks;
  EXPECT_EQ(remarks.back(), "left out: rosgraph_msgs/Log, 9 of sensor_msgs/Image");
}

TEST(Bag, WhatTheProgramSaysIsSaid) {
  const std::string text =
      turntable() + R"(["said","read from take.mcap: the folder has no metadata.yaml that names it",""])" + "\n";
  EXPECT_EQ(read_bag_lines(text, "bag", {}).remarks.front(),
            "read from take.mcap: the folder has no metadata.yaml that names it");
}

TEST(Bag, FramesOfPosesAreSaid) {
  const std::string one = R"(["pose","/a/pose",1000000000,"map",[0,0,0,0,0,0,1]]
["pose","/a/pose",2000000000,"map",[0,0,0,0,0,0,1]]
)";
  EXPECT_EQ(read_bag_lines(one, "bag", {}).remarks.back(), "poses of topics are in 'map'");
  const std::string two = R"(["pose","/b/pose",1000000000,"world",[0,0,0,0,0,0,1]]
["pose","/b/pose",2000000000,"world",[0,0,0,0,0,0,1]]
)";
  EXPECT_EQ(read_bag_lines(one + two, "bag", {}).remarks.back(),
            "poses of topics are in 'map' (/a/pose), 'world' (/b/pose): they stay so");
}

TEST(Bag, PosesWithoutARotationAreLost) {
  std::string text;
  for (int i = 0; i < 5; ++i)
    text += fmt::format(R"(["pose","/a/pose",{},"",[{},0,0,0,0,0,{}]])"
                        "\n",
                        1'000'000'000LL + 100'000'000LL * i, i, i == 2 ? 0 : 1);
  const Imported imported = read_bag_lines(text, "bag", {});
  EXPECT_EQ(imported.recording.motion_capture.times.size(), 4U);
  EXPECT_EQ(imported.remarks, (std::vector<std::string>{"poses whose quaternion is (0, 0, 0, 0) count as lost: 1"}));
}

TEST(Bag, APythonWithoutReadersIsToldWhatToInstall) {
  const snug::test::ScratchFolder folder;
  std::ofstream(folder / "run.mcap") << "no MCAP";
  std::ofstream(folder / "python") << "#!/bin/sh\necho mcap >&2\nexit 3\n";
  std::filesystem::permissions(folder / "python", std::filesystem::perms::owner_all);
  const char* const before = std::getenv("SNUG_PYTHON");
  const std::string old = before == nullptr ? "" : before;
  ::setenv("SNUG_PYTHON", (folder / "python").c_str(), 1);
  expect_refusal([&] { return load_bag(folder / "run.mcap", {}); }, "pip install mcap;");
  ::setenv("SNUG_PYTHON", (folder / "nowhere").c_str(), 1);
  expect_refusal([&] { return load_bag(folder / "run.mcap", {}); }, "cannot be started");
  ::unsetenv("SNUG_PYTHON");
  if (!old.empty()) ::setenv("SNUG_PYTHON", old.c_str(), 1);
  expect_refusal([&] { return load_bag(folder / "none.mcap", {}); }, "no such file");
}

}  // namespace
}  // namespace snug::archive_import::internal
