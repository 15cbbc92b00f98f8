// Environments: what is observed, number by number; rewards and rules against closed forms; what is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/environment/vector_environment.hpp"

namespace snug::environment {
namespace {

const model::Scenario& cell_of_boxes() {
  static const model::Scenario scenario =
      model::load_scenario(std::string(SNUG_SOURCE_DIR) + "/scenarios/box-demonstrator.yaml");
  return scenario;
}

Settings in_mode(Mode mode, const std::string& sequence = "1") {
  Settings settings;
  settings.mode = mode;
  settings.sequence = sequence;
  return settings;
}

/// Everything that is observed, in buffers filled with a number that nothing is.
struct Seen {
  explicit Seen(const Environment& of)
      : map(static_cast<std::size_t>(of.rows()) * static_cast<std::size_t>(of.columns()), -7.0F),
        item(kItemNumbers, -7.0F),
        boxes(static_cast<std::size_t>(of.most_boxes()) * kBoxNumbers, -7.0F),
        candidates(static_cast<std::size_t>(of.settings().max_candidates) * kCandidateNumbers, -7.0F),
        mask(static_cast<std::size_t>(of.settings().max_candidates), -7) {
    of.observe({map, item, boxes, candidates, mask});
  }
  std::vector<float> map, item, boxes, candidates;
  std::vector<std::int8_t> mask;
};

TEST(Observed, NumbersAreThoseOfTheItemTheBoxesAndTheCandidates) {
  Environment game(cell_of_boxes(), in_mode(Mode::Geometric));
  game.reset(1);
  for (int step = 0; step < 5; ++step) {
    SCOPED_TRACE(step);
    const Seen seen(game);
    const packing::Item& item = game.items()[static_cast<std::size_t>(game.next())];
    const Vector3 standing = packing::extents(item.arrival, item.size);
    for (int i = 0; i < 3; ++i)
      EXPECT_FLOAT_EQ(seen.item[static_cast<std::size_t>(i)], static_cast<float>(standing[i]));
    EXPECT_FLOAT_EQ(seen.item[3], static_cast<float>(item.mass));
    EXPECT_EQ(seen.item[4], item.upright_only ? 1.0F : 0.0F);
    EXPECT_EQ(seen.item[5], item.no_stack ? 1.0F : 0.0F);
    ASSERT_EQ(game.boxes().size(), static_cast<std::size_t>(step));
    for (std::size_t i = 0; i < game.boxes().size(); ++i) {
      const packing::Extent extent = packing::bounding_extent(game.boxes()[i]);
      for (std::size_t k = 0; k < 3; ++k) {
        const auto axis = static_cast<Eigen::Index>(k);
        EXPECT_FLOAT_EQ(seen.boxes[kBoxNumbers * i + k], static_cast<float>(extent.low[axis]));
        EXPECT_FLOAT_EQ(seen.boxes[kBoxNumbers * i + 3 + k], static_cast<float>(extent.high[axis]));
      }
      EXPECT_FLOAT_EQ(seen.boxes[kBoxNumbers * i + 6], static_cast<float>(game.boxes()[i].item.mass));
    }
    for (std::size_t i = kBoxNumbers * game.boxes().size(); i < seen.boxes.size(); ++i) EXPECT_EQ(seen.boxes[i], 0.0F);
    for (std::size_t i = 0; i < seen.mask.size(); ++i) {
      const bool is_there = i < game.candidates().size();
      EXPECT_EQ(seen.mask[i], is_there ? 1 : 0);
      const float* const numbers = &seen.candidates[kCandidateNumbers * i];
      if (!is_there) {
        EXPECT_TRUE(std::all_of(numbers, numbers + kCandidateNumbers, [](float one) { return one == 0.0F; }));
        continue;
      }
      const packing::Place& place = game.candidates()[i];
      for (int k = 0; k < 3; ++k) {
        EXPECT_FLOAT_EQ(numbers[k], static_cast<float>(place.low_T[k]));
        EXPECT_FLOAT_EQ(numbers[3 + k], static_cast<float>(place.extents[k]));
      }
      EXPECT_FLOAT_EQ(numbers[6], static_cast<float>(place.support));
      EXPECT_EQ(Environment::orientations()[static_cast<std::size_t>(numbers[7])], place.orientation);
    }
    (void)game.step({.candidate = 0});
  }
}

TEST(Observed, WhatIsNotAskedForIsNotWritten) {
  const Environment game(cell_of_boxes(), in_mode(Mode::Geometric));
  std::vector<float> item(kItemNumbers, -7.0F);
  game.observe({});
  EXPECT_EQ(item, std::vector<float>(kItemNumbers, -7.0F));
  game.observe({.height_map = {}, .item = item, .boxes = {}, .candidates = {}, .mask = {}});
  EXPECT_GT(item[0], 0.0F);
}

TEST(Observed, AfterTheEndThereIsNoItemAndNoCandidate) {
  Settings settings = in_mode(Mode::Geometric);
  Environment game(cell_of_boxes(), settings);
  game.reset(1);
  while (!game.has_ended()) (void)game.step({.candidate = 0});
  (void)game.step({.candidate = 0});
  const Seen seen(game);
  EXPECT_TRUE(std::ranges::all_of(seen.mask, [](std::int8_t one) { return one == 0; }));
  EXPECT_TRUE(std::ranges::all_of(seen.candidates, [](float one) { return one == 0.0F; }));
}

TEST(Rewards, AreTheVolumeOfTheBoxAsAPartOfTheContainer) {
  Environment game(cell_of_boxes(), in_mode(Mode::Geometric));
  game.reset(1);
  const double volume = cell_of_boxes().containers.front().inner_size.prod();
  while (!game.has_ended()) {
    const Vector3 size = game.items()[static_cast<std::size_t>(game.next())].size;
    const double before = game.packed_percent();
    const Step step = game.step({.candidate = 0});
    ASSERT_TRUE(step.is_placed);
    EXPECT_NEAR(step.reward, size.prod() / volume, 1e-12);
    EXPECT_NEAR(game.packed_percent() - before, 100.0 * step.reward, 1e-9);
    EXPECT_EQ(step.displacement, 0.0) << "boxes do not move in this mode";
    EXPECT_EQ(step.terminated, game.has_ended());
    EXPECT_EQ(step.reason.empty(), !step.terminated);
  }
  EXPECT_LT(game.packed_percent(), 100.0);
  EXPECT_EQ(game.time(), 0.0);
}

TEST(Rewards, NoBoxStandsInAnotherOrOutsideWhateverIsChosen) {
  Environment game(cell_of_boxes(), in_mode(Mode::Geometric, ""));
  const Vector3 inner = cell_of_boxes().containers.front().inner_size;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    game.reset(seed);
    for (int step = 0; !game.has_ended(); ++step) {
      const auto count = static_cast<int>(game.candidates().size());
      (void)game.step({.candidate = static_cast<int>((seed * 7 + static_cast<std::uint64_t>(step) * 5)) % count});
    }
    const auto& boxes = game.boxes();
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const packing::Extent a = packing::bounding_extent(boxes[i]);
      EXPECT_GE(a.low.z(), -1e-9);
      EXPECT_LE(a.high.z(), inner.z() + 1e-9);
      for (const Vector3& corner : {a.low, a.high}) {
        EXPECT_LE((corner.cwiseAbs() - 0.5 * inner).head<2>().maxCoeff(), 1e-9);
      }
      for (std::size_t j = 0; j < i; ++j) {
        const packing::Extent b = packing::bounding_extent(boxes[j]);
        const Vector3 shared = a.high.cwiseMin(b.high) - a.low.cwiseMax(b.low);
        EXPECT_LT(shared.minCoeff(), 1e-9) << i << " in " << j;
      }
    }
  }
}

