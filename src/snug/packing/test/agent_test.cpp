// Agents: sound places, reasons for a no, flags, determinism.
#include "snug/packing/agent.hpp"

#include <gtest/gtest.h>

#include <set>

#include <limits>

#include "snug/core/input_error.hpp"
#include "snug/packing/test/scene.hpp"

namespace snug::packing {
namespace {

using test::make_box;

class EveryAgent : public testing::TestWithParam<std::string> {
 protected:
  model::Scenario scenario = test::demonstrator();

  std::unique_ptr<Agent> make(std::vector<Item> sequence, int threads = 1) {
    return make_agent(GetParam(), {.settings = {},
                                   .future = make_future_model(scenario),
                                   .sequence = std::move(sequence),
                                   .is_reachable = {},
                                   .run = {.time = 0.01, .threads = threads}});
  }
};

std::string test_name(const testing::TestParamInfo<std::string>& agent) {
  std::string name = agent.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Agents, EveryAgent, testing::ValuesIn(agent_names()), test_name);

TEST_P(EveryAgent, PlansSoundlyOnRandomSequences) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    const std::vector<Item> items = test::shuffled_items(scenario, seed);
    const ContainerState state = test::pack_all(*make(items), make_container_state(scenario.containers.front()), items);
    EXPECT_GE(state.boxes.size(), 3U);
    test::expect_sound(state, PackingSettings().planned_interference, PackingSettings().min_support);
  }
}

TEST_P(EveryAgent, StaysOverTheSlabOfAPallet) {
  model::Container pallet = scenario.containers.front();
  pallet.has_walls = false;
  const std::vector<Item> items = test::shuffled_items(scenario, 4);
  const ContainerState state = test::pack_all(*make(items), make_container_state(pallet), items);
  EXPECT_GE(state.boxes.size(), 3U);
  test::expect_sound(state, 0.0, PackingSettings().min_support);  // nothing gives way: nothing holds it from the side
}

/// Least distance of a box from an edge, m, and how many are in a layer.
std::pair<double, int> pack_layer(double length, double width, const std::vector<Vector3>& sizes) {
  ContainerState state;
  state.inner_size = Vector3(length, width, 0.3);
  state.has_walls = false;
  std::vector<Item> cartons;
  for (const Vector3& size : sizes) {
    cartons.push_back(make_box("C" + std::to_string(cartons.size()), size));
    cartons.back().upright_only = true;
  }
  const FutureModel future{cartons, std::vector<double>(cartons.size(), 1.0), true};
  const auto agent = make_agent(
      "contact-aware", {.settings = {}, .future = future, .sequence = {}, .is_reachable = {}, .run = {.time = 0.05}});
  double rim = length;
  for (const Item& carton : cartons) {
    const auto decision = agent->decide(state, carton);
    if (!decision) break;
    state = with_candidate(std::move(state), carton, decision->candidates.front());
    const Extent extent = bounding_extent(state.boxes.back());
    const Vector3 outer = extent.high.cwiseMax(-extent.low);
    rim = std::min({rim, 0.5 * length - outer.x(), 0.5 * width - outer.y()});
  }
  return {rim, static_cast<int>(state.boxes.size())};
}

std::pair<double, int> pack_cartons(double length, double width) {
  return pack_layer(length, width, std::vector<Vector3>(8, {0.6, 0.4, 0.3}));
}

TEST(ContactAwareAgent, LeavesTheRimOfAPalletFreeWhereNoRowReachesAcrossIt) {
  const auto [rim, count] = pack_cartons(1.23, 1.03);
  EXPECT_NEAR(rim, 0.003, 1e-4) << "30 mm are left of either length: 3 mm at most";
  EXPECT_EQ(count, 5);
  const auto [no_rim, all] = pack_cartons(1.2, 0.8);
  EXPECT_NEAR(no_rim, 0.0, 1e-4) << "two rows of two fill it";
  EXPECT_EQ(all, 4);
  const auto [narrow_rim, same] = pack_cartons(1.208, 0.808);
  EXPECT_NEAR(narrow_rim, 0.002, 1e-4) << "a quarter of 8 mm";
  EXPECT_EQ(same, 4);
}

