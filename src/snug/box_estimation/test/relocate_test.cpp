// relocate and best_together: which boxes have which places.
#include "snug/box_estimation/internal/relocate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "snug/box_estimation/test/scene.hpp"

namespace snug::box_estimation::internal {
namespace {

using namespace test;

Place place_at(std::size_t lost, double x, double gain) {
  Place place;
  place.lost = lost;
  place.gain = gain;
  place.box.half = Vector3(0.05, 0.05, 0.05);
  place.box.X_CP.p = Vector3(x, 0, 1.0);
  return place;
}

bool are_possible(const std::vector<Place>& places, double most_overlap) {
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (places[i].lost == places[k].lost || overlap(places[i].box, places[k].box) > most_overlap) return false;
    }
  }
  return true;
}

double gain_of(const std::vector<Place>& places) {
  double sum = 0.0;
  for (const Place& place : places) sum += place.gain;
  return sum;
}

/// The slow way: every subset.
double best_gain(const std::vector<Place>& places, double most_overlap) {
  double best = 0.0;
  for (std::size_t set = 0; set < (std::size_t{1} << places.size()); ++set) {
    std::vector<Place> chosen;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if ((set >> i & 1U) != 0) chosen.push_back(places[i]);
    }
    if (are_possible(chosen, most_overlap)) best = std::max(best, gain_of(chosen));
  }
  return best;
}

TEST(BestTogether, IsAsGoodAsTheBestOfAllSubsets) {
  const RelocationSettings settings;
  Rng rng = Rng(9).split("best together");
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const auto lost = static_cast<std::size_t>(1 + rng.index(4)), count = static_cast<std::size_t>(rng.index(10));
    std::vector<Place> places;
    for (std::size_t k = 0; k < count; ++k) {
      places.push_back(place_at(static_cast<std::size_t>(rng.index(static_cast<int>(lost))), rng.uniform(0.0, 0.5),
                                rng.uniform(-200.0, 1000.0)));
    }
    const std::vector<Place> best = best_together(places, lost, settings);
    EXPECT_TRUE(are_possible(best, settings.most_overlap));
    EXPECT_NEAR(gain_of(best), best_gain(places, settings.most_overlap), 1e-9);
  }
}

TEST(BestTogether, TakesTheSecondBestPlaceWhereAnotherBoxFitsNowhereElse) {
  const RelocationSettings settings;
  const std::vector<Place> places = {place_at(0, 0.0, 500.0), place_at(0, 0.3, 450.0), place_at(1, 0.0, 400.0)};
  const std::vector<Place> best = best_together(places, 2, settings);
  ASSERT_EQ(best.size(), 2u);
  EXPECT_EQ(gain_of(best), 850.0);
}

TEST(BestTogether, BoxesMayTouchButNotLieInEachOther) {
  RelocationSettings settings;
  const std::vector<Place> places = {place_at(0, 0.0, 100.0), place_at(1, 0.085, 100.0)};  // 15 mm in each other
  EXPECT_EQ(best_together(places, 2, settings).size(), 2u);
  settings.most_overlap = 0.010;
  EXPECT_EQ(best_together(places, 2, settings).size(), 1u);
}

TEST(BestTogether, WithoutTriesLeftWhatItHasIsStillPossible) {
  RelocationSettings settings;
  settings.most_tries = 3;
  std::vector<Place> places;
  for (std::size_t k = 0; k < 8; ++k) {
    for (int at = 0; at < 6; ++at) places.push_back(place_at(k, 0.06 * at, 100.0 + static_cast<double>(k)));
  }
  EXPECT_TRUE(are_possible(best_together(places, 8, settings), settings.most_overlap));
  EXPECT_TRUE(best_together({}, 3, settings).empty());
}

