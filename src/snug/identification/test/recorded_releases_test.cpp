// Recorded releases: rows that belong together, refusals with their line, and the opening from the gap in closed form.
#include "snug/identification/recorded_releases.hpp"

#include <gtest/gtest.h>

#include <string>

#include "snug/identification/test/helpers.hpp"

namespace snug::identification {
namespace {

constexpr const char* kReleaseHead = "mass_kg,rep,t_s,E_z_m,B_z_m\n";

/// Rows of one recording, heights as the functions have them.
template <class Box>
std::string release_rows(const std::string& mass, const std::string& rep, int count, const Box& box) {
  std::string text;
  for (int i = 0; i < count; ++i)
    text += mass + "," + rep + "," + std::to_string(i / 360.0) + ",0.17," + std::to_string(box(i)) + "\n";
  return text;
}

const auto kHangs = [](int) { return 0.12; };

void expect_releases_refused(const std::string& rows, const std::string& part) {
  test::expect_refused([&] { (void)parse_recorded_releases(kReleaseHead + rows, "r.csv"); }, part);
}

TEST(RecordedReleases, AreOneForEachMassAndRepetition) {
  const std::vector<RecordedRelease> releases =
      parse_recorded_releases(kReleaseHead + release_rows("0.5", "1", 20, kHangs) +
                                  release_rows("0.5", "2", 21, kHangs) + release_rows("0.7", "2", 22, kHangs),
                              "r.csv");
  ASSERT_EQ(releases.size(), 3U);
  EXPECT_EQ(releases[0].times.size(), 20U);
  EXPECT_EQ(releases[1].times.size(), 21U);
  EXPECT_EQ(releases[2].mass, 0.7);
  EXPECT_EQ(releases[0].where, "r.csv:2");
  EXPECT_EQ(releases[1].where, "r.csv:22");
  EXPECT_TRUE(releases[0].lip.empty());
  EXPECT_EQ(releases[2].box.back(), 0.12);
}

TEST(RecordedReleases, ThatCannotBeUsedAreRefusedWithTheirLine) {
  expect_releases_refused("", "no rows");
  expect_releases_refused(release_rows("0.5", "1", 19, kHangs), "19 samples in this recording");
  expect_releases_refused(release_rows("0.5", "1", 20, kHangs) + release_rows("0.5", "2", 3, kHangs), "r.csv:22");
  expect_releases_refused(release_rows("0", "1", 20, kHangs), "a number above 0");
  expect_releases_refused(release_rows("0.5", "1", 20, kHangs) + "0.5,1,0.01,0.17,0.12\n", "r.csv:22");
  expect_releases_refused(release_rows("0.5", "1", 20, kHangs) + "0.5,1,0.01,0.17,0.12\n", "time that runs forward");
  // Millimetres: a box that "falls" by tens of metres.
  expect_releases_refused(release_rows("0.5", "1", 20, [](int i) { return 120.0 - 2.0 * i; }), "heights in metres");
  expect_releases_refused(release_rows("0.5", "1", 20, [](int) { return 0.18; }), "a gripper below the box");
  test::expect_refused([] { (void)load_recorded_releases("none.csv"); }, "none.csv");
}

/// A box that falls freely from `leaves` on, its lip standing still from there; before, both hang.
RecordedRelease falling_box(double leaves, double stretch) {
  RecordedRelease release;
  release.mass = 0.5;
  for (int i = 0; i < 60; ++i) {
    const double t = i / 360.0, fallen = t > leaves ? t - leaves : 0.0;
    release.times.push_back(t);
    release.gripper.push_back(0.17);
    // A steady fall: the gap is a straight line, which the fit follows exactly.
    release.box.push_back(0.12 - 0.4 * fallen);
    release.lip.push_back(0.1226 + (t > leaves - 0.015 && t <= leaves ? stretch : 0.0));
  }
  return release;
}

TEST(RecordedOpening, OfAStraightGapIsWhereItBegins) {
  for (const double leaves : {0.052, 0.0601, 0.08, 0.095})
    EXPECT_NEAR(find_recorded_opening(falling_box(leaves, 0.0)), leaves, 1e-12) << leaves;
}

TEST(RecordedOpening, DoesNotDependOnHeightOrClockOfTheRecord) {
  const RecordedRelease here = falling_box(0.07, 0.0);
  RecordedRelease there = here;
  for (std::vector<double>* heights : {&there.gripper, &there.box, &there.lip})
    for (double& height : *heights) height += 0.8;
  for (double& time : there.times) time += 12.0;
  EXPECT_NEAR(find_recorded_opening(there), find_recorded_opening(here) + 12.0, 1e-9);
}

TEST(RecordedOpening, LeavesOutTheStretchOfTheFoamBeforeIt) {
  // 2 mm of stretch in the 15 ms before: the line comes back to it 2 mm / 0.4 m/s later.
  const double plain = find_recorded_opening(falling_box(0.07, 0.0));
  EXPECT_NEAR(find_recorded_opening(falling_box(0.07, 0.002)) - plain, 0.002 / 0.4, 2e-3);
}

TEST(RecordedOpening, IsNotSeenWhereTheGapStaysSmallOrIsSeenTwice) {
  RecordedRelease stays = falling_box(0.07, 0.0);
  for (std::size_t i = 0; i < stays.lip.size(); ++i) stays.lip[i] = stays.box[i] + 0.0026;  // the lip goes with it
  EXPECT_LT(find_recorded_opening(stays), 0.0);
  RecordedRelease late = falling_box(0.155, 0.0);  // the record ends before the gap is 16 mm wide
  EXPECT_LT(find_recorded_opening(late), 0.0);
  RecordedRelease coarse = falling_box(0.07, 0.0);
  for (std::size_t i = 0; i < coarse.box.size(); ++i)
    if (coarse.times[i] > 0.07) coarse.box[i] = 0.0;  // from one sample to the next: no line through one point
  EXPECT_LT(find_recorded_opening(coarse), 0.0);
}

}  // namespace
}  // namespace snug::identification