TEST(ContactAwareAgent, LeavesTheRimOfAPalletFreeWhereBoxesHaveManySizes) {
  // 530 + 490 + 210 and 400 + 330 + 300 mm reach across; rows of 1210 and 1010 mm do for nearly as many boxes.
  const std::vector<Vector3> sizes{{0.53, 0.40, 0.3}, {0.49, 0.33, 0.3}, {0.40, 0.30, 0.3}, {0.36, 0.21, 0.3},
                                   {0.47, 0.25, 0.3}, {0.44, 0.27, 0.3}, {0.32, 0.22, 0.3}, {0.37, 0.28, 0.3}};
  const auto [rim, count] = pack_layer(1.23, 1.03, sizes);
  EXPECT_GE(rim, 0.003 - 1e-4);
  EXPECT_GE(count, 6);
}

TEST(ContactAwareAgent, FillsAPalletLayerByLayer) {
  constexpr std::size_t kInLayer = 5, kLayers = 6;
  ContainerState state;
  state.inner_size = Vector3(1.23, 1.03, 1.85);
  state.has_walls = false;
  std::vector<Item> cartons;
  for (std::size_t i = 0; i < kInLayer * kLayers; ++i) {
    cartons.push_back(make_box("C" + std::to_string(i), {0.6, 0.4, 0.3}));
    cartons.back().upright_only = true;
  }
  const FutureModel future{cartons, std::vector<double>(cartons.size(), 1.0), true};
  const auto agent = make_agent(
      "contact-aware", {.settings = {}, .future = future, .sequence = {}, .is_reachable = {}, .run = {.time = 0.05}});
  for (std::size_t i = 0; i < cartons.size(); ++i) {
    SCOPED_TRACE(i);
    const auto decision = agent->decide(state, cartons[i]);
    ASSERT_TRUE(decision) << describe(decision.error());
    state = with_candidate(std::move(state), cartons[i], decision->candidates.front());
    const double layer = static_cast<double>(i / kInLayer);
    EXPECT_NEAR(bounding_extent(state.boxes.back()).low.z(), 0.3 * layer, 1e-3);  // levels are whole millimetres
  }
}

TEST(ContactAwareAgent, PutsABoxIntoTheMiddleOfASlotOfAPalletThatIsAMillimetreTooNarrow) {
  ContainerState state;
  state.inner_size = Vector3(1.212, 0.412, 0.7);
  state.has_walls = false;
  Item nominal = make_box("A", {0.4, 0.4, 0.3});
  nominal.upright_only = true;
  Item measured = nominal;
  measured.size = Vector3(0.4008, 0.3995, 0.3006);
  // What boxes of 400 mm leave between them is 400 mm wide, and 399 mm is what these do.
  constexpr double kLow = -0.4014, kHigh = 0.3984;
  const Matrix3 turned = Eigen::AngleAxisd(0.002, Vector3::UnitZ()).toRotationMatrix();
  state.boxes.push_back({measured, {turned, Vector3(kLow, 0.001, 0.15)}});
  state.boxes.push_back({measured, {Matrix3::Identity(), Vector3(kHigh, -0.001, 0.15)}});
  const FutureModel future{{nominal}, {1.0}, false};
  const auto agent = make_agent(
      "contact-aware", {.settings = {}, .future = future, .sequence = {}, .is_reachable = {}, .run = {.time = 0.01}});
  const auto decision = agent->decide(state, measured);
  ASSERT_TRUE(decision) << describe(decision.error());
  const Vector3& p = decision->candidates.front().placement.X_TP.p;
  EXPECT_NEAR(p.x(), 0.5 * (kLow + kHigh), 3e-4);
  EXPECT_NEAR(p.z(), 0.5 * measured.size.z(), 1e-4) << "on the slab, as high as it is";
  state.boxes.back().X_TP.p.x() -= 0.004;
  const auto above = agent->decide(state, measured);
  ASSERT_TRUE(above) << describe(above.error());
  EXPECT_GT(above->candidates.front().placement.X_TP.p.z(), 0.3) << "the slot is 5 mm too narrow now";
}

