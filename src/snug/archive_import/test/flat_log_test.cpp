// Flat logs of mc_rtc: bodies, forces, joints, `nan`, and what is cut.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "refusals.hpp"
#include "snug/archive_import/internal/readers.hpp"

namespace snug::archive_import::internal {
namespace {

using test::expect_refusal;

std::string size_of(std::uint64_t size) { return {reinterpret_cast<const char*>(&size), 8}; }

std::string entry(const std::string& name, const std::vector<double>& values) {
  return std::string(1, '\1') + size_of(name.size()) + name + size_of(values.size()) +
         std::string(reinterpret_cast<const char*>(values.data()), 8 * values.size());
}
std::string texts(const std::string& name, const std::vector<std::string>& values) {
  std::string bytes = std::string(1, '\0') + size_of(name.size()) + name + size_of(values.size());
  for (const std::string& value : values) bytes += size_of(value.size()) + value;
  return bytes;
}
std::string flat(const std::vector<std::string>& entries) {
  std::string bytes = size_of(entries.size());
  for (const std::string& one : entries) bytes += one;
  return bytes;
}

const double kNothing = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> small_log() {
  return {entry("t", {0.0, 0.005, 0.01}),
          texts("state", {"Pick", "", "Place"}),
          entry("box013_FloatingBase_orientation_w", {0.8, kNothing, 1.0}),
          entry("box013_FloatingBase_orientation_x", {0.0, kNothing, 0.0}),
          entry("box013_FloatingBase_orientation_y", {0.0, kNothing, 0.0}),
          entry("box013_FloatingBase_orientation_z", {0.6, kNothing, 0.0}),
          entry("box013_FloatingBase_position_x", {1.0, kNothing, 1.5}),
          entry("box013_FloatingBase_position_y", {2.0, kNothing, 2.5}),
          entry("box013_FloatingBase_position_z", {3.0, kNothing, 3.5}),
          entry("LeftFoot_cx", {0.1, kNothing, 0.3}),
          entry("LeftFoot_cy", {0.0, kNothing, 0.0}),
          entry("LeftFoot_cz", {0.0, kNothing, 0.0}),
          entry("LeftFoot_fx", {10.0, kNothing, 30.0}),
          entry("LeftFoot_fy", {0.0, kNothing, 0.0}),
          entry("LeftFoot_fz", {0.0, kNothing, 0.0}),
          entry("qIn_0", {0.5, kNothing, 0.7}),
          entry("qIn_1", {-0.5, -0.6, -0.7})};
}

TEST(FlatLog, ReadsBodiesForcesAndJointsPastNan) {
  const record::ArchiveRecording recording = read_flat_log(flat(small_log()), "log.flat", {}).recording;
  const auto& body = recording.motion_capture.bodies.at(0);
  EXPECT_EQ(body.name, "Box013");
  EXPECT_NEAR(body.poses[0].quat.z(), -0.6, 1e-12) << "mc_rtc maps the world to the body";
  EXPECT_FALSE(record::is_tracked(body.poses[1]));
  EXPECT_EQ(body.poses[2].p, Vector3(1.5, 2.5, 3.5));
  EXPECT_EQ(recording.force_torque.times, (std::vector<double>{0.0, 0.01}));
  EXPECT_EQ(recording.force_torque.wrenches[1].torque.x(), 0.3);
  EXPECT_EQ(recording.robot.names, (std::vector<std::string>{"actual_q_0", "actual_q_1"}));
  EXPECT_EQ(recording.robot.columns[1][2], -0.7);
}

TEST(FlatLog, TransformsOfOtherRobotsAreBodies) {
  std::vector<std::string> entries = {entry("t", {0.0, 1.0})};
  for (const char* ending : {"qw", "qx", "qy", "qz", "tx", "ty", "tz"})
    for (const char* robot : {"ff_", "crate_ff_"})  // the first is the main robot's own
      entries.push_back(entry(std::string(robot) + ending,
                              {ending == std::string("qw") ? 1.0 : 0.0, ending == std::string("qw") ? 1.0 : 0.0}));
  const record::ArchiveRecording recording = read_flat_log(flat(entries), "log.flat", {}).recording;
  ASSERT_EQ(recording.motion_capture.bodies.size(), 1U);
  EXPECT_EQ(recording.motion_capture.bodies[0].name, "crate");
}

TEST(FlatLog, EveryCutIsRefused) {
  const std::string whole = flat(small_log());
  for (std::size_t size = 0; size < whole.size(); size += size < 400 ? 1 : 17) {
    SCOPED_TRACE(size);
    EXPECT_THROW((void)read_flat_log(whole.substr(0, size), "log.flat", {}), InputError);
  }
  expect_refusal([&] { return read_flat_log(whole + "x", "log.flat", {}); }, "behind the last entry");
  expect_refusal([&] { return read_flat_log(size_of(~0ULL) + whole, "log.flat", {}); }, "entries");
  expect_refusal(
      [&] {
        return read_flat_log(flat({entry("t", {0, 1}), std::string("\1", 1) + size_of(1) + "x" + size_of(1ULL << 61)}),
                             "log.flat", {});
      },
      "an end after");
}

TEST(FlatLog, SlipsAreRefusedByEntry) {
  expect_refusal([] { return read_flat_log(flat({entry("x", {0, 1})}), "log.flat", {}); }, "'t'");
  expect_refusal(
      [] {
        return read_flat_log(flat({entry("t", {0, 0}), entry("qIn_0", {0, 0})}), "log.flat", {});
      },
      "times that grow");
  expect_refusal(
      [] {
        return read_flat_log(flat({entry("t", {0, 1}), entry("qIn_0", {0})}), "log.flat", {});
      },
      "qIn_0");
  expect_refusal([] { return read_flat_log(flat({entry("t", {0, 1}), entry("t", {0, 1})}), "log.flat", {}); }, "twice");
  expect_refusal(
      [] {
        return read_flat_log(flat({entry("t", {0, 1}), entry("gain", {0, 1})}), "log.flat", {});
      },
      "no pose");
  expect_refusal(
      [] {
        return read_flat_log(flat({entry("t", {0, 1}), entry("b_FloatingBase_orientation_w", {1, 1})}), "log.flat", {});
      },
      "all seven");
  Hints hints;
  hints.wrench = "LeftFut";
  expect_refusal([&] { return read_flat_log(flat(small_log()), "log.flat", hints); }, "LeftFoot");
}

}  // namespace
}  // namespace snug::archive_import::internal
