// Insertion: what is beside a place decides how a box is brought there, the same way along both axes.
#include "snug/skills/insertion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "snug/core/rng.hpp"

namespace snug::skills {
namespace {

const Vector3 kSize(0.2, 0.16, 0.1);
const settings::InsertionParams kParams;

/// A place with nothing beside it: low x, high x, low y, high y.
packing::Candidate free_place() {
  packing::Candidate candidate;
  candidate.placement.X_TP.p.z() = 0.05;
  candidate.side_gap = {0.3, 0.3, 0.3, 0.3};
  candidate.side_height = {0.2, 0.2, 0.2, 0.2};
  return candidate;
}

packing::Candidate with_gap(packing::Candidate candidate, std::size_t side, double gap, double height = 0.08) {
  candidate.side_gap[side] = gap;
  candidate.side_height[side] = height;
  return candidate;
}

std::vector<Insertion> insertions_of(const packing::Candidate& candidate) {
  const auto insertions = choose_insertions(candidate, kSize, kParams);
  EXPECT_FALSE(insertions.empty());
  return insertions;
}

/// The scene seen from the other side of the plane across `axis`.
packing::Candidate mirrored(packing::Candidate candidate, std::size_t axis) {
  std::swap(candidate.side_gap[2 * axis], candidate.side_gap[2 * axis + 1]);
  std::swap(candidate.side_height[2 * axis], candidate.side_height[2 * axis + 1]);
  return candidate;
}

/// The scene with x and y exchanged.
packing::Candidate exchanged(packing::Candidate candidate) {
  for (std::size_t i = 0; i < 2; ++i) {
    std::swap(candidate.side_gap[i], candidate.side_gap[i + 2]);
    std::swap(candidate.side_height[i], candidate.side_height[i + 2]);
  }
  return candidate;
}

/// `image` maps every vector of `before` to that of `after`.
template <class Image>
void expect_image(const std::vector<Insertion>& before, const std::vector<Insertion>& after, Image&& image) {
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(after[i].skill, before[i].skill);
    EXPECT_EQ(after[i].gentle, before[i].gentle);
    EXPECT_EQ(after[i].come_from_T, image(before[i].come_from_T));
    EXPECT_EQ(after[i].overtravel_T, image(before[i].overtravel_T));
    EXPECT_EQ(after[i].low_side_T, image(before[i].low_side_T));
    EXPECT_EQ(after[i].push_T, image(before[i].push_T));
    EXPECT_EQ(after[i].edge_height_T, before[i].edge_height_T);
  }
}

packing::Candidate random_candidate(Rng& rng) {
  packing::Candidate candidate = free_place();
  for (std::size_t side = 0; side < 4; ++side) {
    candidate.side_gap[side] = rng.index(2) == 0 ? rng.uniform(-0.01, 0.02) : rng.uniform(0.0, 0.3);
    candidate.side_height[side] = rng.uniform(0.0, 0.2);
  }
  return candidate;
}

TEST(ChooseInsertions, SeeAMirroredSceneMirroredAndATurnedOneTurned) {
  Rng rng(21);
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    const packing::Candidate candidate = random_candidate(rng);
    const auto before = insertions_of(candidate);
    for (const int axis : {0, 1}) {
      expect_image(before, insertions_of(mirrored(candidate, static_cast<std::size_t>(axis))), [&](Vector3 v) {
        v[axis] = -v[axis];
        return v;
      });
    }
    expect_image(before, choose_insertions(exchanged(candidate), Vector3(kSize.y(), kSize.x(), kSize.z()), kParams),
                 [](const Vector3& v) { return Vector3(v.y(), v.x(), v.z()); });
  }
}