TEST(ContactAwareAgent, LetsBoxesHangOverByAQuarterAtMostOnAPallet) {
  ContainerState state;
  state.inner_size = Vector3(0.6, 0.4, 0.7);
  const Item lower = make_box("A", {0.4, 0.4, 0.3});
  Item upper = make_box("B", {0.6, 0.4, 0.3});
  upper.upright_only = true;
  state.boxes.push_back({lower, {Matrix3::Identity(), Vector3(-0.1, 0.0, 0.15)}});
  const FutureModel future{{upper}, {1.0}, true};
  const auto agent = make_agent(
      "contact-aware", {.settings = {}, .future = future, .sequence = {}, .is_reachable = {}, .run = {.time = 0.01}});
  EXPECT_TRUE(agent->decide(state, upper)) << "two thirds of it rest on A";
  state.has_walls = false;
  const auto decision = agent->decide(state, upper);
  ASSERT_FALSE(decision);
  EXPECT_EQ(decision.error(), NoPlace::NoStablePlace);
}

/// Two things that nobody expected, one on the floor and one standing higher.
TEST_P(EveryAgent, KeepsToObstaclesAndPutsNothingOnThem) {
  ContainerState start = make_container_state(scenario.containers.front());
  start.obstacles = {{Vector3(-0.14, -0.20, 0.0), Vector3(-0.05, -0.13, 0.06)},
                     {Vector3(0.08, 0.10, 0.0), Vector3(0.15, 0.19, 0.11)}};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(seed);
    const std::vector<Item> items = test::shuffled_items(scenario, seed);
    const ContainerState state = test::pack_all(*make(items), start, items);
    EXPECT_EQ(state.obstacles, start.obstacles);
    EXPECT_GE(state.boxes.size(), 3U);
    for (const PlacedBox& box : state.boxes) {
      const Extent me = upright_extent(box);
      for (const Extent& obstacle : start.obstacles) {
        // 12 mm beside it less the planned interference, or 5 mm over it.
        const Vector3 shared = me.high.cwiseMin(obstacle.high) - me.low.cwiseMax(obstacle.low);
        const bool is_beside = shared.head<2>().minCoeff() < -0.012 + PackingSettings().planned_interference;
        EXPECT_TRUE(is_beside || me.low.z() > obstacle.high.z() + 0.005) << box.item.id;
      }
    }
  }
}

/// What lies as it was decided is worth what was expected of it; what stands in the middle of the floor is worth less.
TEST(ContactAwareAgent, KnowsWhatABoxInTheWrongPlaceCosts) {
  const model::Scenario scenario = test::demonstrator();
  const std::vector<Item> items = test::shuffled_items(scenario, 5);
  const auto make = [&](int threads) {
    return make_agent("contact-aware", {.settings = {},
                                        .future = make_future_model(scenario),
                                        .sequence = items,
                                        .is_reachable = {},
                                        .run = {.time = 0.1, .threads = threads}});
  };
  const std::unique_ptr<Agent> agent = make(1);
  const ContainerState empty = make_container_state(scenario.containers.front());
  const auto decision = agent->decide(empty, items[0]);
  ASSERT_TRUE(decision);
  const Candidate& best = decision->candidates.front();
  const ContainerState as_decided = with_candidate(empty, items[0], best);
  const std::optional<double> there = agent->expected_percent(as_decided);
  ASSERT_TRUE(there);
  EXPECT_NEAR(*there, best.expected_percent, 1.5);  // two estimates of a mean, some tenths of a percent each
  EXPECT_EQ(make(3)->expected_percent(as_decided), there);
  ContainerState in_the_middle = as_decided;
  in_the_middle.boxes[0].X_TP.p.head<2>().setZero();
  EXPECT_LT(*agent->expected_percent(in_the_middle), *there - 3.0);
}

TEST(ContactAwareAgent, ExpectsNoMoreThanIsInAFullContainer) {
  const model::Scenario scenario = test::demonstrator();
  ContainerState state = make_container_state(scenario.containers.front());
  Vector3 size = state.inner_size;
  size.z() *= 0.95;
  state.boxes.push_back({make_box("all", size), Pose{Matrix3::Identity(), Vector3(0.0, 0.0, 0.5 * size.z())}});
  const auto agent = make_agent("contact-aware", {.settings = {},
                                                  .future = make_future_model(scenario),
                                                  .sequence = {},
                                                  .is_reachable = {},
                                                  .run = {.time = 0.1, .threads = 1}});
  EXPECT_DOUBLE_EQ(agent->expected_percent(state).value(), filling_percent(state));
}

