// SentProgram: the file beside a plant is whole after each motion, and says when it is complete.
#include "snug/plant/sent_program.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <limits>

#include "snug/core/test/scratch_folder.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/plant/test/kinematic_plant.hpp"
#include "snug/plant/wait.hpp"

namespace snug::plant {
namespace {

Motion to(double z) {
  Motion motion;
  motion.waypoints = {
      motion::make_waypoint(motion::MotionClass::Home, {}, {Matrix3::Identity(), Vector3(0.0, 0.0, z)})};
  return motion;
}

std::string content_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(SentProgram, HoldsWhatWasSentAfterEachStartAndSaysWhenThatIsAll) {
  const snug::test::ScratchFolder folder;
  const std::filesystem::path path = folder / "sent.csv";
  test::KinematicPlant plant;
  OutputFile file(path);
  SentProgram sent(plant, file, motion::FastTracking{0.8}, "ur10");
  motion::Program whole{"sent", {}, motion::FastTracking{0.8}, "ur10"};
  EXPECT_FALSE(std::filesystem::exists(path)) << "nothing was sent";
  for (int i = 1; i < 5; ++i) {
    const Motion motion = to(0.1 * i + 0.2);
    const double begun = plant.read().time;
    EXPECT_EQ(begun > 0.0, i > 1);
    sent.start(motion);
    whole.waypoints.push_back(motion.waypoints[0]);
    if (i > 1) whole.waypoints.back().not_before = motion::as_named(begun);
    EXPECT_EQ(content_of(path), kUnfinishedProgram + motion::format_program(whole));
    EXPECT_EQ(motion::load_program(path).waypoints.size(), whole.waypoints.size()) << "it is read as any other";
    while (sent.is_moving()) (void)sent.advance();
  }
  Motion nowhere = to(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(run(sent, nowhere).end.reason, EndReason::Refused);
  sent.finish();
  EXPECT_EQ(content_of(path), motion::format_program(whole));
}

TEST(SentProgram, LeavesAnEarlierFileUntilItIsComplete) {
  const snug::test::ScratchFolder folder;
  const std::filesystem::path path = folder / "sent.csv";
  std::ofstream(path) << "old";
  test::KinematicPlant plant;
  OutputFile file(path);
  SentProgram sent(plant, file, motion::LaggedTracking{});
  (void)run(sent, to(0.5));
  EXPECT_EQ(content_of(path), "old");
  EXPECT_EQ(content_of(draft_of(path)).substr(0, 2), "# ");
  sent.finish();
  EXPECT_EQ(motion::load_program(path).waypoints.size(), 1U);
}

}  // namespace
}  // namespace snug::plant