/// A box in the middle of the floor, then one on it and one that hangs over its edge by half.
TEST(Places, AreLoweredToWhatIsUnderThem) {
  Settings settings = in_mode(Mode::Geometric);
  settings.packing.max_flips = 0;
  Environment game(cell_of_boxes(), settings);
  game.reset(1);
  const auto upright = [&] {
    const auto& all = Environment::orientations();
    const packing::Item& item = game.items()[static_cast<std::size_t>(game.next())];
    return static_cast<int>(std::ranges::find(all, item.arrival) - all.begin());
  };
  const double height = packing::extents(game.items()[0].arrival, game.items()[0].size).z();
  ASSERT_TRUE(game.step({.candidate = -1, .orientation = upright(), .x = 0.0, .y = 0.0}).is_placed);
  EXPECT_NEAR(packing::bounding_extent(game.boxes()[0]).low.z(), 0.0, 1e-12);
  Environment other = game;
  ASSERT_TRUE(game.step({.candidate = -1, .orientation = upright(), .x = 0.0, .y = 0.0}).is_placed);
  EXPECT_NEAR(packing::bounding_extent(game.boxes()[1]).low.z(), height, 1e-12);
  const Step hanging = other.step({.candidate = -1, .orientation = upright(), .x = 0.0, .y = 0.14});
  EXPECT_FALSE(hanging.is_placed) << "hardly any of its lower face rests on something";
  EXPECT_TRUE(hanging.terminated);
  EXPECT_EQ(hanging.reward, 0.0);
}

