// findings_of: each limit from both sides.
#include "snug/box_estimation/internal/findings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "snug/box_estimation/test/scene.hpp"

namespace snug::box_estimation::internal {
namespace {

using namespace test;

class Findings : public ::testing::Test {
 protected:
  Findings() {
    const Cell cell;
    input_ = make_input(cell.scenario, cell.scenario.containers.front());
    box_ = {"a", Vector3(0.10, 0.08, 0.06), level(0.0, 0.0, 0.03), 0.002, 0.005};
    estimate_.X_WP = box_.X_WP;
  }

  [[nodiscard]] std::vector<Finding> find(const SizeMisfit& size = {}) const {
    return findings_of(estimate_, box_, input_, size, settings_);
  }
  [[nodiscard]] bool has(Finding finding, const SizeMisfit& size = {}) const {
    const std::vector<Finding> all = find(size);
    return std::ranges::find(all, finding) != all.end();
  }

  EstimateInput input_;
  ExpectedBox box_;
  BoxEstimate estimate_;
  FindingSettings settings_;
};

TEST_F(Findings, ABoxWhereItWasHasNone) { EXPECT_TRUE(find().empty()); }

TEST_F(Findings, MovedIsBeyondTheDistanceAndTheBelief) {
  for (const Vector3& way : {Vector3(1, 0, 0), Vector3(0, -1, 0), Vector3(0.6, 0.8, 0)}) {
    estimate_.X_WP.p = box_.X_WP.p + 0.0099 * way;
    EXPECT_FALSE(has(Finding::Moved));
    estimate_.X_WP.p = box_.X_WP.p + 0.0101 * way;
    EXPECT_TRUE(has(Finding::Moved));
    box_.position_spread = 0.0034;  // three of them are 10.2 mm
    EXPECT_FALSE(has(Finding::Moved)) << "the belief was no better";
    box_.position_spread = 0.002;
  }
}

TEST_F(Findings, MovedIsBeyondTheAngleToo) {
  const double degree = 0.017453292519943295;
  for (const double degrees : {2.9, 3.1}) {
    estimate_.X_WP.R = exp_rotation(Vector3(0, 0, degrees * degree)) * box_.X_WP.R;
    EXPECT_EQ(has(Finding::Moved), degrees > 3.0);
  }
  box_.rotation_spread = 0.02;
  EXPECT_FALSE(has(Finding::Moved));
}

TEST_F(Findings, LeaningIsAnyAxisOffTheVertical) {
  const double degree = 0.017453292519943295;
  for (const Vector3& axis : {Vector3(1, 0, 0), Vector3(0, 1, 0)}) {
    for (const double degrees : {3.9, 4.1, 45.0, 85.9, 86.1, 90.0}) {
      SCOPED_TRACE(degrees);
      estimate_.X_WP.R = exp_rotation(degrees * degree * axis);
      EXPECT_EQ(has(Finding::Leaning), degrees > 4.0 && degrees < 86.0) << "on another face it stands upright";
    }
  }
}

TEST_F(Findings, OnRimIsOverAWallAndHigherThanIt) {
  const double rim = input_.region_high.z();
  box_.X_WP.p = estimate_.X_WP.p = Vector3(input_.region_high.x() - 0.044, 0.0, rim - 0.02);  // 6 mm beyond
  EXPECT_TRUE(has(Finding::OnRim));
  estimate_.X_WP.p.x() -= 0.002;
  EXPECT_FALSE(has(Finding::OnRim)) << "4 mm: within what is allowed";
  estimate_.X_WP.p.x() += 0.002;
  estimate_.X_WP.p.z() = rim - 0.04;
  EXPECT_FALSE(has(Finding::OnRim)) << "below the rim it cannot be beyond the wall";
  estimate_.X_WP.p = Vector3(0.0, input_.region_low.y() + 0.034, rim - 0.02);
  EXPECT_TRUE(has(Finding::OnRim)) << "the other side, by its other edge";
  input_.region_high = Vector3::Constant(1e3);
  EXPECT_FALSE(has(Finding::OnRim)) << "without a region there is no rim";
}

TEST_F(Findings, WrongSizeNeedsMillimetresAndDeviations) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(has(Finding::WrongSize, {Vector3(none, 0.0031, none), 4.1}));
  EXPECT_TRUE(has(Finding::WrongSize, {Vector3(-0.0031, 0.0, none), 4.1})) << "too short as well";
  EXPECT_FALSE(has(Finding::WrongSize, {Vector3(none, 0.0029, none), 40.0}));
  EXPECT_FALSE(has(Finding::WrongSize, {Vector3(none, 0.0031, none), 3.9}));
  EXPECT_FALSE(has(Finding::WrongSize, {Vector3::Constant(none), 40.0})) << "no side was seen whole";
}

TEST_F(Findings, LimitsAreThoseOfTheSettings) {
  estimate_.X_WP.p.x() += 0.0101;
  ASSERT_TRUE(has(Finding::Moved));
  settings_.moved_distance = 0.02;
  EXPECT_FALSE(has(Finding::Moved));
  settings_.moved_distance = 0.01;
  settings_.moved_deviations = 6.0;
  EXPECT_FALSE(has(Finding::Moved));
}

TEST(Names, AreThoseOfTheFormat) {
  EXPECT_STREQ(name_of(Sight::Missing), "missing");
  EXPECT_STREQ(name_of(Finding::WrongSize), "wrong_size");
  EXPECT_STREQ(name_of(FrameFault::ViewBlocked), "view_blocked");
}

}  // namespace
}  // namespace snug::box_estimation::internal