TEST(Agent, OneThatDoesNotLookAheadDoesNotSayWhatItExpects) {
  const model::Scenario scenario = test::demonstrator();
  const auto agent = make_agent("margin", {.settings = {},
                                           .future = make_future_model(scenario),
                                           .sequence = {},
                                           .is_reachable = {},
                                           .run = {.time = 0.1, .threads = 1}});
  EXPECT_FALSE(agent->expected_percent(make_container_state(scenario.containers.front())));
}

TEST_P(EveryAgent, DecidesTheSameAtAnyNumberOfThreads) {
  const std::vector<Item> items = test::shuffled_items(scenario, 9);
  ContainerState one = make_container_state(scenario.containers.front());
  ContainerState four = one;
  one = test::pack_all(*make(items), one, items);
  four = test::pack_all(*make(items, 4), four, items);
  EXPECT_EQ(one, four);
}

TEST_P(EveryAgent, SaysWhyNotWhenNothingCanBeDone) {
  ContainerState state = make_container_state(scenario.containers.front());
  const auto reason = [&](const Item& item) {
    const auto decision = make({item})->decide(state, item);
    return decision ? std::string("placed") : std::string(describe(decision.error()));
  };
  EXPECT_EQ(reason(make_box("long", Vector3(0.6, 0.1, 0.1))), describe(NoPlace::TooBig));
  EXPECT_EQ(reason(make_box("heavy", Vector3(0.1, 0.1, 0.1), 50.0)), describe(NoPlace::TooHeavy));
  EXPECT_EQ(reason(make_box("tiny", Vector3(0.02, 0.02, 0.02))), describe(NoPlace::NotPickable));
  state.inner_size.z() = 0.05;
  EXPECT_EQ(reason(make_box("low container", Vector3(0.1, 0.1, 0.1))), describe(NoPlace::TooBig));
  state.inner_size = Vector3::Zero();
  EXPECT_EQ(reason(make_box("no container", Vector3(0.1, 0.1, 0.1))), describe(NoPlace::TooBig));
}

TEST_P(EveryAgent, PutsNothingOnWhatMustStayFree) {
  Item base = make_box("base", Vector3(0.36, 0.56, 0.06));
  base.no_stack = true;
  ContainerState state = make_container_state(scenario.containers.front());
  state.inner_size = Vector3(0.40, 0.60, 0.25);
  PlacedBox placed{base, Pose()};
  placed.X_TP.p.z() = 0.03;
  state.boxes.push_back(placed);
  const Item next = make_box("next", Vector3(0.1, 0.1, 0.1));
  auto decision = make({next})->decide(state, next);
  ASSERT_FALSE(decision);
  state.boxes.front().item.no_stack = false;
  state.boxes.front().item.max_load = 0.9;
  EXPECT_FALSE(make({next})->decide(state, next));
  state.boxes.front().item.max_load = 1.1;
  EXPECT_TRUE(make({next})->decide(state, next));
}

TEST_P(EveryAgent, KeepsUprightWhatMustStandUpright) {
  Item item = make_box("upright", Vector3(0.10, 0.12, 0.20));
  item.upright_only = true;
  const auto decision = make({item})->decide(make_container_state(scenario.containers.front()), item);
  ASSERT_TRUE(decision);
  for (const Candidate& candidate : decision->candidates) {
    EXPECT_EQ(candidate.placement.X_TP.R(2, 2), 1.0);
  }
}

TEST_P(EveryAgent, AsksWhatCanBeReached) {
  const Item item = make_box("one", Vector3(0.10, 0.12, 0.20));
  AgentInput input{{}, make_future_model(scenario), {item}, [](const Placement&) { return false; }};
  input.run.time = 0.01;
  const auto agent = make_agent(GetParam(), std::move(input));
  const auto decision = agent->decide(make_container_state(scenario.containers.front()), item);
  ASSERT_FALSE(decision);
  EXPECT_EQ(decision.error(), NoPlace::NotReachable);
}

TEST_P(EveryAgent, PassesOnWhatAReachFunctionThrowsAtAnyNumberOfThreads) {
  const Item item = make_box("one", Vector3(0.10, 0.12, 0.20)), next = make_box("two", Vector3(0.10, 0.12, 0.15));
  for (const int threads : {1, 2}) {
    AgentInput input{{}, make_future_model(scenario), {item, next}, [](const Placement&) -> bool {
                       throw InputError("arm", "reach", "nothing", "something");
                     }};
    input.run.time = 0.01;
    input.run.threads = threads;
    const auto agent = make_agent(GetParam(), std::move(input));
    EXPECT_THROW((void)agent->decide(make_container_state(scenario.containers.front()), item), InputError);
  }
}

