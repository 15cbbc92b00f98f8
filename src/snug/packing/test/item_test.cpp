// Item: orientations, extents and flips.
#include "snug/packing/item.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "snug/core/input_error.hpp"

namespace snug::packing {
namespace {

using model::UpAxis;

Item b3() {
  Item item;
  item.id = "B3";
  item.size = Vector3(0.185, 0.260, 0.062);
  return item;
}

TEST(Orientation, PutsTheNamedAxisUp) {
  for (const UpAxis up : {UpAxis::X, UpAxis::Y, UpAxis::Z}) {
    for (const int sign : {1, -1}) {
      for (int yaw = 0; yaw < 4; ++yaw) {
        const Matrix3 R_TP = rotation({up, sign, yaw});
        EXPECT_EQ(R_TP(2, static_cast<int>(up)), sign);
        EXPECT_EQ(R_TP.determinant(), 1.0);
        EXPECT_EQ((R_TP.transpose() * R_TP), Matrix3::Identity());
        EXPECT_EQ(nearest_orientation(R_TP), (Orientation{up, sign, yaw}));
      }
    }
  }
}

TEST(Orientation, ExtentsArePermutationsOfTheSize) {
  EXPECT_EQ(extents({UpAxis::Z, 1, 0}, b3().size), Vector3(0.185, 0.260, 0.062));
  EXPECT_EQ(extents({UpAxis::Z, 1, 1}, b3().size), Vector3(0.260, 0.185, 0.062));
  EXPECT_EQ(extents({UpAxis::X, 1, 0}, b3().size), Vector3(0.260, 0.062, 0.185));
  EXPECT_EQ(extents({UpAxis::Y, -1, 1}, b3().size).z(), 0.260);
}

TEST(Orientation, AnotherAxisIsOneFlipAndUpsideDownTwo) {
  EXPECT_EQ(count_flips({UpAxis::Z, 1, 0}, {UpAxis::Z, 1, 3}), 0);
  EXPECT_EQ(count_flips({UpAxis::Z, 1, 0}, {UpAxis::X, -1, 0}), 1);
  EXPECT_EQ(count_flips({UpAxis::Z, 1, 0}, {UpAxis::Z, -1, 0}), 2);
}

TEST(Item, OrientationsAreThoseWithinTheFlips) {
  EXPECT_EQ(allowed_orientations(b3(), 0).size(), 2U);
  EXPECT_EQ(allowed_orientations(b3(), 1).size(), 10U);
  EXPECT_EQ(allowed_orientations(b3(), 2).size(), 12U);
  EXPECT_EQ(allowed_orientations(b3(), 2, true).size(), 24U);
}

TEST(Item, UprightOnlyStandsOnItsLowerFaceOrNowhere) {
  Item item = b3();
  item.upright_only = true;
  EXPECT_EQ(allowed_orientations(item, 0).size(), 2U);
  item.arrival = {UpAxis::X, 1, 0};
  EXPECT_TRUE(allowed_orientations(item, 0).empty());
  for (const Orientation& o : allowed_orientations(item, 1)) EXPECT_EQ(o.up, UpAxis::Z);
}

TEST(Item, SequenceOfTheScenarioBecomesItemsInOrder) {
  const model::Scenario scenario = model::load_scenario(SNUG_SOURCE_DIR "/scenarios/box-demonstrator.yaml");
  const std::vector<Item> items = make_items(scenario, *model::find_sequence(scenario, "1"));
  ASSERT_EQ(items.size(), 18U);
  EXPECT_EQ(items.front().id, "BOX027");
  EXPECT_EQ(items[3].arrival.up, UpAxis::X);
  EXPECT_THROW((void)make_item(scenario, model::Item{"BOX999", UpAxis::Z, 1, {}, {}}), InputError);
}

}  // namespace
}  // namespace snug::packing
