// ObstacleMemory: what is remembered from look to look, what is forgotten, and bodies that leave boxes alone.
#include "snug/session/obstacles.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "snug/core/rng.hpp"
#include "snug/geometry/bounds.hpp"

namespace snug::session {
namespace {

using perception::Column;
using perception::kColumnSide;
using perception::Observation;
using perception::Obstacle;

const Pose kX_WT{Matrix3::Identity(), Vector3(0.0, 0.0, -0.2)};
constexpr double kFloor = -0.2;

Obstacle thing(int x1, int y1, int x2, int y2, double top) {
  Obstacle one;
  one.deviation = 0.0005;
  for (int y = y1; y < y2; ++y)
    for (int x = x1; x < x2; ++x) one.columns.push_back({x, y, top});
  return one;
}

/// A camera's look: a map of 100 x 100 columns around the origin, the floor but where obstacles are.
Observation look(const std::vector<Obstacle>& obstacles, double time = 1.0) {
  Observation seen;
  seen.time = time;
  seen.obstacles = obstacles;
  seen.heights = perception::HeightMap{-50, -50, 100, 100, std::vector<float>(10000, static_cast<float>(kFloor))};
  for (const Obstacle& one : obstacles) {
    for (const Column& c : one.columns) {
      seen.heights->height[static_cast<std::size_t>((c.y + 50) * 100 + c.x + 50)] = static_cast<float>(c.top);
    }
  }
  return seen;
}

void see(ObstacleMemory& memory, const Observation& seen, const std::vector<Solid>& boxes = {}) {
  memory.see(seen, memory.find_foreign(seen, boxes), boxes);
}

TEST(ObstacleMemory, RemembersWhatItSawWithPlaceAndHeight) {
  ObstacleMemory memory(kX_WT);
  see(memory, look({thing(10, 4, 22, 18, -0.13)}, 7.5));
  ASSERT_EQ(memory.reports().size(), 1U);
  const ObstacleReport& report = memory.reports()[0];
  EXPECT_EQ(report.number, 1);
  EXPECT_EQ(report.seen, 7.5);
  EXPECT_FALSE(report.gone);
  EXPECT_NEAR(report.high_T.z(), 0.07, 1e-12);
  EXPECT_NEAR(report.low_T.x(), 0.05, 1e-12);
  EXPECT_NEAR(report.high_T.y(), 0.09, 1e-12);
  const auto regions = memory.regions();
  ASSERT_EQ(regions.size(), 1U);
  EXPECT_NEAR(regions[0].lower.x(), 0.05 - 0.001, 1e-12) << "grown by two deviations";
  EXPECT_NEAR(regions[0].upper.z(), -0.13 + 0.001, 1e-12);
  EXPECT_NEAR(regions[0].lower.z(), kFloor, 1e-12);
}

TEST(ObstacleMemory, ForgetsWhatIsGoneWhereTheFloorIsSeenAgain) {
  ObstacleMemory memory(kX_WT);
  see(memory, look({thing(0, 0, 10, 10, -0.13)}, 1.0));
  see(memory, look({}, 2.0));
  EXPECT_TRUE(memory.obstacles().empty());
  EXPECT_TRUE(memory.regions().empty());
  EXPECT_EQ(memory.reports()[0].gone, 2.0);
}

TEST(ObstacleMemory, KeepsWhatIsHiddenAndWhatALookTellsNothingOf) {
  ObstacleMemory memory(kX_WT);
  const Obstacle one = thing(0, 0, 10, 10, -0.13);
  see(memory, look({one}));
  Observation hidden = look({});
  for (float& z : hidden.heights->height) z = perception::HeightMap::kUnseen;
  see(memory, hidden);
  EXPECT_EQ(memory.obstacles().size(), 1U);
  Observation covered = look({});  // a box over it
  for (float& z : covered.heights->height) z = 0.0F;
  see(memory, covered);
  EXPECT_EQ(memory.obstacles().size(), 1U);
  see(memory, Observation{});
  EXPECT_EQ(memory.obstacles()[0].columns.size(), one.columns.size());
}

TEST(ObstacleMemory, FollowsWhatIsPushed) {
  ObstacleMemory memory(kX_WT);
  see(memory, look({thing(0, 0, 10, 10, -0.13)}));
  see(memory, look({thing(3, 0, 13, 10, -0.13)}));
  ASSERT_EQ(memory.obstacles().size(), 1U);
  EXPECT_EQ(memory.obstacles()[0].number, 1);
  EXPECT_NEAR(memory.reports()[0].low_T.x(), 0.015, 1e-12);
  see(memory, look({thing(3, 0, 13, 10, -0.13), thing(-30, 0, -20, 10, -0.1)}));
  EXPECT_EQ(memory.reports().size(), 2U);
  EXPECT_EQ(memory.reports()[1].number, 2);
}

TEST(ObstacleMemory, ALookThatSeesEverythingForgetsWhatItDoesNotShow) {
  ObstacleMemory memory(kX_WT);
  Observation seen;
  seen.obstacles = {thing(0, 0, 10, 10, -0.13)};
  see(memory, seen);
  EXPECT_EQ(memory.obstacles().size(), 1U);
  seen.obstacles->clear();
  see(memory, seen);
  EXPECT_TRUE(memory.obstacles().empty());
}

TEST(ObstacleMemory, ABoxThatIsBelievedThereIsNoObstacleAndWhatLiesOnItIs) {
  const Solid box{{Matrix3::Identity(), Vector3(0.05, 0.05, -0.15)}, Vector3(0.1, 0.1, 0.1)};
  ObstacleMemory memory(kX_WT);
  // Its own points, some millimetres over where it is believed to be.
  see(memory, look({thing(0, 0, 20, 20, -0.094)}), {box});
  EXPECT_TRUE(memory.obstacles().empty());
  see(memory, look({thing(4, 4, 12, 12, -0.05)}), {box});
  ASSERT_EQ(memory.obstacles().size(), 1U);
  // Estimated at last: what was taken for an obstacle is the box.
  const Solid found{{Matrix3::Identity(), Vector3(0.04, 0.04, -0.07)}, Vector3(0.06, 0.06, 0.04)};
  see(memory, look({}), {box, found});
  EXPECT_TRUE(memory.obstacles().empty());
}

TEST(ObstacleMemory, WhatABoxBridgesIsRemembered) {
  ObstacleMemory memory(kX_WT);
  see(memory, look({thing(0, 0, 10, 10, -0.13)}));
  Observation covered = look({});
  for (float& z : covered.heights->height) z = -0.02F;
  const Solid bridge{{Matrix3::Identity(), Vector3(0.025, 0.025, -0.072)}, Vector3(0.3, 0.2, 0.1)};  // 8 mm over it
  see(memory, covered, {bridge});
  EXPECT_EQ(memory.obstacles().size(), 1U);
  EXPECT_FALSE(memory.reports()[0].gone);
}

TEST(ObstacleMemory, SmallThingsAreNoise) {
  const ObstacleMemory memory(kX_WT);
  EXPECT_TRUE(memory.find_foreign(look({thing(0, 0, 3, 3, -0.1)}), {}).empty());
  EXPECT_EQ(memory.find_foreign(look({thing(0, 0, 4, 3, -0.1)}), {}).size(), 1U);
  EXPECT_TRUE(memory.find_foreign(look({thing(0, 0, 20, 20, kFloor + 0.009)}), {}).empty());
}

TEST(ObstacleMemory, NewsAreWhatIsNeitherKnownNorSeenBefore) {
  ObstacleMemory memory(kX_WT);
  const Obstacle one = thing(0, 0, 10, 10, -0.13), other = thing(30, 0, 40, 10, -0.13);
  EXPECT_TRUE(memory.has_news({one}));
  EXPECT_FALSE(memory.has_news({one}, {one, other}));
  see(memory, look({one}));
  EXPECT_FALSE(memory.has_news({one}));
  EXPECT_TRUE(memory.has_news({one, other}));
  EXPECT_FALSE(memory.has_news({}));
}

/// Bodies that stand in boxes would push them away when a rehearsal begins.
TEST(ObstacleBodies, StopBesideBoxesAndOverThoseUnderThem) {
  const Solid beside{{Matrix3::Identity(), Vector3(0.05, 0.0, -0.15)}, Vector3(0.1, 0.2, 0.1)};
  const geometry::Aabb reaching{Vector3(0.094, -0.03, kFloor), Vector3(0.16, 0.03, -0.12)};
  auto bodies = clear_of({reaching}, std::vector<Solid>{beside});
  ASSERT_EQ(bodies.size(), 1U);
  EXPECT_NEAR(bodies[0].lower.x(), 0.101, 1e-12);
  EXPECT_EQ(bodies[0].upper, reaching.upper);
  const geometry::Aabb over{Vector3(0.02, -0.05, kFloor), Vector3(0.08, 0.05, -0.06)};
  bodies = clear_of({over}, std::vector<Solid>{beside});
  ASSERT_EQ(bodies.size(), 1U);
  EXPECT_NEAR(bodies[0].lower.z(), -0.096, 1e-12);
  const geometry::Aabb under{Vector3(0.02, -0.05, kFloor), Vector3(0.08, 0.05, -0.195)};
  const Solid bridge{{Matrix3::Identity(), Vector3(0.05, 0.0, -0.145)}, Vector3(0.2, 0.2, 0.1)};
  bodies = clear_of({under}, std::vector<Solid>{bridge});
  for (const geometry::Aabb& body : bodies) EXPECT_LT(body.upper.z(), -0.195);
}

TEST(ObstacleBodies, AreTurnedWithTheContainer) {
  const Pose X_WT{exp_rotation(Vector3(0.0, 0.0, 1.57079632679489662)), Vector3(1.0, 0.0, 0.0)};
  const geometry::Aabb in_T = planning::in_container(X_WT, {Vector3(1.1, 0.2, 0.0), Vector3(1.2, 0.5, 0.1)});
  EXPECT_NEAR(in_T.lower.x(), 0.2, 1e-12);
  EXPECT_NEAR(in_T.upper.x(), 0.5, 1e-12);
  EXPECT_NEAR(in_T.lower.y(), -0.2, 1e-12);
  EXPECT_NEAR(in_T.upper.y(), -0.1, 1e-12);
}

TEST(ObstacleBodies, LeaveEveryBoxFreeWhereverItStands) {
  Rng rng = Rng(5).split("bodies and boxes");
  const auto any = [&](double low, double high) {
    return Vector3(rng.uniform(low, high), rng.uniform(low, high), rng.uniform(low, high));
  };
  for (int trial = 0; trial < 500; ++trial) {
    SCOPED_TRACE(trial);
    std::vector<Solid> boxes;
    std::vector<geometry::Aabb> regions;
    for (int i = 0; i < 4; ++i) {
      const Matrix3 R = exp_rotation(Vector3(0.0, 0.0, rng.uniform(-1.0, 1.0)));
      boxes.push_back({{R, any(-0.2, 0.2)}, any(0.05, 0.2)});
      const Vector3 middle = any(-0.2, 0.2), half = any(0.01, 0.1);
      regions.push_back({middle - half, middle + half});
    }
    for (const geometry::Aabb& body : clear_of(regions, boxes)) {
      EXPECT_GT((body.upper - body.lower).minCoeff(), 0.0);
      for (const Solid& box : boxes) {
        EXPECT_FALSE(body.overlaps(geometry::bounds(geometry::Box{0.5 * box.size}, box.X_WP)));
      }
      EXPECT_TRUE(std::ranges::any_of(regions, [&](const geometry::Aabb& region) {
        return (body.lower - region.lower).minCoeff() > -1e-12 && (region.upper - body.upper).minCoeff() > -1e-12;
      })) << "never larger than what was seen";
    }
  }
}

TEST(ObstacleBodies, WithoutBoxesAreTheRegionsThemselves) {
  const geometry::Aabb region{Vector3(0.0, 0.0, 0.0), Vector3(0.1, 0.1, 0.1)};
  const auto bodies = clear_of({region}, {});
  ASSERT_EQ(bodies.size(), 1U);
  EXPECT_EQ(bodies[0].lower, region.lower);
  EXPECT_EQ(bodies[0].upper, region.upper);
  EXPECT_TRUE(clear_of({{Vector3::Zero(), Vector3(0.1, 0.1, 0.001)}}, {}).empty()) << "thinner than any body";
}

TEST(ObstacleReportWords, AreMillimetresOfTheContainer) {
  ObstacleReport report;
  report.low_T = Vector3(0.012, -0.040, 0.0);
  report.high_T = Vector3(0.098, 0.025, 0.0611);
  EXPECT_EQ(describe(report), "seen from (12, -40) to (98, 25) mm of the container, up to 61 mm over its floor");
}

}  // namespace
}  // namespace snug::session
