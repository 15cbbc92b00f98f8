// Environments: rules of the game, the three modes, snapshots, many at once.
#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/environment/vector_environment.hpp"

namespace snug::environment {
namespace {

const model::Scenario& demonstrator() {
  static const model::Scenario scenario =
      model::load_scenario(std::string(SNUG_SOURCE_DIR) + "/scenarios/box-demonstrator.yaml");
  return scenario;
}

Settings geometric() { return {}; }

Settings with_mode(Mode mode) {
  Settings settings;
  settings.mode = mode;
  settings.sequence = "1";
  return settings;
}

Action candidate(int index) { return {.candidate = index}; }

/// Sums up rewards of an episode of first candidates.
double play(Environment& environment) {
  double total = 0.0;
  while (!environment.has_ended()) total += environment.step(candidate(0)).reward;
  return total;
}

std::vector<float> height_map(const Environment& environment) {
  std::vector<float> map(static_cast<std::size_t>(environment.rows()) *
                         static_cast<std::size_t>(environment.columns()));
  environment.observe({.height_map = map, .item = {}, .boxes = {}, .candidates = {}, .mask = {}});
  return map;
}

TEST(Environment, RewardsAddUpToWhatIsPacked) {
  Environment environment(demonstrator(), geometric());
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    environment.reset(seed);
    const double total = play(environment);
    EXPECT_GT(total, 0.2);
    EXPECT_NEAR(100.0 * total, environment.packed_percent(), 1e-9);
  }
}

TEST(Environment, SameSeedSameBytesOtherSeedOtherItems) {
  Environment one(demonstrator(), geometric()), other(demonstrator(), geometric());
  one.reset(7);
  other.reset(7);
  play(one);
  play(other);
  EXPECT_EQ(one.hash(), other.hash());
  EXPECT_EQ(height_map(one), height_map(other));
  other.reset(8);
  EXPECT_NE(one.items(), other.items());
}

TEST(Environment, HeightMapIsTheTopsOfTheBoxes) {
  Environment environment(demonstrator(), geometric());
  environment.reset(1);
  for (int i = 0; i < 6 && !environment.has_ended(); ++i) (void)environment.step(candidate(0));
  const std::vector<float> map = height_map(environment);
  const Vector3 inner = demonstrator().containers.front().inner_size;
  for (int row = 0; row < environment.rows(); ++row) {
    for (int column = 0; column < environment.columns(); ++column) {
      double top = 0.0;
      for (const packing::PlacedBox& box : environment.boxes()) {
        const packing::Extent e = packing::bounding_extent(box);
        const double x = column * 0.01 - 0.5 * inner.x(), y = row * 0.01 - 0.5 * inner.y();
        const bool covers = e.low.x() < x + 0.01 - 1e-7 && e.high.x() > x + 1e-7 && e.low.y() < y + 0.01 - 1e-7 &&
                            e.high.y() > y + 1e-7;
        if (covers) top = std::max(top, e.high.z());
      }
      ASSERT_FLOAT_EQ(map[static_cast<std::size_t>(row * environment.columns() + column)], static_cast<float>(top))
          << row << ", " << column;
    }
  }
}

TEST(Environment, APlaceIsLoweredLikeTheCandidateThere) {
  Environment by_index(demonstrator(), geometric()), by_place(demonstrator(), geometric());
  by_index.reset(3);
  by_place.reset(3);
  while (!by_index.has_ended()) {
    const packing::Place place = by_index.candidates().front();
    const auto& all = Environment::orientations();
    Action action;
    action.orientation = static_cast<int>(std::ranges::find(all, place.orientation) - all.begin());
    action.x = place.low_T.x() + 0.5 * place.extents.x();
    action.y = place.low_T.y() + 0.5 * place.extents.y();
    const Step a = by_index.step(candidate(0)), b = by_place.step(action);
    ASSERT_EQ(a.reward, b.reward);
    ASSERT_EQ(a.reason, b.reason);
  }
  EXPECT_NEAR(by_index.packed_percent(), by_place.packed_percent(), 1e-12);
}

TEST(Environment, AnActionThatCannotBeDoneEndsTheEpisodeWithoutReward) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Action& action : {candidate(5000), Action{.orientation = 24}, Action{.orientation = -1}, Action{.x = nan},
                               Action{.x = 1e300}, Action{.candidate = -1, .orientation = 0, .x = 5.0, .y = 0.0}}) {
    Environment environment(demonstrator(), geometric());
    environment.reset(1);
    const Step step = environment.step(action);
    EXPECT_TRUE(step.terminated);
    EXPECT_EQ(step.reward, 0.0);
    EXPECT_FALSE(step.reason.empty());
    EXPECT_TRUE(environment.step(candidate(0)).terminated);
  }
}

