// The map of what is reached, beside what `snug check` says of the same poses, and its own forms.
#include "snug/runs/reach_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <numbers>

#include "snug/cell/test/demonstrator.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/runs/program_check.hpp"

namespace snug::runs {
namespace {

using cell::demonstrator;

/// The demonstrator with its base moved by up to 0.4 m and turned.
model::Scenario with_base_moved(Rng& rng) {
  model::Scenario scenario = demonstrator();
  Pose& X_WB = scenario.robot->X_WB;
  X_WB.p += Vector3(rng.uniform(-0.4, 0.4), rng.uniform(-0.4, 0.4), rng.uniform(-0.1, 0.3));
  X_WB.R = exp_rotation(Vector3(0.0, 0.0, rng.uniform(-std::numbers::pi, std::numbers::pi))) * X_WB.R;
  return scenario;
}

Pose any_tool(const model::Scenario& scenario, Rng& rng) {
  const Vector3 p =
      scenario.robot->X_WB.p + Vector3(rng.uniform(-1.3, 1.3), rng.uniform(-1.3, 1.3), rng.uniform(-0.4, 0.9));
  return {motion::upright_tool(rng.uniform(-std::numbers::pi, std::numbers::pi)), p};
}

/// What check says of an arm that begins with these joints and has nothing to do but to stay.
CheckResult check_standing(model::Scenario scenario, const std::vector<double>& q, const Pose& X_WE) {
  scenario.robot->joints_start = q;
  return check_program(scenario, motion::Program{"stay", {motion::named_waypoint("home", X_WE)}}, {});
}

ReachVerdict verdict_of(const CheckFinding& finding) {
  switch (finding.kind) {
    case CheckKind::JointLimit:
      return ReachVerdict::JointLimit;
    case CheckKind::Singularity:
      return ReachVerdict::Singular;
    case CheckKind::SelfCollision:
      return ReachVerdict::SelfCollision;
    case CheckKind::Collision:
      return ReachVerdict::Collision;
    default:
      return ReachVerdict::Reached;
  }
}

TEST(ReachMap, AgreesWithCheckOnAThousandPosesOfMovedBases) {
  Rng rng = Rng(29).split("reach map");
  std::array<int, kReachVerdicts> counts{};
  for (int base = 0; base < 10; ++base) {
    const model::Scenario scenario = with_base_moved(rng);
    const PoseReachability reach(scenario);
    EXPECT_FALSE(reach.is_searched());
    std::vector<motion::Waypoint> unreachable;
    for (int i = 0; i < 100; ++i) {
      SCOPED_TRACE(testing::Message() << base << " " << i);
      const Pose X_WE = any_tool(scenario, rng);
      const PoseReach found = reach.look(X_WE);
      ++counts[static_cast<std::size_t>(found.verdict)];
      if (found.q.empty()) {
        EXPECT_TRUE(found.verdict == ReachVerdict::OutOfReach || found.verdict == ReachVerdict::JointLimit);
        // A row of check is reached within 5 mm: no waypoint for poses that near.
        const auto is_reached = [&](double by) {
          const Vector3 to_base = (scenario.robot->X_WB.p - X_WE.p).normalized();
          return !reach.look({X_WE.R, X_WE.p + by * to_base}).q.empty();
        };
        if (unreachable.size() < 4 && !is_reached(0.03) && !is_reached(-0.03)) {
          unreachable.push_back(motion::named_waypoint("home", X_WE));
        }
        continue;
      }
      const CheckResult checked = check_standing(scenario, found.q, X_WE);
      const auto is_of_pose = [](const CheckFinding& one) { return one.is_error && one.kind != CheckKind::JointSpeed; };
      const auto first = std::ranges::find_if(checked.findings, is_of_pose);
      if (found.verdict == ReachVerdict::Reached) {
        EXPECT_EQ(first, checked.findings.end()) << name_of(first->kind) << " " << first->what;
        continue;
      }
      const auto same = std::ranges::find_if(checked.findings, [&](const CheckFinding& one) {
        return is_of_pose(one) && verdict_of(one) == found.verdict && one.what == found.what;
      });
      ASSERT_NE(same, checked.findings.end()) << name_of(found.verdict) << " " << found.what;
      // The arm stands, but the controller's clock goes on: rounding.
      EXPECT_NEAR(same->margin + same->allowance, found.margin, 1e-6);
    }
    // What has no joints is not reached by the controller either, from the posture.
    if (unreachable.empty()) continue;
    model::Scenario standing = scenario;
    standing.robot->joints_start = standing.robot->posture;
    const CheckResult missed = check_program(standing, motion::Program{"far", unreachable}, {});
    for (int row = 0; row < static_cast<int>(unreachable.size()); ++row) {
      EXPECT_TRUE(std::ranges::any_of(missed.findings, [&](const CheckFinding& one) {
        return one.kind == CheckKind::Reach && one.row == row;
      })) << row;
    }
  }
  // Each of the answers came often enough to count. An arm that could stand on itself only is rare: another branch of
  // it mostly stands free or meets something else.
  const auto count_of = [&](ReachVerdict verdict) { return counts[static_cast<std::size_t>(verdict)]; };
  for (const ReachVerdict verdict : {ReachVerdict::Reached, ReachVerdict::OutOfReach, ReachVerdict::Collision})
    EXPECT_GT(count_of(verdict), 30) << name_of(verdict);
  EXPECT_GT(count_of(ReachVerdict::SelfCollision), 5);
}

TEST(ReachMap, CoversTheContainerAndThePicksOfTheDemonstrator) {
  const ReachMap map = make_reach_map(demonstrator(), 1);
  EXPECT_EQ(map.container, "tote1");
  EXPECT_EQ(map.columns, 16);
  EXPECT_EQ(map.rows, 24);
  ASSERT_EQ(map.layers.size(), 4U);
  for (const ReachLayer& layer : map.layers) EXPECT_EQ(layer.points.size(), 384U);
  // It is packed in all its places: over the rim the tool stands everywhere; near the floor the gripper meets the
  // walls.
  const auto reached = [](const ReachLayer& layer) {
    return std::ranges::count(layer.points, ReachVerdict::Reached, &ReachPoint::verdict);
  };
  EXPECT_EQ(reached(map.layers.back()), 384);
  EXPECT_GT(reached(map.layers.front()), 200);
  EXPECT_LT(reached(map.layers.front()), 384);
  EXPECT_FALSE(map.picks.empty());
  for (const ReachPick& pick : map.picks) EXPECT_EQ(pick.point.verdict, ReachVerdict::Reached) << pick.item;
  int points = 0;
  for (const int count : map.counts) points += count;
  EXPECT_EQ(points, 4 * 384);
}

TEST(ReachMap, DoesNotDependOnThreadsAndSaysTheSameInJson) {
  Rng rng = Rng(5).split("map");
  const model::Scenario scenario = with_base_moved(rng);
  const ReachMap map = make_reach_map(scenario, 1);
  const std::string text = format_json(map);
  EXPECT_EQ(text, format_json(make_reach_map(scenario, 3)));
  const auto json = nlohmann::json::parse(text);
  for (std::size_t layer = 0; layer < map.layers.size(); ++layer) {
    for (std::size_t i = 0; i < map.layers[layer].points.size(); ++i) {
      const ReachPoint& point = map.layers[layer].points[i];
      ASSERT_EQ(json["layers"][layer]["verdicts"][i], static_cast<int>(point.verdict));
      ASSERT_EQ(json["whats"][json["layers"][layer]["whats"][i].get<std::size_t>()],
                map.whats[static_cast<std::size_t>(point.what)]);
    }
  }
  EXPECT_NE(format_table(map).find("over tote1"), std::string::npos);
}

TEST(ReachMap, IsRefusedWithoutWhatItIsAbout) {
  const auto key_of = [](const model::Scenario& scenario) -> std::string {
    try {
      (void)make_reach_map(scenario, 1);
    } catch (const InputError& error) {
      return error.key;
    }
    return "none";
  };
  model::Scenario none = demonstrator();
  none.robot.reset();
  EXPECT_EQ(key_of(none), "robot");
  none = demonstrator();
  none.tool.reset();
  EXPECT_EQ(key_of(none), "tool");
  none = demonstrator();
  none.target = "nowhere";
  EXPECT_EQ(key_of(none), "containers");
  none = demonstrator();
  none.controller.X_WE_start.R.setIdentity();  // points up
  EXPECT_EQ(key_of(none), "controller.start_pose");
  none = demonstrator();
  none.aligner.reset();
  EXPECT_TRUE(make_reach_map(none, 1).picks.empty());
}

}  // namespace
}  // namespace snug::runs
