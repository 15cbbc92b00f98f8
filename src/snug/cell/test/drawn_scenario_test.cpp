// DrawnScenario: what is drawn stays within its widths, each kind by itself, and nothing changes where nothing is
// uncertain.
#include "snug/cell/drawn_scenario.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "snug/cell/test/demonstrator.hpp"

namespace snug::cell {
namespace {

TEST(DrawScenario, StaysWithinTheWidthsAndKeepsTheTurnOfBoxes) {
  model::Scenario scenario = with_fixed_arrivals(demonstrator(), "1");
  scenario.contact_pairs.front().params.travel = 1e-3;
  scenario.contact_pairs.front().params.stiffness_beyond = 1e5;
  const model::Uncertainty& half = scenario.uncertainty;
  for (int seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    const model::Scenario drawn = draw_scenario(scenario, "1", Rng(static_cast<std::uint64_t>(seed)));
    for (std::size_t i = 0; i < scenario.parcels.size(); ++i) {
      const Vector3 size = scenario.parcels[i].size;
      const Vector3 off = drawn.parcels[i].size - size;
      EXPECT_LE(off.cwiseAbs().maxCoeff(), half.size + half.size_common * size.maxCoeff() + 1e-12);
      EXPECT_NEAR(drawn.parcels[i].inertia.mass / scenario.parcels[i].inertia.mass, 1.0, half.mass);
    }
    EXPECT_NEAR(drawn.parcel_clearance, scenario.parcel_clearance, half.clearance);
    EXPECT_NEAR(drawn.cup.hold_length, scenario.cup.hold_length, half.cup_length);
    EXPECT_NEAR(drawn.cup.free_length - drawn.cup.hold_length, scenario.cup.free_length - scenario.cup.hold_length,
                1e-12);
    EXPECT_NEAR(drawn.cup.release_push, scenario.cup.release_push, half.release_push);
    EXPECT_NEAR(drawn.controller.task_stiffness / scenario.controller.task_stiffness, 1.0, half.tracking);
    for (std::size_t i = 0; i < scenario.contact_pairs.size(); ++i) {
      const model::ContactParams &is = drawn.contact_pairs[i].params, &was = scenario.contact_pairs[i].params;
      EXPECT_NEAR(is.friction / was.friction, 1.0, half.friction);
      if (was.travel) {
        EXPECT_NEAR(*is.travel / *was.travel, 1.0, half.contact_travel);
        EXPECT_NEAR(*is.stiffness_beyond / *is.stiffness, *was.stiffness_beyond / *was.stiffness, 1e-9);
      }
      ASSERT_EQ(is.stiffness.has_value(), was.stiffness.has_value());
      if (is.stiffness) {
        EXPECT_NEAR(*is.stiffness / *was.stiffness, 1.0, half.contact_stiffness);
      }
    }
    for (std::size_t i = 0; i < scenario.sequences[0].items.size(); ++i) {
      const Pose before = arrival_pose(scenario, scenario.sequences[0].items[i]);
      const Pose after = arrival_pose(drawn, drawn.sequences[0].items[i]);
      EXPECT_LE(angle_between(before.R, after.R), half.yaw + half.aligner_yaw + 1e-9) << i;
    }
  }
}

TEST(DrawScenario, DrawsThePushAboutThatOfTheScenarioFromNoneToAll) {
  model::Scenario scenario = demonstrator();
  const auto range_of = [&](double push, double half_width) {
    scenario.cup.release_push = push;
    scenario.uncertainty.release_push = half_width;
    double least = 1.0, most = 0.0;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
      const double drawn = draw_scenario(scenario, "1", Rng(seed)).cup.release_push;
      least = std::min(least, drawn), most = std::max(most, drawn);
    }
    return std::pair(least, most);
  };
  const auto expect_range = [](const std::pair<double, double>& found, double low, double high) {
    const double slack = 0.1 * (high - low);  // of a hundred draws none lies in a tenth with a chance of 3e-5
    EXPECT_GE(found.first, low);
    EXPECT_LE(found.first, low + slack);
    EXPECT_GE(found.second, high - slack);
    EXPECT_LE(found.second, high);
  };
  expect_range(range_of(0.7, 0.2), 0.5, 0.9);
  expect_range(range_of(0.7, 1.0), 0.0, 1.0);
  expect_range(range_of(1.0, 0.25), 0.75, 1.0);
}

TEST(DrawScenario, IsTheScenarioItselfWhereNothingIsUncertain) {
  model::Scenario scenario = demonstrator();
  scenario.uncertainty = model::no_uncertainty();
  EXPECT_EQ(draw_scenario(scenario, "1", Rng(3)), scenario);
}

TEST(DrawScenario, OneKindOfDrawDoesNotChangeAnother) {
  model::Scenario scenario = demonstrator();
  const model::Scenario all = draw_scenario(scenario, "1", Rng(3));
  scenario.uncertainty.size = 0.0;
  scenario.uncertainty.size_common = 0.0;
  const model::Scenario without_sizes = draw_scenario(scenario, "1", Rng(3));
  EXPECT_EQ(all.contact_pairs, without_sizes.contact_pairs);
  EXPECT_EQ(all.cup, without_sizes.cup);
  EXPECT_NE(all.parcels[0].size, without_sizes.parcels[0].size);
  EXPECT_EQ(without_sizes.parcels[0].size, scenario.parcels[0].size);
}

TEST(DrawScenario, ArrivalsThatAreFixedStandAsTheyDidForAToolFromAbove) {
  const model::Scenario scenario = demonstrator();
  const model::Scenario fixed = with_fixed_arrivals(scenario, "2");
  const model::Sequence& was = *model::find_sequence(scenario, "2");
  const model::Sequence& is = *model::find_sequence(fixed, "2");
  for (std::size_t i = 0; i < was.items.size(); ++i) {
    ASSERT_TRUE(is.items[i].yaw) << i;
    EXPECT_LT(angle_between(arrival_pose(scenario, was.items[i]).R, arrival_pose(fixed, is.items[i]).R), 1e-9) << i;
  }
}

TEST(DrawRun, IsTheSameForItsNumberAndAnotherForEach) {
  const auto first_mass = [](int draw) { return draw_run(demonstrator(), "1", draw).parcels.front().inertia.mass; };
  EXPECT_EQ(first_mass(1), first_mass(1));
  EXPECT_NE(first_mass(1), first_mass(2));
}

}  // namespace
}  // namespace snug::cell
