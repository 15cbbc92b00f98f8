// try_motion, find_loss: whether a program may be given to a robot.
#include "snug/runs/program_trial.hpp"

#include <gtest/gtest.h>

#include "snug/cell/test/demonstrator.hpp"
#include "snug/motion/program_csv.hpp"

namespace snug::runs {
namespace {

using cell::BoxState;
using cell::demonstrator;
using cell::kSource;
using cell::Simulation;

/// BOX027 is packed by its 8 rows; 1 is the pick, 2 has the vacuum on first.
motion::Program one_box() {
  motion::Program program = motion::load_program(kSource / "src/snug/cell/test/demo_program.csv");
  program.waypoints.resize(8);
  return program;
}

MotionTrial tried(const motion::Program& program) {
  const Simulation simulation(demonstrator(), "1", {});
  return try_motion(simulation, simulation.prepare(program));
}

TEST(FindLoss, IsEmptyForAPackedBoxWhileTheOthersOfTheSequenceNeverCome) {
  const MotionTrial trial = tried(one_box());
  ASSERT_EQ(trial.boxes.size(), 1U);
  EXPECT_EQ(trial.boxes[0].state, BoxState::Packed);
  EXPECT_EQ(find_loss(trial), "");
}

TEST(FindLoss, NamesThePickThatIsTooHighToSeal) {
  motion::Program program = one_box();
  program.waypoints[1].X_WE.p.z() += 0.05;
  const MotionTrial trial = tried(program);
  ASSERT_EQ(trial.missed_seals.size(), 1U);
  const std::string loss = find_loss(trial);
  EXPECT_EQ(loss.find("no seal toward PostPick(BOX027): "), 0U) << loss;
  EXPECT_NE(loss.find("BOX027 is waiting, not packed"), std::string::npos) << loss;
}

TEST(FindLoss, NamesABoxThatARowPicksWithoutVacuum) {
  motion::Program program = one_box();
  for (motion::Waypoint& waypoint : program.waypoints) waypoint.io.vacuum = false;
  EXPECT_EQ(find_loss(tried(program)), "BOX027 is waiting, not packed");
}

TEST(FindLoss, NamesAVacuumThatStaysOnWithoutABox) {
  motion::Program program = one_box();
  program.waypoints.resize(3);
  for (motion::Waypoint& waypoint : program.waypoints) {
    waypoint.motion_class = motion::MotionClass::Home;
    waypoint.item.clear();
  }
  const std::string loss = find_loss(tried(program));
  EXPECT_EQ(loss.find("no seal toward home"), 0U) << loss;
}

TEST(FindLoss, LetsABoxWaitThatNoRowPicks) {
  motion::Program program = one_box();
  program.waypoints.resize(1);
  const MotionTrial trial = tried(program);
  ASSERT_EQ(trial.boxes.size(), 1U);
  EXPECT_EQ(trial.boxes[0].state, BoxState::Waiting);
  EXPECT_EQ(find_loss(trial), "");
}

TEST(FindLoss, NamesABoxThatIsLetGoOnTheWay) {
  motion::Program program = one_box();
  program.waypoints[3].io.vacuum = program.waypoints[4].io.vacuum = program.waypoints[5].io.vacuum = false;
  const std::string loss = find_loss(tried(program));
  EXPECT_NE(loss.find("BOX027 is "), std::string::npos) << loss;
}

}  // namespace
}  // namespace snug::runs
