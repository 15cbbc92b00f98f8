// Film: closed forms of hoops and of the shear between them.
#include "snug/runs/internal/film.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace snug::runs::internal {
namespace {

/// Two boxes of 200 x 400 x 100 mm side by side: a square of 400 mm, one band high.
Film pair() { return Film({{{0.2, 0.4, 0.1}, Vector3::Zero()}, {{0.2, 0.4, 0.1}, Vector3::Zero()}}); }

std::vector<Pose> at(double left, double right) {
  return {{Matrix3::Identity(), {left, 0.0, 0.05}}, {Matrix3::Identity(), {right, 0.0, 0.05}}};
}

std::vector<Wrench> pull(const Film& film, const std::vector<Pose>& poses) {
  std::vector<Wrench> wrenches(poses.size());
  film.pull(poses, wrenches);
  return wrenches;
}

TEST(Film, PressesALoadTogetherByItsTensionAtTheCorners) {
  Film film = pair();
  film.wrap(at(-0.1, 0.1));
  const auto wrenches = pull(film, at(-0.1, 0.1));
  // Each side of the hoop pulls with 350 N/m over 0.1 m of height; two of them at either end.
  EXPECT_NEAR(wrenches[0].force.x(), 70.0, 1e-9);
  EXPECT_NEAR(wrenches[1].force.x(), -70.0, 1e-9);
  for (const Wrench& one : wrenches) {
    EXPECT_NEAR(one.force.y(), 0.0, 1e-9);
    EXPECT_NEAR(one.torque.norm(), 0.0, 1e-9);
  }
}

TEST(Film, PullsStretchesAndShearsAsManyTimesAsItHasLayers) {
  const FilmParams four, one = film_of(1), six = film_of(6);
  EXPECT_EQ(film_of(4).tension, four.tension);
  EXPECT_EQ(film_of(4).stretch_stiffness, four.stretch_stiffness);
  EXPECT_EQ(film_of(4).shear_stiffness, four.shear_stiffness);
  EXPECT_NEAR(six.tension, 6.0 * one.tension, 1e-9);
  EXPECT_NEAR(six.stretch_stiffness, 6.0 * one.stretch_stiffness, 1e-9);
  EXPECT_NEAR(six.shear_stiffness, 6.0 * one.shear_stiffness, 1e-9);
}

TEST(Film, HasAPartOfItsTensionAndNoShearWhileItIsWound) {
  const Film film = pair();
  const auto poses = at(-0.15, 0.11);  // wherever the load stands
  std::vector<Wrench> wrenches(2);
  film.wind(poses, 0.4, wrenches);
  EXPECT_NEAR(wrenches[0].force.x(), 0.4 * 70.0, 1e-9);
  EXPECT_NEAR(wrenches[1].force.x(), -0.4 * 70.0, 1e-9);
}

TEST(Film, PullsMoreWhereTheHoopGrows) {
  Film film = pair();
  film.wrap(at(-0.1, 0.1));
  const double out = 0.008;  // to both sides: no shear
  const auto wrenches = pull(film, at(-0.1 - out, 0.1 + out));
  EXPECT_NEAR(wrenches[0].force.x(), 2.0 * 0.1 * (350.0 + 6e3 * 4.0 * out / 1.6), 1e-9);
  EXPECT_NEAR(wrenches[0].force.x() + wrenches[1].force.x(), 0.0, 1e-9);
}

TEST(Film, ShearsUntilItWrinklesWhereAWholeBandMoves) {
  Film film = pair();
  film.wrap(at(-0.1, 0.1));
  for (const double moved : {0.002, 0.5}) {
    const auto wrenches = pull(film, at(-0.1 + moved, 0.1 + moved));
    const double flow = std::min(350.0, 2.2e3 * moved / 0.05);
    EXPECT_NEAR(wrenches[0].force.x() + wrenches[1].force.x(), -2.0 * 0.4 * flow, 1e-9) << moved;
  }
}

TEST(Film, DoesNothingToWhatFellOffAndHasNoForceOfItsOwn) {
  Film film(
      {{{0.4, 0.4, 0.1}, Vector3::Zero()}, {{0.4, 0.4, 0.1}, Vector3::Zero()}, {{0.1, 0.1, 0.1}, Vector3::Zero()}});
  std::vector<Pose> poses = {{Matrix3::Identity(), {0.0, 0.0, 0.05}},
                             {Matrix3::Identity(), {0.0, 0.0, 0.15}},
                             {Matrix3::Identity(), {0.0, 0.0, 0.25}}};
  film.wrap(poses);
  film.leave_out(2);
  poses[1].p += Vector3(0.003, -0.001, 0.0);
  poses[2].p.x() = 3.0;
  const auto wrenches = pull(film, poses);
  EXPECT_EQ(wrenches[2].force.norm(), 0.0);
  EXPECT_LT(wrenches[1].force.x(), 0.0);
  EXPECT_GT(wrenches[1].force.y(), 0.0);
  EXPECT_NEAR((wrenches[0].force + wrenches[1].force).norm(), 0.0, 1e-9) << "the lowest band has not moved";
}

}  // namespace
}  // namespace snug::runs::internal