TEST(NoPlace, IsInfeasibleWhereAnEmptyContainerWouldNotHelp) {
  for (const NoPlace reason : {NoPlace::TooBig, NoPlace::TooHeavy, NoPlace::NotPickable}) {
    EXPECT_TRUE(is_infeasible(reason)) << describe(reason);
  }
  for (const NoPlace reason : {NoPlace::NoSpace, NoPlace::NoStablePlace, NoPlace::OverLoad, NoPlace::NotReachable}) {
    EXPECT_FALSE(is_infeasible(reason)) << describe(reason);
  }
}

TEST(ContactAware, TurnsNoBoxForNothingAndKeepsPlacesOfEveryKind) {
  std::vector<Item> items;
  for (int i = 0; i < 4; ++i) items.push_back(test::make_box("B" + std::to_string(i), Vector3(0.2, 0.15, 0.1)));
  const FutureModel future{items, std::vector<double>(4, 1.0), true};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto agent = make_agent("contact-aware", {{}, future, {}, {}, {}, {0.02, seed, 1, false}});
    ContainerState state = make_container_state(test::demonstrator().containers.front());
    const PlaceCost cost = [](const Placement& placement) { return placement.flips > 0 ? 0.5 : 0.0; };
    for (const Item& item : items) {
      const auto decision = agent->decide_with_costs(state, item, cost);
      ASSERT_TRUE(decision.has_value());
      EXPECT_EQ(decision->candidates.front().placement.flips, 0) << "seed " << seed << " " << item.id;
      std::set<model::UpAxis> ups;
      for (const Candidate& one : decision->candidates) ups.insert(one.placement.orientation.up);
      EXPECT_EQ(ups.size(), 3U);
      EXPECT_LE(decision->candidates.size(), 24U);
      state = with_candidate(std::move(state), item, decision->candidates.front());
    }
    EXPECT_EQ(state.boxes.size(), 4U);
  }
}

/// Where a roll-out takes long few places race, and those that do not are still offered.
TEST(ContactAware, LetsFewPlacesRaceInLittleTimeAndOffersAll) {
  FutureModel future;
  for (int i = 0; i < 125; ++i) {
    const Vector3 size = 0.05 * Vector3(1 + i % 5, 1 + i / 5 % 5, 1 + i / 25);
    future.kinds.push_back(test::make_box("K" + std::to_string(i), size));
    future.weights.push_back(1.0);
  }
  ContainerState state;
  state.inner_size = Vector3(0.5, 0.5, 0.5);
  PackingSettings settings;
  settings.min_pick_face = settings.min_slenderness = 0.0;
  const Item first = test::make_box("A", {0.15, 0.2, 0.1}), second = test::make_box("B", {0.1, 0.15, 0.25});
  const auto decide = [&](double time, const Item& item) {
    return make_agent(
               "contact-aware",
               {.settings = settings, .future = future, .sequence = {}, .is_reachable = {}, .run = {.time = time}})
        ->decide(state, item);
  };
  const auto start = decide(0.02, first);
  ASSERT_TRUE(start);
  state = with_candidate(std::move(state), first, start->candidates.front());
  const auto quick = decide(0.02, second), slow = decide(1.0, second);
  ASSERT_TRUE(quick);
  ASSERT_TRUE(slow);
  EXPECT_LE(quick->roll_outs, 4 * 8);
  EXPECT_GE(slow->roll_outs, 64 * 8);
  EXPECT_EQ(quick->candidates.size(), 24U);
  EXPECT_EQ(slow->candidates.size(), 24U);
}

TEST(FutureModel, OfAnOrderHasItsBoxesAloneAndOfACatalogueAllAgainAndAgain) {
  const model::Scenario scenario = test::demonstrator();
  model::Sequence order;
  for (const int i : {7, 2, 5}) {
    order.items.emplace_back().parcel = scenario.parcels[static_cast<std::size_t>(i)].id;
  }
  const FutureModel future = make_order_future(scenario, order);
  ASSERT_EQ(future.kinds.size(), 3U);
  EXPECT_EQ(future.kinds[0].id, scenario.parcels[2].id) << "not in the order in which they come";
  EXPECT_TRUE(future.comes_once);
  EXPECT_EQ(make_catalogue_future(scenario).kinds.size(), scenario.parcels.size());
  EXPECT_FALSE(make_catalogue_future(scenario).comes_once);
}

