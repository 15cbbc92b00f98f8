// Logs of mc_rtc become recordings, and recordings tables that read back.
#include "snug/validation/log_table.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "scene.hpp"
#include "snug/core/input_error.hpp"
#include "snug/validation/measure.hpp"

namespace snug::validation {
namespace {

using test::ScratchFolder;

constexpr const char* kNames =
    "t;box013_FloatingBase_orientation_w;box013_FloatingBase_orientation_x;box013_FloatingBase_orientation_y;"
    "box013_FloatingBase_orientation_z;box013_FloatingBase_position_x;box013_FloatingBase_position_y;"
    "box013_FloatingBase_position_z;UR10FTSensor_cx;UR10FTSensor_cy;UR10FTSensor_cz;UR10FTSensor_fx;UR10FTSensor_fy;"
    "UR10FTSensor_fz;other\n";

record::ArchiveRecording read(const std::string& text) {
  const ScratchFolder folder;
  std::ofstream(folder / "log.csv", std::ios::binary) << text;
  return load_log(folder / "log.csv");
}

TEST(LogTable, ReadsInverseRotationsAndCouplesBeforeForces) {
  const record::ArchiveRecording recording = read(std::string(kNames) +
                                                  "0.0;0.8;0;0;0.6;1;2;3;0.1;0.2;0.3;10;20;30;x\n"
                                                  "0.1;;;;;;;;0.1;0.2;0.3;11;20;30;\n");
  ASSERT_EQ(recording.motion_capture.bodies.size(), 1U);
  EXPECT_EQ(recording.motion_capture.bodies[0].name, "Box013");
  const auto& poses = recording.motion_capture.bodies[0].poses;
  EXPECT_NEAR(poses[0].quat.z(), -0.6, 1e-12);
  EXPECT_EQ(poses[0].p, Vector3(1.0, 2.0, 3.0));
  EXPECT_FALSE(record::is_tracked(poses[1]));
  EXPECT_EQ(recording.force_torque.wrenches[1].force, Vector3(11.0, 20.0, 30.0));
  EXPECT_EQ(recording.force_torque.wrenches[1].torque, Vector3(0.1, 0.2, 0.3));
  EXPECT_EQ(recording.name, "log");
}

TEST(LogTable, SlipsAreRefusedWithLineAndColumn) {
  const std::string good = "0.0;1;0;0;0;1;2;3;0.1;0.2;0.3;10;20;30;\n";
  const struct {
    std::string text, part;
  } slips[] = {
      {"", "empty"},
      {std::string(kNames) + "0.0;\xe9\n", "log.csv:2: got the byte 0x"},
      {"t" + std::string(10000, ';') + "\n1\n", "log.csv:1: got 10001 columns"},
      {"x;y\n1;2\n", "log.csv:1: t"},
      {"t;q\n1;2\n", "no pose and no wrench"},
      {std::string(kNames) + good + "0.0;1;0;0;0;1;2;3;0.1;0.2;0.3;10;20;30;\n", "log.csv:3: t"},
      {std::string(kNames) + good + "0.1;1;0;0;0;1;2\n", "log.csv:3: got 7 cells"},
      {std::string(kNames) + good + "0.1;1;0;0;0.5;1;2;3;0.1;0.2;0.3;10;20;30;\n", "length 1"},
      {std::string(kNames) + good + "0.1;1;0;0;0;1;;3;0.1;0.2;0.3;10;20;30;\n", "some of a pose"},
      {std::string(kNames) + good + "0.1;1;0;0;0;1;a;3;0.1;0.2;0.3;10;20;30;\n", "'a'"},
      {std::string(kNames) + good + "0.1;1;0;0;0;1;2;3;0.1;0.2;0.3;;20;30;\n", "UR10FTSensor"},
      {std::string(kNames) + good + ";1;0;0;0;1;2;3;0.1;0.2;0.3;10;20;30;\n", "log.csv:3: t"},
      {std::string(kNames) + good, "1 rows"},
      {"t;box013_FloatingBase_position_x\n0;1\n1;1\n", "orientation_w"},
      {"t;t;UR10FTSensor_fx\n0;1\n1;1\n", "twice"},
  };
  for (const auto& slip : slips) {
    SCOPED_TRACE(slip.text.substr(0, 60));
    try {
      (void)read(slip.text);
      ADD_FAILURE() << "was read";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(slip.part), std::string::npos) << error.what();
    }
  }
}

TEST(LogTable, TablesOfARecordingReadBack) {
  const ScratchFolder folder;
  const record::ArchiveRecording recording = measure(test::example_run(), {}, {}).recording;
  const auto files = save_tables(recording, folder / ".");
  ASSERT_EQ(files.size(), 3U);
  const record::ArchiveRecording poses = load_log(files[0]);
  ASSERT_EQ(poses.motion_capture.bodies.size(), recording.motion_capture.bodies.size());
  EXPECT_EQ(poses.motion_capture.times, recording.motion_capture.times);
  for (std::size_t b = 0; b < poses.motion_capture.bodies.size(); ++b) {
    const auto &a = poses.motion_capture.bodies[b], &c = recording.motion_capture.bodies[b];
    EXPECT_EQ(a.name, c.name);
    for (std::size_t i = 0; i < a.poses.size(); i += 100) {
      ASSERT_EQ(record::is_tracked(a.poses[i]), record::is_tracked(c.poses[i]));
      if (record::is_tracked(a.poses[i])) {
        EXPECT_LT((a.poses[i].p - c.poses[i].p).norm(), 1e-12);
      }
    }
  }
  EXPECT_EQ(load_log(files[1]).force_torque.wrenches, recording.force_torque.wrenches);
}

}  // namespace
}  // namespace snug::validation
