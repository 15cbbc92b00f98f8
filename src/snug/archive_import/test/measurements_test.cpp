// Several files become one recording, which an archive takes and gives back.
#include "snug/archive_import/measurements.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "refusals.hpp"
#include "snug/core/test/scratch_folder.hpp"

namespace snug::archive_import {
namespace {

using test::expect_refusal;
using ScratchFolder = snug::test::ScratchFolder;

constexpr const char* kTake =
    "Format Version,1.23,Rotation Type,Quaternion,Length Units,Meters,Coordinate Space,Global\n"
    ",Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body\n"
    ",Name,One,One,One,One,One,One,One\n"
    ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position\n"
    "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z\n"
    "0,0,0,0,0,1,1,2,3\n1,0.01,,,,,,,\n2,0.02,0,0,0,1,1,2,3\n";
constexpr const char* kRobot = "timestamp,actual_q_0\n1742159332.5,1\n1742159332.6,2\n";

TEST(Measurements, CaptureAndRobotBecomeOneRecordingThatAnArchiveKeeps) {
  const ScratchFolder folder;
  std::ofstream(folder / "take.csv") << kTake;
  std::ofstream(folder / "robot.csv") << kRobot;
  Hints hints;
  hints.names = {{"One", "Box013"}};
  Imported imported = load_all({folder / "take.csv", folder / "robot.csv"}, hints);
  EXPECT_EQ(imported.recording.name, "take");
  EXPECT_EQ(imported.recording.motion_capture.bodies.at(0).name, "Box013");
  EXPECT_NEAR(imported.recording.robot.times[0], 0.5, 1e-6) << "clocks begin within their first second";
  EXPECT_EQ(record::find_remark(imported.recording, "begins"), "robot.csv at 1742159332 s");
  record::save_archive(OutputFile(folder / "one.h5"), {{imported.recording}});
  const record::ArchiveReader reader(folder / "one.h5");
  EXPECT_TRUE(reader.find_defects(0).empty());
  const record::ArchiveRecording back = reader.read(0);
  EXPECT_EQ(back.robot, imported.recording.robot);
  EXPECT_EQ(back.motion_capture.times, imported.recording.motion_capture.times);
  EXPECT_FALSE(record::is_tracked(back.motion_capture.bodies[0].poses[1]));
  expect_refusal([&] { return load_all({folder / "take.csv", folder / "take.csv"}, {}); }, "motion capture");
}

TEST(Measurements, WhatCannotBeReadIsNamed) {
  const ScratchFolder folder;
  const auto refuse = [&](const std::string& name, const std::string& bytes, const std::string& part) {
    SCOPED_TRACE(name);
    std::ofstream(folder / name, std::ios::binary) << bytes;
    EXPECT_TRUE(is_import(folder / name));
    expect_refusal([&] { return load(folder / name, {}); }, part);
  };
  refuse("log.bin", "ANNF\1\2", "mc_bin_to_flat log.bin");
  refuse("take.csv",
         "\xff\xfe"
         "F",
         "UTF-16");
  refuse("other.csv", "a,b\n1,2\n", "other.csv:1: t: got no such column: a table that begins with 'a', 'b'");
  refuse("numbers.csv", "0.0,-1.5,2e-3\n0.1,1,2\n", "numbers, no names of columns");
  refuse("early.csv", "comment,\"OptiTrack Export Data\"\ncomment,\"== \"\n", "before 1.2");
  refuse("rounded.csv", "t;a_FloatingBase_orientation_w\n", "no such column");
  refuse("untimed.csv", "actual_q_0,actual_q_1\n1,2\n", "--rate HZ");
  refuse("empty.csv", "", "empty");
  refuse("bytes.csv", "timestamp q\n\xe9", "bytes.csv:2");
  EXPECT_FALSE(is_import("archive.h5"));
  EXPECT_FALSE(is_import("archive.hdf5"));
}

TEST(Measurements, LogsOfMcRtcWithNanAreRead) {
  const ScratchFolder folder;
  std::ofstream(folder / "log.csv")
      << "t;UR10FTSensor_cx;UR10FTSensor_cy;UR10FTSensor_cz;UR10FTSensor_fx;UR10FTSensor_fy;"
         "UR10FTSensor_fz\n0;1;2;3;4;5;6\n1;nan;nan;nan;nan;nan;nan\n2;1;2;3;4;5;7\n";
  const record::WrenchLog log = load(folder / "log.csv", {}).recording.force_torque;
  EXPECT_EQ(log.times, (std::vector<double>{0.0, 2.0}));
  EXPECT_EQ(log.wrenches[1].force.z(), 7.0);
}

}  // namespace
}  // namespace snug::archive_import