TEST(ChooseInsertions, NeverComeFromBeyondTheGapAndPushOnlyAgainstWhatIsNear) {
  Rng rng(22);
  int slides = 0;
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE(i);
    const packing::Candidate candidate = random_candidate(rng);
    const auto insertions = insertions_of(candidate);
    EXPECT_NE(insertions[0].skill, InsertionSkill::Tilted) << "what is plain comes first";
    for (const Insertion& one : insertions) {
      EXPECT_EQ(one.come_from_T.z(), 0.0);
      EXPECT_EQ(one.overtravel_T.z(), 0.0);
      if (one.skill != InsertionSkill::SlideToContact) continue;
      for (const int axis : {0, 1}) {
        const double from = one.come_from_T[axis], to = one.overtravel_T[axis];
        EXPECT_EQ(from == 0.0, to == 0.0);
        if (from == 0.0) continue;
        ++slides;
        EXPECT_LT(from * to, 0.0) << "away from what it is pushed against";
        const auto away = static_cast<std::size_t>(2 * axis + (from > 0.0 ? 1 : 0)), against = away ^ 1U;
        EXPECT_LE(std::abs(from), candidate.side_gap[away] - kParams.slide_margin + 1e-15);
        EXPECT_LE(std::abs(from), kParams.slide_start);
        EXPECT_LT(candidate.side_gap[against], kParams.near);
        EXPECT_GT(candidate.side_height[against], kParams.least_neighbour);
        EXPECT_NEAR(std::abs(to), kParams.overtravel * (one.gentle ? kParams.gentle : 1.0), 1e-15);
      }
    }
  }
  EXPECT_GT(slides, 500);
}

TEST(ChooseInsertionsOnSupport, ComeDownWhereASlideDoesAndNeverTilt) {
  Rng rng(24);
  int slides = 0;
  for (int i = 0; i < 500; ++i) {
    SCOPED_TRACE(i);
    const packing::Candidate candidate = random_candidate(rng);
    const Insertion hanging = insertions_of(candidate)[0];
    const auto insertions = choose_insertions_on_support(candidate, kParams);
    ASSERT_EQ(insertions.size(), 1U);
    const bool is_slide = hanging.skill == InsertionSkill::SlideToContact;
    slides += is_slide ? 1 : 0;
    EXPECT_EQ(insertions[0].skill, is_slide ? InsertionSkill::SlideOnSupport : InsertionSkill::TopDown);
    EXPECT_EQ(insertions[0].come_from_T, hanging.come_from_T);
    EXPECT_EQ(insertions[0].overtravel_T, hanging.overtravel_T);
  }
  EXPECT_GT(slides, 100);
}

TEST(ChooseInsertions, ComeDownBesideNothingWhereTheMarginTakesAllTheRoom) {
  settings::InsertionParams params = kParams;
  params.slide_margin = 3.0 * params.slide_room;
  Rng rng(23);
  for (int i = 0; i < 500; ++i) {
    const packing::Candidate candidate = random_candidate(rng);
    for (const Insertion& one : choose_insertions(candidate, kSize, params)) {
      if (one.skill != InsertionSkill::SlideToContact) continue;
      for (const int axis : {0, 1}) EXPECT_LE(one.come_from_T[axis] * one.overtravel_T[axis], 0.0) << i;
    }
  }
}

TEST(ChooseInsertions, GoStraightDownWhereNothingIsNear) {
  const auto insertions = insertions_of(free_place());
  ASSERT_EQ(insertions.size(), 1U);
  EXPECT_EQ(insertions[0].skill, InsertionSkill::TopDown);
  EXPECT_TRUE(insertions[0].come_from_T.isZero() && insertions[0].overtravel_T.isZero());
  EXPECT_FALSE(insertions[0].gentle);
}