TEST(Environment, IsTruncatedAfterAsManySteps) {
  Settings settings = geometric();
  settings.max_steps = 3;
  Environment environment(demonstrator(), settings);
  environment.reset(1);
  EXPECT_FALSE(environment.step(candidate(0)).truncated);
  EXPECT_FALSE(environment.step(candidate(0)).truncated);
  const Step last = environment.step(candidate(0));
  EXPECT_TRUE(last.truncated);
  EXPECT_FALSE(last.terminated);
}

TEST(Environment, ASequenceComesInItsOrder) {
  Environment environment(demonstrator(), with_mode(Mode::Geometric));
  environment.reset(99);
  const model::Sequence& sequence = *model::find_sequence(demonstrator(), "1");
  for (std::size_t i = 0; i < sequence.items.size(); ++i) {
    EXPECT_EQ(environment.items()[i].id, sequence.items[i].parcel);
  }
}

TEST(Environment, VariationIsDrawnAnewForEachSeed) {
  Settings settings = with_mode(Mode::Geometric);
  settings.varies = true;
  model::Scenario scenario = demonstrator();
  scenario.uncertainty = model::no_uncertainty();
  scenario.uncertainty.size = 0.002;
  Environment environment(scenario, settings);
  environment.reset(1);
  const Vector3 first = environment.items().front().size;
  environment.reset(2);
  EXPECT_NE(environment.items().front().size, first);
  EXPECT_LE((environment.items().front().size - first).cwiseAbs().maxCoeff(), 0.004);
  environment.reset(1);
  EXPECT_EQ(environment.items().front().size, first);
}

TEST(Environment, ParametersChangeItsOwnBoxes) {
  const Environment plain(demonstrator(), with_mode(Mode::Geometric));
  const Environment other(demonstrator(), with_mode(Mode::Geometric), {.size_offset = 0.001, .mass_scale = 2.0});
  EXPECT_NEAR(other.items()[0].size.x() - plain.items()[0].size.x(), 0.001, 1e-12);
  EXPECT_NEAR(other.items()[0].mass, 2.0 * plain.items()[0].mass, 1e-12);
}

class Physical : public testing::TestWithParam<Mode> {};
INSTANTIATE_TEST_SUITE_P(Modes, Physical, testing::Values(Mode::Statics, Mode::Executed),
                         [](const auto& mode) { return mode.param == Mode::Statics ? "Statics" : "Executed"; });

TEST_P(Physical, BoxesRestWhereTheyWerePut) {
  Environment environment(demonstrator(), with_mode(GetParam()));
  environment.reset(1);
  for (int i = 0; i < 4; ++i) {
    const Step step = environment.step(candidate(0));
    ASSERT_TRUE(step.is_placed) << step.reason;
    EXPECT_LT(step.displacement, 0.02);
    EXPECT_GT(step.reward, 0.0);
  }
  EXPECT_GT(environment.time(), 0.0);
}

TEST_P(Physical, ASnapshotGoesOnWithTheSameBytes) {
  Environment environment(demonstrator(), with_mode(GetParam()));
  environment.reset(1);
  (void)environment.step(candidate(0));
  Environment copy = environment;
  (void)environment.step(candidate(1));
  (void)copy.step(candidate(1));
  EXPECT_EQ(environment.hash(), copy.hash());
  (void)environment.step(candidate(0));
  EXPECT_NE(environment.hash(), copy.hash());
}

TEST(Statics, ABoxThatCannotStayIsNotPlaced) {
  Settings settings = with_mode(Mode::Statics);
  settings.packing.min_support = 0.0;
  settings.packing.max_flips = 0;
  Environment environment(demonstrator(), settings);
  // Some episode of far-off corners over others: with no support asked for a box is put over an edge and falls.
  bool has_fallen = false;
  Rng rng = Rng(5).split("choices");
  for (std::uint64_t seed = 0; seed < 20 && !has_fallen; ++seed) {
    environment.reset(seed);
    Step step;
    while (!environment.has_ended()) {
      step = environment.step(candidate(rng.index(static_cast<int>(environment.candidates().size()))));
    }
    has_fallen = !step.is_placed;
    EXPECT_FALSE(step.reason.empty());
  }
  EXPECT_TRUE(has_fallen);
}

