// Tests of where the time of an item goes: each part by the names that the planners give, nothing lost.
#include "snug/session/item_seconds.hpp"
#include "snug/motion/waypoint_name.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace snug::session {
namespace {

motion::Waypoint row(const std::string& name, bool vacuum = false) {
  motion::Waypoint waypoint = motion::parse_waypoint_name(name);
  waypoint.io.vacuum = vacuum;
  return waypoint;
}

TEST(ItemSeconds, EachKindOfRowHasItsPart) {
  const std::vector<motion::Waypoint> rows = {row("PrePick(A)"),
                                              row("Box(A)"),
                                              row("PostPick(A)", true),
                                              row("PreTwist(A)", true),
                                              row("Twist(A)", true),
                                              row("RePick(A)"),
                                              row("PostRePick(A)_up", true),
                                              row("PrePlace(A)_2", true),
                                              row("Place(A)_down", true),
                                              row("PlaceSlow(A)_push", true),
                                              row("Place(A)"),
                                              row("PostPlace(A)")};
  std::vector<plant::WaypointTime> times;
  for (std::size_t i = 0; i < rows.size(); ++i) times.push_back({static_cast<double>(1 << i), 0.25});
  const ItemSeconds seconds = split_seconds(rows, times);
  EXPECT_EQ(seconds.travel, 1 + 2 + 2048);
  EXPECT_EQ(seconds.carry, 4 + 128);
  EXPECT_EQ(seconds.regrasp, 8 + 16 + 32 + 64);
  EXPECT_EQ(seconds.insert, 256 + 1024);
  EXPECT_EQ(seconds.push, 512);
  EXPECT_EQ(seconds.wait, 0.25 * 12);
  EXPECT_EQ(seconds.total(), 4095 + 3);
}

TEST(ItemSeconds, OfAMotionThatWasBrokenOffAreThoseThatWereMade) {
  const std::vector<motion::Waypoint> rows = {row("PrePick(A)"), row("Box(A)")};
  const std::vector<plant::WaypointTime> times = {{1.5, 0.0}};
  EXPECT_EQ(split_seconds(rows, times).total(), 1.5);
  EXPECT_EQ(split_seconds({}, times).total(), 0.0);
}

TEST(ItemSeconds, AddUp) {
  ItemSeconds sum{1, 2, 3, 4, 5, 6};
  sum += ItemSeconds{10, 20, 30, 40, 50, 60};
  EXPECT_EQ(sum, (ItemSeconds{11, 22, 33, 44, 55, 66}));
}

}  // namespace
}  // namespace snug::session