TEST(ChooseInsertions, KeepTheirLimitsToTheMicrometre) {
  constexpr double kLittle = 1e-6;
  for (std::size_t side = 0; side < 4; ++side) {
    SCOPED_TRACE(side);
    const auto slides = [&](double gap, double height, double opposite) {
      const auto insertions = insertions_of(with_gap(with_gap(free_place(), side, gap, height), side ^ 1U, opposite));
      EXPECT_EQ(insertions.size(), insertions[0].skill == InsertionSkill::SlideToContact ? 2U : 1U);
      EXPECT_EQ(insertions.back().gentle, insertions[0].skill == InsertionSkill::SlideToContact);
      return insertions[0].skill == InsertionSkill::SlideToContact;
    };
    const double near = kParams.near, low = kParams.least_neighbour, room = kParams.slide_room;
    EXPECT_TRUE(slides(near - kLittle, low + kLittle, room + kLittle));
    EXPECT_FALSE(slides(near + kLittle, low + kLittle, room + kLittle));
    EXPECT_FALSE(slides(near - kLittle, low - kLittle, room + kLittle));
    EXPECT_FALSE(slides(near - kLittle, low + kLittle, room - kLittle));
    EXPECT_TRUE(slides(-0.005, 0.1, 0.3)) << "a neighbour believed inside is near";
    // All of the free side but the margin, until that is more than a slide needs.
    const double whole = kParams.slide_start + kParams.slide_margin;
    for (const double gap : {0.009, whole - kLittle, whole + kLittle, 0.1}) {
      const auto insertions = insertions_of(with_gap(with_gap(free_place(), side, 0.0), side ^ 1U, gap));
      EXPECT_NEAR(insertions[0].come_from_T.norm(), std::min(kParams.slide_start, gap - kParams.slide_margin), 1e-15);
    }
  }
}

TEST(ChooseInsertions, TiltBothWaysIntoASlotTheTallerNeighbourPushedAgainst) {
  for (const double difference : {0.01, 0.05}) {  // less and more than what counts as taller
    const double tall = 0.02 + difference;
    const auto insertions = insertions_of(with_gap(with_gap(free_place(), 0, 0.001, tall), 1, 0.002, 0.02));
    ASSERT_EQ(insertions.size(), 3U);
    EXPECT_EQ(insertions[0].skill, InsertionSkill::TopDown);
    for (const std::size_t i : {1U, 2U}) {
      EXPECT_EQ(insertions[i].skill, InsertionSkill::Tilted);
      EXPECT_NEAR(insertions[i].edge_height_T, 0.02, 1e-15) << "over the lower of both, from the floor";
      EXPECT_EQ(insertions[i].come_from_T, -insertions[i].push_T);
      EXPECT_NEAR(insertions[i].push_T.norm(), kParams.tilted.push, 1e-15);
    }
    EXPECT_EQ(insertions[1].low_side_T, Vector3::UnitX()) << "over the lower neighbour";
    EXPECT_EQ(insertions[1].push_T.x() < 0.0, difference > kParams.tilted.taller);
    EXPECT_EQ(insertions[2].low_side_T, -insertions[1].low_side_T);
    EXPECT_EQ(insertions[2].push_T, -insertions[1].push_T);
  }
  // Tight along both: the tighter one; along one and beside a neighbour along the other: it slides there too.
  packing::Candidate both = with_gap(with_gap(free_place(), 0, 0.002), 1, 0.003);
  EXPECT_EQ(insertions_of(with_gap(with_gap(both, 2, 0.001), 3, 0.003))[1].low_side_T.x(), 0.0);
  const auto corner = insertions_of(with_gap(both, 2, 0.001));
  ASSERT_EQ(corner.size(), 3U);
  EXPECT_EQ(corner[0].skill, InsertionSkill::SlideToContact);
  for (const Insertion& one : corner) {
    EXPECT_NEAR(one.come_from_T.y(), kParams.slide_start, 1e-15);
    EXPECT_NEAR(one.overtravel_T.y(), -kParams.overtravel, 1e-15);
  }
  EXPECT_NEAR(corner[1].push_T.y(), -kParams.overtravel, 1e-15);
}

}  // namespace
}  // namespace snug::skills
