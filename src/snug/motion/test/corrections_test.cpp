// Tests of shifting named waypoints.
#include "snug/motion/corrections.hpp"

#include <gtest/gtest.h>

#include <string>

#include "snug/motion/program_csv.hpp"
#include "snug/motion/test/demonstrator.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::motion {
namespace {

/// Shift in mm of a waypoint of this name.
Vector3 shift_mm(const std::string& name, int sequence) {
  Program program{"f.csv", {}};
  program.waypoints.push_back(named_waypoint(name, Pose{Matrix3::Identity(), Vector3::Zero()}));
  return 1000.0 * apply_corrections(program, demonstrator_corrections(sequence)).waypoints[0].X_WE.p;
}

TEST(Corrections, ShiftTheRowsThatTheDemonstratorShifts) {
  EXPECT_EQ(shift_mm("Box017", 1), Vector3(0, 0, -20));
  EXPECT_EQ(shift_mm("PlaceBox014", 1), Vector3(0, 0, -5));
  EXPECT_EQ(shift_mm("Place018_2", 2), Vector3(0, 0, -5));
  EXPECT_EQ(shift_mm("PreRepick016", 1), Vector3(30, 10, 0));
  EXPECT_EQ(shift_mm("PreRePick014_2", 1), Vector3(30, 10, 0));
  EXPECT_EQ(shift_mm("PreRePick024", 2), Vector3(50, 10, 0));
}

TEST(Corrections, AddWhenSeveralMatchARow) {
  EXPECT_EQ(shift_mm("RePick014", 1), Vector3(30, 10, -20));
  EXPECT_EQ(shift_mm("RePick024", 3), Vector3(50, 10, -20));
}

TEST(Corrections, LeaveNamesAloneThatOnlyContainAPrefix) {
  for (const char* name : {"PrePlace017", "PrePlaceBox013", "PostPickBox017", "PostRePick014", "PostPlace024",
                           "Twist016", "home", "box017", "PrePick027"}) {
    EXPECT_EQ(shift_mm(name, 1), Vector3::Zero()) << name;
  }
}

TEST(Corrections, ShiftARowOnceWhenTwoPrefixesOfOneMatch) {
  Program program{"f.csv", {}};
  program.waypoints.push_back(named_waypoint("Box017", Pose{}));
  const std::vector<Correction> corrections = {{{"Box", "Box017", "B"}, Vector3(1.0, 2.0, 3.0)}};
  const Program shifted = apply_corrections(program, corrections);
  EXPECT_EQ(shifted.waypoints[0].X_WE.p, Vector3(1.0, 2.0, 3.0));
  EXPECT_EQ(shifted.waypoints[0].X_WE.R, program.waypoints[0].X_WE.R);
}

TEST(Corrections, OfNoneGiveTheSameProgram) {
  const Program program = parse_program("1,2,3,0,0,0,Box017,0,0,0,0,0,0", "f.csv");
  EXPECT_EQ(apply_corrections(program, {}), program);
}

TEST(Corrections, MatchEveryRePickOfTheRealFiles) {
  SNUG_NEED_WAYPOINT_FILES();
  const std::vector<std::size_t> expected_flips = {2, 4, 4};  // interfaces 2.5: flipped boxes
  for (int sequence = 1; sequence <= 3; ++sequence) {
    const Program program = load_program(waypoint_folder() / ("poses" + std::to_string(sequence) + "real.csv"));
    const Program shifted = apply_corrections(program, demonstrator_corrections(sequence));
    std::size_t count = 0;
    for (std::size_t i = 0; i < program.waypoints.size(); ++i) {
      const Vector3 shift = shifted.waypoints[i].X_WE.p - program.waypoints[i].X_WE.p;
      if (shift.x() > 0.02 && shift.z() < -0.01) ++count;
    }
    EXPECT_EQ(count, expected_flips[static_cast<std::size_t>(sequence - 1)]) << sequence;
  }
}

}  // namespace
}  // namespace snug::motion
