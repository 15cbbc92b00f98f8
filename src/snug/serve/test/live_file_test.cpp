// Tests of LiveFile: whole server-sent events at any time, the same bytes for the same run, and an end.
#include "snug/serve/live_file.hpp"

#include <gtest/gtest.h>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/test/scratch_folder.hpp"

namespace snug::serve {
namespace {

record::RecordingHeader header_of_a_box() {
  record::RecordingHeader header;
  header.record_period = 0.008;
  header.bodies.resize(2);
  header.bodies[0].name = "table";
  header.bodies[0].kind = record::BodyKind::Static;
  header.bodies[1].name = "BOX001";
  return header;
}

record::Frame frame_of_a_box(int i) {
  record::Frame frame;
  frame.time = 0.008 * i;
  frame.step = 8 * i;
  frame.bodies.resize(2);
  frame.bodies[1].X_WB.p.x() = 0.01 * i;
  return frame;
}

/// Names of the whole events of a file; what is broken off is no event.
std::vector<std::string> events_of(const std::filesystem::path& path) {
  const std::string text = read_file(path, "a file");
  std::vector<std::string> names;
  for (std::size_t at = 0, end = 0; (end = text.find("\n\n", at)) != std::string::npos; at = end + 2) {
    const std::string one = text.substr(at, end - at);
    EXPECT_TRUE(one.starts_with("event: ")) << one.substr(0, 40);
    EXPECT_NE(one.find("\ndata: "), std::string::npos);
    names.push_back(one.substr(7, one.find('\n') - 7));
  }
  EXPECT_TRUE(text.empty() || text.ends_with("\n\n"));
  return names;
}

TEST(LiveFile, HasWholeEventsWhileTheRunGoesOn) {
  const test::ScratchFolder scratch;
  LiveFile live(scratch / "run.live", "run");
  EXPECT_TRUE(events_of(scratch / "run.live").empty());
  live.begin(header_of_a_box());
  std::size_t last = 0;
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(live.add(frame_of_a_box(i)));
    const std::vector<std::string> events = events_of(scratch / "run.live");
    ASSERT_GE(events.size(), std::max<std::size_t>(last, 1));
    EXPECT_EQ(events.front(), "header");
    last = events.size();
  }
  // 25 of 100 frames, sixteen at a time: the last nine are written at the end.
  EXPECT_EQ(last, 2U);
  live.finish();
  live.finish();
  EXPECT_EQ(events_of(scratch / "run.live"), (std::vector<std::string>{"header", "frames", "frames", "end"}));
}

TEST(LiveFile, HasTheSameBytesForTheSameRun) {
  const test::ScratchFolder scratch;
  for (const char* name : {"a.live", "b.live"}) {
    LiveFile live(scratch / name, "run");
    live.begin(header_of_a_box());
    for (int i = 0; i < 50; ++i) {
      if (i % 7 == 0) live.add(record::Event{0.008 * i, "seal", "BOX001", "sealed", {}});
      (void)live.add(frame_of_a_box(i));
    }
    live.finish();
  }
  EXPECT_EQ(read_file(scratch / "a.live", "a file"), read_file(scratch / "b.live", "a file"));
}

TEST(LiveFile, IsRefusedWhereItCannotBeWritten) {
  const test::ScratchFolder scratch;
  EXPECT_THROW(LiveFile(scratch / "none/run.live", "run"), InputError);
}

}  // namespace
}  // namespace snug::serve
