// Settings that contradict each other are found by the key that has to change.
#include "snug/settings/contradiction.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace snug::settings {
namespace {

TEST(Contradiction, IsNotInTheDefaults) {
  EXPECT_FALSE(find_contradiction(SkillParams{}).has_value());
  EXPECT_FALSE(find_contradiction(RehearsalSettings{}).has_value());
}

TEST(Contradiction, NamesTheKeyAndItsBound) {
  SkillParams skills;
  skills.travel.near_base = 2.0 * skills.travel.base_radius;
  ASSERT_TRUE(find_contradiction(skills).has_value());
  EXPECT_TRUE(find_contradiction(skills)->got.starts_with("travel.near_base "));
  EXPECT_EQ(find_contradiction(skills)->expected, "no more than travel.base_radius");
  skills.pivot.dragged = skills.pivot.drag;  // equal is allowed
  EXPECT_EQ(find_contradiction(skills)->expected, "no more than travel.base_radius");
  skills.pivot.dragged = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(find_contradiction(skills)->expected, "no more than pivot.drag");
}

TEST(Contradiction, KeepsTheRatesOfRehearsalsInOrder) {
  RehearsalSettings rehearsal;
  rehearsal.least_rate = rehearsal.good_rate + 0.01;
  ASSERT_TRUE(find_contradiction(rehearsal).has_value());
  EXPECT_EQ(find_contradiction(rehearsal)->expected, "least_rate <= good_rate <= accepted_rate");
  rehearsal = {};
  rehearsal.max_attempts = rehearsal.most_attempts + 1;
  ASSERT_TRUE(find_contradiction(rehearsal).has_value());
  EXPECT_EQ(find_contradiction(rehearsal)->got, "max_attempts " + std::to_string(rehearsal.max_attempts));
}

}  // namespace
}  // namespace snug::settings