TEST(Episodes, OfAllParcelsHaveEachOnceAndEveryOneIsTheFirstAsOften) {
  Environment game(cell_of_boxes(), in_mode(Mode::Geometric, ""));
  const std::size_t count = cell_of_boxes().parcels.size();
  std::map<std::string, int> firsts;
  constexpr int kEpisodes = 600;
  for (std::uint64_t seed = 0; seed < kEpisodes; ++seed) {
    game.reset(seed);
    std::set<std::string> ids;
    for (const packing::Item& item : game.items()) ids.insert(item.id);
    ASSERT_EQ(ids.size(), count);
    ++firsts[game.items().front().id];
  }
  double chi = 0.0;
  const double mean = static_cast<double>(kEpisodes) / static_cast<double>(count);
  for (const model::Parcel& parcel : cell_of_boxes().parcels) chi += std::pow(firsts[parcel.id] - mean, 2) / mean;
  // Chi square of count - 1 degrees of freedom: mean count - 1, deviation sqrt(2 (count - 1)).
  const double freedom = static_cast<double>(count) - 1.0;
  EXPECT_LT(chi, freedom + 5.0 * std::sqrt(2.0 * freedom));
  EXPECT_GT(chi, freedom - 5.0 * std::sqrt(2.0 * freedom));
}

TEST(Episodes, NothingHappensAfterTheEnd) {
  Environment game(cell_of_boxes(), in_mode(Mode::Geometric));
  game.reset(1);
  while (!game.has_ended()) (void)game.step({.candidate = 0});
  const std::uint64_t before = game.hash();
  for (const int candidate : {0, -1, 5000}) {
    const Step step = game.step({.candidate = candidate});
    EXPECT_TRUE(step.terminated);
    EXPECT_EQ(step.reward, 0.0);
    EXPECT_EQ(step.reason, "the episode has ended");
  }
  EXPECT_EQ(game.hash(), before);
}

TEST(Episodes, CopiesAreByThemselvesAndMovedOnesGoOn) {
  for (const Mode mode : {Mode::Geometric, Mode::Statics}) {
    Environment game(cell_of_boxes(), in_mode(mode));
    game.reset(1);
    (void)game.step({.candidate = 0});
    const std::uint64_t at = game.hash();
    Environment copy(game);
    (void)copy.step({.candidate = 1});
    EXPECT_EQ(game.hash(), at);
    EXPECT_NE(copy.hash(), at);
    Environment assigned(cell_of_boxes(), in_mode(mode));
    assigned = game;
    const Environment& same = assigned;
    assigned = same;
    EXPECT_EQ(assigned.hash(), at);
    Environment moved = std::move(assigned);
    EXPECT_EQ(moved.hash(), at);
    const Step a = moved.step({.candidate = 1});
    EXPECT_EQ(moved.hash(), copy.hash());
    EXPECT_TRUE(a.is_placed) << a.reason;
  }
}

TEST(Episodes, AResetForgetsEverything) {
  for (const Mode mode : {Mode::Geometric, Mode::Statics}) {
    Environment fresh(cell_of_boxes(), in_mode(mode)), used(cell_of_boxes(), in_mode(mode));
    fresh.reset(5);
    used.reset(9);
    for (int i = 0; i < 3; ++i) (void)used.step({.candidate = 0});
    used.reset(5);
    EXPECT_EQ(fresh.hash(), used.hash());
    EXPECT_EQ(used.next(), 0);
    EXPECT_TRUE(used.boxes().empty());
    EXPECT_EQ(used.packed_percent(), 0.0);
    EXPECT_EQ(used.time(), 0.0);
    (void)fresh.step({.candidate = 2});
    (void)used.step({.candidate = 2});
    EXPECT_EQ(fresh.hash(), used.hash());
  }
}

/// Set down on the floor at rest, a box sinks by its weight over the stiffness of its contact: less than a millimetre.
TEST(StaticsOfABox, OnTheFloorStaysWhereItWasPutAndTakesNoMoreThanItsTime) {
  Settings settings = in_mode(Mode::Statics);
  settings.settle_time = 0.3;
  Environment game(cell_of_boxes(), settings);
  game.reset(1);
  double last = 0.0;
  for (int i = 0; i < 3; ++i) {
    const Step step = game.step({.candidate = 0});
    ASSERT_TRUE(step.is_placed) << step.reason;
    EXPECT_LT(step.displacement, 0.001);
    EXPECT_GT(game.time(), last);
    EXPECT_LE(game.time() - last, settings.settle_time + 2.0 * settings.time_step);
    last = game.time();
  }
}

