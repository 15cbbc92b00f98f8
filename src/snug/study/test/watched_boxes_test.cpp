// Watched boxes: what became of each, by what an observer saw of it.
#include "snug/study/watched_boxes.hpp"

#include <gtest/gtest.h>

namespace snug::study {
namespace {

model::Scenario pair_of_boxes() {
  return model::parse_scenario(
      "name: pair\nmaterials: [{name: box}]\n"
      "contacts:\n  pairs:\n    - {between: [box, box], friction: 0.4, restitution: 0}\n"
      "parcel_types: [{name: b, size: [0.2, 0.2, 0.1], mass: 1.0}]\n"
      "parcels: [{id: A, type: b, material: box}, {id: B, type: b, material: box}]\n"
      "containers: [{name: tote, inner_size: [0.6, 0.4, 0.3], material: box}]\ntarget: tote\n"
      "sequences: [{name: s, items: [{parcel: A, up: Z}, {parcel: B, up: Z}]}]\n",
      "pair.yaml");
}

class WatchedBoxes : public testing::Test {
 protected:
  Witness witness() {
    BoxSource source;
    source.boxes = [this] { return seen; };
    source.size_of = [](std::size_t) { return Vector3(0.2, 0.2, 0.1); };
    source.was_brought = [this](std::size_t item) { return brought[item]; };
    return watch_boxes(scenario, "s", std::move(source));
  }
  perception::SceneBox at(const Vector3& p_T) const {
    perception::SceneBox box;
    box.X_WP = model::find_container(scenario, scenario.target)->X_WT * Pose{Matrix3::Identity(), p_T};
    return box;
  }
  model::Scenario scenario = pair_of_boxes();
  std::vector<std::optional<perception::SceneBox>> seen = {std::nullopt, std::nullopt};
  std::vector<bool> brought = {false, false};
};

TEST_F(WatchedBoxes, WaitWhereTheyCameAndArePackedInTheContainer) {
  const Witness watched = witness();
  EXPECT_TRUE(watched.boxes().empty()) << "nothing was brought";
  brought[0] = true;
  seen[0] = at({2.0, 0.0, 0.0});
  ASSERT_EQ(watched.boxes().size(), 1U);
  EXPECT_EQ(watched.boxes()[0].id, "A");
  EXPECT_EQ(watched.boxes()[0].state, cell::BoxState::Waiting);
  seen[0] = at({0.0, 0.0, 0.05});
  EXPECT_EQ(watched.boxes()[0].state, cell::BoxState::Packed);
}

TEST_F(WatchedBoxes, AreDroppedElsewhereAndLostOutOfSight) {
  const Witness watched = witness();
  brought = {true, true};
  seen = {at({2.0, 0.0, 0.0}), at({2.0, 0.0, 0.0})};
  (void)watched.poses();
  seen = {at({1.0, 0.0, 0.0}), at({1.0, 0.0, 0.0})};
  (void)watched.poses();
  seen[1].reset();
  EXPECT_EQ(watched.boxes()[0].state, cell::BoxState::Dropped);
  EXPECT_EQ(watched.boxes()[1].state, cell::BoxState::Lost);
}

}  // namespace
}  // namespace snug::study