TEST(BestTogether, AsksForNoOrderOfThePlaces) {
  const RelocationSettings settings;
  Rng rng = Rng(10).split("order of places");
  for (int i = 0; i < 100; ++i) {
    std::vector<Place> places;
    for (int k = 0; k < 9; ++k) {
      const double x = rng.uniform(0.0, 0.5), gain = rng.uniform(-200.0, 1000.0);
      places.push_back(place_at(static_cast<std::size_t>(rng.index(3)), x, gain));
    }
    const double gain = gain_of(best_together(places, 3, settings));
    std::ranges::reverse(places);
    EXPECT_NEAR(gain_of(best_together(places, 3, settings)), gain, 1e-9);
  }
}

/// A frame of boxes, of which none is known where it is.
struct Search {
  explicit Search(const std::vector<Box>& boxes)
      : scene(boxes, "structured_light"),
        input(make_input(scene.cell.scenario, scene.cell.scenario.containers.front())) {}

  [[nodiscard]] std::vector<Place> run(const std::vector<Lost>& lost) const {
    const std::vector<TrackedBox> none;
    return relocate({scene.context(), input, none, 4e-3}, lost);
  }
  [[nodiscard]] Lost lost(const Vector3& size, const Pose& X_WP_before) const {
    return {{0.5 * size, scene.cell.camera.X_WC.inverse() * X_WP_before}, 1.0, false, std::nullopt};
  }
  [[nodiscard]] double error(const Place& place, const Box& box) const {
    return (scene.cell.camera.X_WC * place.box.X_CP.p - box.X_WP.p).norm();
  }

  FitScene scene;
  EstimateInput input;
};

TEST(Relocate, FindsABoxThatWasMovedAndTurned) {
  const Box now{"a", Vector3(0.18, 0.12, 0.08), level(0.06, 0.14, 0.04, 0.8)};
  const Search search({now});
  const std::vector<Place> places = search.run({search.lost(now.size, level(-0.08, -0.18, 0.04))});
  ASSERT_EQ(places.size(), 1u);
  EXPECT_LT(search.error(places[0], now), 3e-3);
  EXPECT_GT(places[0].gain, search.scene.settings.relocation.least_gain);
}

TEST(Relocate, FindsNothingForABoxThatIsNotThere) {
  const Search search({});
  EXPECT_TRUE(search.run({search.lost(Vector3(0.18, 0.12, 0.08), level(0, 0, 0.04))}).empty());
}

TEST(Relocate, GivesTwoBoxesThePlacesThatTheirSizesSay) {
  const std::vector<Box> now = {{"a", Vector3(0.18, 0.12, 0.08), level(-0.05, 0.16, 0.04, 0.2)},
                                {"b", Vector3(0.15, 0.10, 0.08), level(0.05, -0.14, 0.04, -0.3)}};
  const Search search(now);
  const std::vector<Place> places =
      search.run({search.lost(now[0].size, now[1].X_WP), search.lost(now[1].size, now[0].X_WP)});
  ASSERT_EQ(places.size(), 2u);
  for (const Place& place : places) EXPECT_LT(search.error(place, now[place.lost]), 3e-3) << place.lost;
}

TEST(Relocate, AsksForNoOrderOfTheLost) {
  const std::vector<Box> now = {{"a", Vector3(0.18, 0.12, 0.08), level(-0.05, 0.16, 0.04, 0.2)},
                                {"b", Vector3(0.15, 0.10, 0.06), level(0.05, -0.14, 0.03, -0.3)}};
  const Search search(now);
  const std::vector<Lost> lost = {search.lost(now[0].size, level(0.0, 0.0, 0.04)),
                                  search.lost(now[1].size, level(0.0, 0.0, 0.03))};
  const std::vector<Place> a = search.run(lost), b = search.run({lost[1], lost[0]});
  ASSERT_EQ(a.size(), 2u);
  ASSERT_EQ(b.size(), 2u);
  for (const Place& place : a) {
    const Place& other = b[0].lost == 1 - place.lost ? b[0] : b[1];
    EXPECT_EQ(other.box.X_CP, place.box.X_CP);
    EXPECT_EQ(other.gain, place.gain);
  }
}

}  // namespace
}  // namespace snug::box_estimation::internal
