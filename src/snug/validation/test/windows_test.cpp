// Windows in which boxes are compared: from events in closed form, and from files as people and spreadsheets write
// them.
#include <gtest/gtest.h>

#include <fstream>

#include "scene.hpp"
#include "snug/core/input_error.hpp"
#include "snug/record/archive.hpp"
#include "snug/validation/measurement.hpp"
#include "snug/validation/validate.hpp"

namespace snug::validation {
namespace {

/// A run of 100 s at 10 Hz with boxes that are there all along, and no events yet.
SimulatedRun quiet_run(const std::vector<std::string>& boxes) {
  SimulatedRun run;
  run.header.sequence = "small";
  for (const std::string& box : boxes) {
    run.header.bodies.push_back({box, "B1", record::BodyKind::Dynamic, 1.0, {}, {}});
    run.bodies.emplace_back();
  }
  for (int i = 0; i <= 1000; ++i) {
    run.times.push_back(0.1 * i);
    for (auto& track : run.bodies) track.emplace_back(Pose{});
  }
  return run;
}

void hold(SimulatedRun& run, const std::string& box, double from, double to, const char* seal = "seal",
          const char* end = "release") {
  run.events.push_back({from, seal, box, "", {}});
  run.events.push_back({to, end, box, "", {}});
}

TEST(FindWindows, AreFromASecondBeforeABoxIsHeldToTwoAfterItIsReleased) {
  SimulatedRun run = quiet_run({"A"});
  hold(run, "A", 20.0, 30.0);
  EXPECT_EQ(find_windows(run), (std::vector<Window>{{"A", 19.0, 32.0}}));
  hold(run, "A", 40.0, 45.0, "repick", "lost");  // set down and taken again: one window
  EXPECT_EQ(find_windows(run), (std::vector<Window>{{"A", 19.0, 47.0}}));
}

TEST(FindWindows, StayWithinTheRun) {
  SimulatedRun run = quiet_run({"A", "B"});
  hold(run, "A", 0.5, 10.0);
  run.events.push_back({95.0, "seal", "B", "", {}});  // never released
  const std::vector<Window> windows = find_windows(run);
  EXPECT_EQ(windows[0], (Window{"A", 0.0, 12.0}));
  EXPECT_EQ(windows[1].start, 94.0);
  EXPECT_NEAR(windows[1].end, 100.0, 1e-9);
}

TEST(FindWindows, EndBeforeTheNextBoxArrives) {
  SimulatedRun run = quiet_run({"A", "B"});
  hold(run, "A", 10.0, 20.0);
  hold(run, "B", 21.5, 30.0);
  EXPECT_EQ(find_windows(run), (std::vector<Window>{{"A", 9.0, 20.5}, {"B", 20.5, 32.0}}));
}

TEST(FindWindows, OfTwoBoxesTakenTogetherAreWhole) {
  // Two cups: a window is not cut to nothing because another box is held at nearly the same time.
  SimulatedRun run = quiet_run({"A", "B"});
  hold(run, "A", 10.0, 20.0);
  hold(run, "B", 10.5, 21.0);
  EXPECT_EQ(find_windows(run), (std::vector<Window>{{"A", 9.0, 22.0}, {"B", 9.5, 23.0}}));
}

TEST(FindWindows, OfABoxThatIsNeverHeldAreWhileItIsThere) {
  SimulatedRun run = quiet_run({"A", "B"});
  for (std::size_t i = 0; i < 300; ++i) run.bodies[1][i] = record::lost_pose();
  for (std::size_t i = 700; i <= 1000; ++i) run.bodies[1][i] = record::lost_pose();
  for (std::size_t i = 0; i <= 1000; ++i) run.bodies[0][i] = record::lost_pose();  // never there
  const std::vector<Window> windows = find_windows(run);
  ASSERT_EQ(windows.size(), 1U);
  EXPECT_EQ(windows[0].body, "B");
  EXPECT_NEAR(windows[0].start, 30.0, 1e-9);
  EXPECT_NEAR(windows[0].end, 69.9, 1e-9);
}

TEST(FindWindows, AreInTheOrderOfPackingWhateverTheOrderOfTheBodies) {
  SimulatedRun run = quiet_run({"A", "B", "C"});
  hold(run, "C", 10.0, 15.0);
  hold(run, "A", 30.0, 35.0);
  hold(run, "B", 50.0, 55.0);
  const std::vector<Window> windows = find_windows(run);
  ASSERT_EQ(windows.size(), 3U);
  EXPECT_EQ(windows[0].body, "C");
  EXPECT_EQ(windows[1].body, "A");
  EXPECT_EQ(windows[2].body, "B");
}

TEST(FindWindows, CountASealThatFollowsASealOnce) {
  SimulatedRun run = quiet_run({"A"});
  run.events.push_back({20.0, "seal", "A", "", {}});
  run.events.push_back({22.0, "reseal", "A", "", {}});
  run.events.push_back({25.0, "release", "A", "", {}});
  run.events.push_back({40.0, "release", "A", "", {}});  // of nothing
  EXPECT_EQ(find_windows(run), (std::vector<Window>{{"A", 19.0, 27.0}}));
}

std::vector<Window> read_windows(const std::string& text) {
  const test::ScratchFolder folder;
  std::ofstream(folder / "w.csv", std::ios::binary) << text;
  return load_windows(folder / "w.csv", test::example_run());
}

TEST(LoadWindows, AreReadAsSpreadsheetsWriteThem) {
  const std::vector<Window> expected = {{"BOX013", 1.0, 2.5}, {"BOX030", 3.0, 4.0}};
  EXPECT_EQ(read_windows("body,start_s,end_s\nBox013,1,2.5\nBOX030,3,4\n"), expected);
  EXPECT_EQ(read_windows("\xef\xbb\xbf"
                         "body,start_s,end_s\r\nBox013,1,2.5\r\n\r\nBox030,3,4\r\n"),
            expected);
  EXPECT_EQ(read_windows("end_s, body, start_s\n 2.5, box013, 1\n# a remark, with a comma\n4, Box030, 3"), expected);
}

TEST(LoadWindows, OfAnotherSequenceAreNotReadButTheirRowsAreWhole) {
  EXPECT_EQ(read_windows("sequence,body,start_s,end_s\nlarge,Box099,x,y\nsmall,Box013,1,2\n").size(), 1U);
  EXPECT_THROW((void)read_windows("sequence,body,start_s,end_s\nlarge,Box099\nsmall,Box013,1,2\n"), InputError);
  EXPECT_THROW((void)read_windows("sequence,body,start_s,end_s\nlarge,Box013,1,2\n"), InputError);
}

TEST(LoadWindows, AreOfFiniteTimesThatGrow) {
  for (const char* row : {"Box013,nan,2", "Box013,1,inf", "Box013,1,1", "Box013,1,2s", "Box013,,2", "Box013,0x1,2"})
    EXPECT_THROW((void)read_windows(std::string("body,start_s,end_s\n") + row + "\n"), InputError) << row;
}

TEST(HandShifts, AreReadBySourceAndNamedWhereTheyAreNot) {
  const HandShifts shifts = parse_hand_shifts({"mocap=0.35", "robot=-2"});
  EXPECT_EQ(shifts.motion_capture, 0.35);
  EXPECT_EQ(shifts.robot, -2.0);
  EXPECT_FALSE(shifts.force_torque.has_value());
  for (const char* word : {"mocap", "mocap=", "mocap=x", "mocap=nan", "mocap=1 ", "=1", "all=1"})
    EXPECT_THROW((void)parse_hand_shifts({word}), InputError) << word;
}

}  // namespace
}  // namespace snug::validation