TEST(FutureModel, HoldsTheParcelsAskedForAlone) {
  const model::Scenario scenario = test::demonstrator();
  const FutureModel some = make_future_model(scenario, std::span(scenario.parcels).subspan(4, 2));
  ASSERT_EQ(some.kinds.size(), 2U);
  EXPECT_EQ(some.kinds[0].id, scenario.parcels[4].id);
  EXPECT_EQ(make_future_model(scenario, scenario.parcels), make_future_model(scenario));
}

/// A slot of 100 mm, as high as the container, between boxes that nothing fits on.
ContainerState narrow_slot() {
  ContainerState state = make_container_state(test::demonstrator().containers.front());
  state.inner_size = Vector3(0.3, 0.2, 0.2);
  for (const double side : {-1.0, 1.0}) {
    PlacedBox wall{make_box(side < 0.0 ? "low" : "high", Vector3(0.1, 0.2, 0.2)), Pose()};
    wall.X_TP.p = Vector3(0.1 * side, 0.0, 0.1);
    state.boxes.push_back(wall);
  }
  return state;
}

TEST(ContactAware, PressesInAtLastWhatFitsNowhereOtherwise) {
  const ContainerState state = narrow_slot();
  const auto is_placed = [&](double width, double last_interference, bool tries_places = true) {
    AgentInput input;
    input.run.time = 0.01;
    input.settings.last_interference = last_interference;
    input.run.tries_places = tries_places;
    const Item item = make_box("tight", Vector3(width, 0.15, 0.19));
    const auto decision = make_agent("contact-aware", std::move(input))->decide(state, item);
    EXPECT_TRUE(decision || decision.error() == NoPlace::NoSpace);
    return decision.has_value();
  };
  // Both neighbours are planned smaller, too: twice the interference of one box is there beside the slot.
  const double interference = PackingSettings().planned_interference;
  EXPECT_TRUE(is_placed(0.1 + 2.0 * interference, 0.0));
  EXPECT_FALSE(is_placed(0.1 + 2.0 * interference + 0.001, 0.0));
  EXPECT_TRUE(is_placed(0.1 + 2.0 * interference + 0.001, 0.003));
  EXPECT_FALSE(is_placed(0.1 + 2.0 * interference + 0.001, 0.003, false)) << "for who does not try places first";
  EXPECT_TRUE(is_placed(0.1 + 2.0 * 0.003, 0.003));
  EXPECT_FALSE(is_placed(0.1 + 2.0 * 0.003 + 0.001, 0.003));
}

TEST(ContactAware, PressesInWithHalfOfTheInterferenceFirst) {
  const ContainerState state = narrow_slot();
  AgentInput input;
  input.run.time = 0.01;
  input.run.tries_places = true;
  input.settings.last_interference = 0.010;
  const auto agent = make_agent("contact-aware", std::move(input));
  // As above, the slot gives twice the interference of one box.
  const Item fits = make_box("fits", Vector3(0.1, 0.15, 0.19));
  const Item tight = make_box("tight", Vector3(0.1 + 2.0 * 0.005, 0.15, 0.19));
  const Item tightest = make_box("tightest", Vector3(0.1 + 2.0 * 0.010, 0.15, 0.19));
  EXPECT_EQ(agent->decide(state, fits)->pressed, 0.0);
  EXPECT_EQ(agent->decide(state, tight)->pressed, 0.005);
  EXPECT_EQ(agent->decide(state, tightest)->pressed, 0.010) << "half is not enough";
  // Where none of these can be had, the caller asks for more.
  EXPECT_EQ(agent->decide_pressed(state, fits, {}, 0.0)->pressed, 0.005);
  EXPECT_EQ(agent->decide_pressed(state, fits, {}, 0.005)->pressed, 0.010);
  EXPECT_FALSE(agent->decide_pressed(state, fits, {}, 0.010));
}

TEST(Agent, UnknownNamesAndSettingsThatCannotBeAreRefused) {
  EXPECT_THROW((void)make_agent("contact-awar", {}), InputError);
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    AgentInput input;
    input.run.time = bad;
    EXPECT_THROW((void)make_agent("contact-aware", input), InputError);
  }
}

}  // namespace
}  // namespace snug::packing
