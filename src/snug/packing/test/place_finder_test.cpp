// PlaceFinder: the places that agents find, kept from item to item, and lowering anywhere.
#include "snug/packing/place_finder.hpp"

#include <gtest/gtest.h>

#include "snug/core/input_error.hpp"
#include "snug/packing/test/scene.hpp"

namespace snug::packing {
namespace {

using test::make_box;

PackingSettings exact() {
  PackingSettings settings;
  settings.planned_interference = 0.0;
  return settings;
}

TEST(PlaceFinder, PacksSoundlyWhateverCandidateIsTaken) {
  const model::Scenario scenario = test::demonstrator();
  Rng rng = Rng(3).split("choices");
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    const std::vector<Item> items = test::shuffled_items(scenario, seed);
    ContainerState state = make_container_state(scenario.containers.front());
    PlaceFinder finder(state, exact());
    for (const Item& item : items) {
      const auto places = finder.find(item, 50);
      if (!places) break;
      const Place& place = (*places)[static_cast<std::size_t>(rng.index(static_cast<int>(places->size())))];
      state.boxes.push_back({item, pose_at(place)});
      finder.add(state.boxes.back());
    }
    EXPECT_GE(state.boxes.size(), 3U);
    test::expect_sound(state, 0.0, PackingSettings().min_support);
  }
}

TEST(PlaceFinder, KeptFromItemToItemFindsWhatAFreshOneFinds) {
  const model::Scenario scenario = test::demonstrator();
  const std::vector<Item> items = test::shuffled_items(scenario, 2);
  ContainerState state = make_container_state(scenario.containers.front());
  PlaceFinder kept(state, exact());
  for (std::size_t i = 0; i < 8; ++i) {
    const auto places = kept.find(items[i], 100);
    PlaceFinder fresh(state, exact());
    ASSERT_EQ(places.has_value(), fresh.find(items[i], 100).has_value());
    if (!places) break;
    EXPECT_EQ(*places, *fresh.find(items[i], 100));
    state.boxes.push_back({items[i], pose_at(places->front())});
    kept.add(state.boxes.back());
  }
}

/// A bridge over an obstacle stands on boxes higher than it; nothing rests on the obstacle itself, alone or in part.
TEST(PlaceFinder, BridgesAnObstacleAndRestsNothingOnIt) {
  ContainerState state;
  state.inner_size = Vector3(0.6, 0.4, 0.4);
  state.obstacles = {{Vector3(-0.05, -0.05, 0.0), Vector3(0.05, 0.05, 0.06)}};
  PlaceFinder finder(state, exact());
  const Orientation flat;
  const Item wide = make_box("wide", Vector3(0.4, 0.1, 0.1));
  EXPECT_EQ(finder.lower(wide, flat, 0.0, 0.0).error(), NoPlace::NoStablePlace);
  EXPECT_EQ(finder.lower(make_box("beside", Vector3(0.1, 0.1, 0.1)), flat, 0.105, 0.0).error(), NoPlace::NoStablePlace);
  EXPECT_TRUE(finder.lower(make_box("beside", Vector3(0.1, 0.1, 0.1)), flat, 0.115, 0.0));
  for (const double x : {-0.13, 0.13}) {
    finder.add({make_box("pillar", Vector3(0.13, 0.1, 0.08)), {Matrix3::Identity(), Vector3(x, 0.0, 0.04)}});
  }
  const auto bridge = finder.lower(wide, flat, 0.0, 0.0);
  ASSERT_TRUE(bridge);
  EXPECT_NEAR(bridge->low_T.z(), 0.08, 1e-9);
  // As high as what carries beside it, within the slack of tops: it would rest on the obstacle, too.
  finder.reset({}, {{Vector3(-0.05, -0.05, 0.0), Vector3(0.05, 0.05, 0.074)}});
  for (const double x : {-0.13, 0.13}) {
    finder.add({make_box("pillar", Vector3(0.13, 0.1, 0.08)), {Matrix3::Identity(), Vector3(x, 0.0, 0.04)}});
  }
  EXPECT_FALSE(finder.lower(wide, flat, 0.0, 0.0));
}

TEST(PlaceFinder, LowersABoxOntoWhatIsThere) {
  ContainerState state;
  state.inner_size = Vector3(0.6, 0.4, 0.4);
  PlaceFinder finder(state, exact());
  const Item item = make_box("a", Vector3(0.2, 0.1, 0.1));
  const auto first = finder.lower(item, {}, 0.0, 0.0);
  ASSERT_TRUE(first.has_value());
  EXPECT_TRUE(first->low_T.isApprox(Vector3(-0.1, -0.05, 0.0), 1e-12));
  finder.add({item, pose_at(*first)});
  const auto second = finder.lower(item, {}, 0.05, 0.0);
  ASSERT_TRUE(second.has_value());
  EXPECT_NEAR(second->low_T.z(), 0.1, 1e-12);
  EXPECT_NEAR(second->support, 0.75, 1e-12);
  EXPECT_EQ(finder.lower(item, {}, 0.15, 0.0).error(), NoPlace::NoStablePlace);  // a quarter of it rests on the first
  EXPECT_EQ(finder.lower(item, {}, 0.35, 0.0).error(), NoPlace::NoSpace);
}

TEST(PlaceFinder, AsksForNoSupportWhereNoneIsWanted) {
  ContainerState state;
  state.inner_size = Vector3(0.4, 0.4, 0.4);
  PackingSettings settings = exact();
  settings.min_support = 0.0;
  PlaceFinder finder(state, settings);
  const Item item = make_box("a", Vector3(0.2, 0.1, 0.1));
  finder.add({item, pose_at(*finder.lower(item, {}, -0.1, 0.0))});
  EXPECT_TRUE(finder.lower(item, {}, 0.09, 0.0).has_value());
}

TEST(PlaceFinder, SaysWhyThereIsNoPlace) {
  ContainerState state;
  state.inner_size = Vector3(0.3, 0.3, 0.3);
  PlaceFinder finder(state, exact());
  EXPECT_EQ(finder.find(make_box("a", Vector3(0.5, 0.5, 0.5)), 10).error(), NoPlace::TooBig);
  const Item cube = make_box("b", Vector3(0.3, 0.3, 0.3));
  finder.add({cube, pose_at(finder.find(cube, 1)->front())});
  EXPECT_EQ(finder.find(cube, 10).error(), NoPlace::NoSpace);
  finder.reset();
  EXPECT_TRUE(finder.find(cube, 10).has_value());
}

TEST(PlaceFinder, CopiesAreIndependent) {
  ContainerState state;
  PlaceFinder finder(state, exact());
  const Item item = make_box("a", Vector3(0.2, 0.1, 0.1));
  PlaceFinder copy(finder);
  copy.add({item, pose_at(copy.find(item, 1)->front())});
  EXPECT_NE(*copy.find(item, 100), *finder.find(item, 100));
  finder = copy;
  EXPECT_EQ(*copy.find(item, 100), *finder.find(item, 100));
}

TEST(PlaceFinder, RefusesSettingsThatCannotBe) {
  PackingSettings settings;
  settings.min_support = 2.0;
  EXPECT_THROW(PlaceFinder(ContainerState{}, settings), InputError);
}

}  // namespace
}  // namespace snug::packing