TEST(StaticsOfABox, IsNotPlacedWhereItMovedByMoreThanItMay) {
  Settings settings = in_mode(Mode::Statics);
  settings.max_displacement = 1e-9;
  Environment game(cell_of_boxes(), settings);
  game.reset(1);
  const Step step = game.step({.candidate = 0});
  EXPECT_FALSE(step.is_placed) << "it sinks in by some micrometres";
  EXPECT_EQ(step.reason, "it does not stay where it was put");
  EXPECT_GT(step.displacement, 1e-9);
  EXPECT_GT(step.reward, 0.0) << "it is in the container all the same";
  EXPECT_TRUE(step.terminated);
}

/// Contact is second order where it is smooth: steps four times as long hardly change where the tool leaves a box.
TEST(ExecutedBox, LongerStepsHardlyChangeWhereItRests) {
  const auto placed = [](double time_step) {
    Settings settings = in_mode(Mode::Executed);
    settings.time_step = time_step;
    Environment game(cell_of_boxes(), settings);
    game.reset(1);
    const double displacement = game.step({.candidate = 0}).displacement;
    return std::pair(displacement, game.hash());
  };
  ASSERT_EQ(cell_of_boxes().time_step, 0.001);
  const auto [own, own_hash] = placed(0.0);
  EXPECT_EQ(placed(0.0005).second, own_hash) << "no shorter than the scenario's";
  EXPECT_EQ(placed(0.004).second, placed(0.0055).second) << "in whole parts of the tick of 8 ms";
  EXPECT_NE(placed(0.004).second, own_hash);
  EXPECT_NEAR(placed(0.004).first, own, 5e-5) << "3 um when this was written; boxes that slide differ by up to 0.5 mm";
}

TEST(ParametersOfOne, ScaleFrictionMassAndCupAndChangeNoOther) {
  const auto settled = [](const Parameters& parameters) {
    Environment game(cell_of_boxes(), in_mode(Mode::Statics), parameters);
    game.reset(1);
    const Step step = game.step({.candidate = 0});
    EXPECT_TRUE(step.is_placed) << step.reason;
    return std::pair(step.displacement, game.hash());
  };
  const auto [sunk, hash] = settled({});
  EXPECT_EQ(settled({}).second, hash);
  const auto [sunk_more, other_hash] = settled({.mass_scale = 2.0});
  EXPECT_NE(other_hash, hash);
  EXPECT_NEAR(sunk_more / sunk, 2.0, 0.1) << "twice the weight on the same springs";
  EXPECT_EQ(settled({.cup_scale = 3.0}).second, hash) << "no cup touches it";
}

TEST(Refusals, EveryNumberThatCannotBeIsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
  const auto key_of = [](const Settings& settings, const Parameters& parameters) -> std::string {
    try {
      const Environment game(cell_of_boxes(), settings, parameters);
    } catch (const InputError& error) {
      return error.key;
    }
    return "accepted";
  };
  const std::vector<std::pair<std::string, std::function<void(Settings&, double)>>> settings{
      {"resolution", [](Settings& s, double x) { s.resolution = x; }},
      {"settle_time", [](Settings& s, double x) { s.settle_time = x; }},
      {"max_displacement", [](Settings& s, double x) { s.max_displacement = x; }},
      {"time_step",
       [](Settings& s, double x) { s.time_step = x == 0.0 ? 1.0 : x; }},  // 0 is the scenario's, 1 s too long
      {"max_tilt", [](Settings& s, double x) { s.max_tilt = x; }}};
  for (const auto& [key, set] : settings) {
    for (const double bad : {nan, -1.0, 0.0}) {
      Settings one = in_mode(Mode::Geometric);
      set(one, bad);
      EXPECT_EQ(key_of(one, {}), key) << bad;
    }
  }
  const std::vector<std::pair<std::string, double Parameters::*>> parameters{
      {"size_offset", &Parameters::size_offset},
      {"friction_scale", &Parameters::friction_scale},
      {"cup_scale", &Parameters::cup_scale},
      {"mass_scale", &Parameters::mass_scale}};
  for (const auto& [key, member] : parameters) {
    for (const double bad : {nan, infinite, -infinite, -1.0, 1e6}) {
      Parameters one;
      one.*member = bad;
      EXPECT_EQ(key_of(in_mode(Mode::Geometric), one), key) << bad;
    }
  }
  Settings counts = in_mode(Mode::Geometric);
  counts.max_candidates = 0;
  EXPECT_EQ(key_of(counts, {}), "max_candidates");
  counts = in_mode(Mode::Geometric);
  counts.max_steps = -1;
  EXPECT_EQ(key_of(counts, {}), "max_steps");
}