TEST(Environment, RefusesWhatCannotBe) {
  Settings settings = geometric();
  settings.sequence = "none";
  EXPECT_THROW(Environment(demonstrator(), settings), InputError);
  settings = geometric();
  settings.resolution = 1e-4;
  EXPECT_THROW(Environment(demonstrator(), settings), InputError);
  settings = geometric();
  settings.resolution = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Environment(demonstrator(), settings), InputError);
  EXPECT_THROW(Environment(demonstrator(), geometric(), {.size_offset = -1.0}), InputError);
  const model::Scenario drop = model::load_scenario(std::string(SNUG_SOURCE_DIR) + "/scenarios/drop.yaml");
  EXPECT_THROW(Environment(drop, geometric()), InputError);
}

struct Batch {
  std::vector<double> reward;
  std::vector<std::uint8_t> terminated, truncated;
  std::vector<std::uint64_t> hashes;
  bool operator==(const Batch&) const = default;
};

/// Everything that happens in so many steps, the k-th environment always taking its k-th candidate.
std::vector<Batch> roll(VectorEnvironment& all, int steps) {
  const auto count = static_cast<std::size_t>(all.count());
  std::vector<std::uint64_t> seeds(count);
  for (std::size_t i = 0; i < count; ++i) seeds[i] = 100 + i;
  all.reset(seeds, [](int, const Environment&) {});
  std::vector<Batch> history;
  std::vector<Action> actions(count);
  for (int step = 0; step < steps; ++step) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto& places = all.environment(static_cast<int>(i)).candidates();
      actions[i].candidate = places.empty() ? 0 : static_cast<int>(i % places.size());
    }
    Batch batch{std::vector<double>(count), std::vector<std::uint8_t>(count), std::vector<std::uint8_t>(count),
                std::vector<std::uint64_t>(count)};
    all.step(actions, {batch.reward, batch.terminated, batch.truncated},
             [&](int i, const Environment& e) { batch.hashes[static_cast<std::size_t>(i)] = e.hash(); });
    history.push_back(std::move(batch));
  }
  return history;
}

VectorEnvironment many(int threads, Mode mode, int count) {
  std::vector<Environment> environments;
  for (int i = 0; i < count; ++i) {
    environments.emplace_back(demonstrator(), with_mode(mode),
                              Parameters{.size_offset = 0.0005 * (i % 3), .friction_scale = 1.0 + 0.1 * (i % 2)});
  }
  return {std::move(environments), threads};
}

TEST(VectorEnvironment, ThreadsChangeNothing) {
  for (const Mode mode : {Mode::Geometric, Mode::Statics}) {
    VectorEnvironment one = many(1, mode, 7), three = many(3, mode, 7);
    EXPECT_EQ(roll(one, mode == Mode::Geometric ? 60 : 10), roll(three, mode == Mode::Geometric ? 60 : 10));
  }
}

TEST(VectorEnvironment, OneThatHasEndedBeginsAnewInTheNextStep) {
  VectorEnvironment all = many(2, Mode::Geometric, 3);
  const std::vector<Batch> history = roll(all, 60);
  int ends = 0;
  for (std::size_t step = 0; step + 1 < history.size(); ++step) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (history[step].terminated[i] == 0) continue;
      ++ends;
      EXPECT_EQ(history[step + 1].reward[i], 0.0);
      EXPECT_EQ(history[step + 1].terminated[i], 0);
    }
  }
  EXPECT_GT(ends, 3);
}

TEST(VectorEnvironment, RefusesEnvironmentsThatAreNotAlike) {
  std::vector<Environment> two;
  two.emplace_back(demonstrator(), with_mode(Mode::Geometric));
  Settings other = with_mode(Mode::Geometric);
  other.resolution = 0.02;
  two.emplace_back(demonstrator(), other);
  EXPECT_THROW(VectorEnvironment(std::move(two), 1), InputError);
  EXPECT_THROW(VectorEnvironment({}, 1), InputError);
}

}  // namespace
}  // namespace snug::environment
