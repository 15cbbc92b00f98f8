// ContainerState: extents and filling degree against sums by hand.
#include "snug/packing/container_state.hpp"

#include <gtest/gtest.h>

#include "snug/packing/agent.hpp"

namespace snug::packing {
namespace {

PlacedBox cube(double side, const Vector3& p, double mass) {
  PlacedBox box;
  box.item.size = Vector3::Constant(side);
  box.item.mass = mass;
  box.X_TP.p = p;
  return box;
}

TEST(ContainerState, UprightExtentIgnoresASmallTilt) {
  PlacedBox box = cube(0.1, Vector3(0.0, 0.0, 0.05), 1.0);
  box.X_TP.R = exp_rotation(Vector3(0.02, 0.0, 0.0));
  EXPECT_NEAR(tilt(box), 0.02, 1e-12);  // rounding
  EXPECT_LT((upright_extent(box).high - Vector3(0.05, 0.05, 0.1)).norm(), 1e-15);
  EXPECT_GT(bounding_extent(box).high.z(), 0.1);
}

TEST(ContainerState, FillingDegreeIsThatOfTheReportForSequenceOne) {
  const model::Scenario scenario = model::load_scenario(SNUG_SOURCE_DIR "/scenarios/box-demonstrator.yaml");
  ContainerState state = make_container_state(*model::find_container(scenario, scenario.target));
  const std::vector<Item> items = make_items(scenario, *model::find_sequence(scenario, "1"));
  for (int i = 0; i < 12; ++i) state.boxes.push_back({items[static_cast<std::size_t>(i)], Pose()});
  EXPECT_NEAR(filling_percent(state), 74.22, 0.005);  // Table 9 sizes over 52.725 L, two decimals
}

}  // namespace
}  // namespace snug::packing