VectorEnvironment three(int threads) {
  std::vector<Environment> all;
  for (int i = 0; i < 3; ++i) all.emplace_back(cell_of_boxes(), in_mode(Mode::Geometric, ""));
  return {std::move(all), threads};
}

TEST(ManyEnvironments, RefuseMoreOrFewerSeedsAndActionsThanTheyAre) {
  VectorEnvironment all = three(1);
  const auto nothing = [](int, const Environment&) {};
  EXPECT_THROW(all.reset(std::vector<std::uint64_t>(2), nothing), InputError);
  all.reset(std::vector<std::uint64_t>{1, 2, 3}, nothing);
  std::vector<double> reward(3);
  std::vector<std::uint8_t> terminated(3), truncated(3);
  EXPECT_THROW(all.step(std::vector<Action>(4), {reward, terminated, truncated}, nothing), InputError);
}

TEST(ManyEnvironments, DoWhatEachDoesAlone) {
  VectorEnvironment all = three(2);
  all.reset(std::vector<std::uint64_t>{4, 5, 6}, [](int, const Environment&) {});
  std::vector<Environment> alone;
  for (std::uint64_t seed = 4; seed <= 6; ++seed) {
    alone.emplace_back(cell_of_boxes(), in_mode(Mode::Geometric, "")).reset(seed);
  }
  std::vector<double> reward(3);
  std::vector<std::uint8_t> terminated(3), truncated(3);
  for (int step = 0; step < 6; ++step) {
    all.step(std::vector<Action>(3, {.candidate = 0}), {reward, terminated, truncated},
             [&](int i, const Environment&) { EXPECT_GE(i, 0); });
    for (std::size_t i = 0; i < 3; ++i) {
      const Step own = alone[i].step({.candidate = 0});
      EXPECT_EQ(reward[i], own.reward);
      EXPECT_EQ(terminated[i] != 0, own.terminated);
      EXPECT_EQ(all.environment(static_cast<int>(i)).hash(), alone[i].hash());
    }
  }
}

TEST(ManyEnvironments, PassOnWhatAnObserverThrows) {
  for (const int threads : {1, 2}) {
    VectorEnvironment all = three(threads);
    const std::vector<std::uint64_t> seeds{1, 2, 3};
    EXPECT_THROW(all.reset(seeds,
                           [](int i, const Environment&) {
                             if (i == 1) throw std::runtime_error("full");
                           }),
                 std::runtime_error);
    int count = 0;
    all.reset(seeds, [&](int, const Environment&) {});
    for (int i = 0; i < all.count(); ++i) count += all.environment(i).has_ended() ? 0 : 1;
    EXPECT_EQ(count, 3) << "and goes on";
  }
}

TEST(ManyEnvironments, HaveEpisodesOfTheirOwnAfterTheFirst) {
  VectorEnvironment all = three(1);
  all.reset(std::vector<std::uint64_t>{1, 1, 2}, [](int, const Environment&) {});
  std::vector<double> reward(3);
  std::vector<std::uint8_t> terminated(3), truncated(3);
  // All end by an action that cannot be done, and begin anew in the next step.
  all.step(std::vector<Action>(3, {.candidate = 5000}), {reward, terminated, truncated},
           [](int, const Environment&) {});
  EXPECT_EQ(all.reason(0), "there is no such candidate");
  const std::vector<packing::Item> first = all.environment(0).items();
  all.step(std::vector<Action>(3, {.candidate = 0}), {reward, terminated, truncated}, [](int, const Environment&) {});
  EXPECT_EQ(reward, std::vector<double>(3, 0.0));
  EXPECT_TRUE(all.reason(0).empty());
  EXPECT_NE(all.environment(0).items(), first) << "another episode";
  EXPECT_EQ(all.environment(0).items(), all.environment(1).items()) << "of the same seed";
  EXPECT_NE(all.environment(0).items(), all.environment(2).items());
}

}  // namespace
}  // namespace snug::environment
