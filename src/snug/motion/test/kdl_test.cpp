// Second opinion: the trapezoid of KDL (liborocos-kdl-dev) against ours.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <kdl/velocityprofile_trap.hpp>

#include "snug/core/rng.hpp"
#include "snug/motion/lspb.hpp"

namespace snug::motion {
namespace {

TEST(LspbAgainstKdl, GivesTheSameFastestProfile) {
  Rng rng = Rng(7).split("kdl");
  int coasting = 0;
  for (int i = 0; i < 5000; ++i) {
    SCOPED_TRACE(i);
    const double length = std::pow(10.0, rng.uniform(-4.0, 1.0));
    const double speed = std::pow(10.0, rng.uniform(-2.0, 1.0));
    const double acceleration = std::pow(10.0, rng.uniform(-2.0, 2.0));
    const LspbProfile ours = plan_fastest_profile(length, speed, acceleration);
    KDL::VelocityProfile_Trap theirs(speed, acceleration);
    theirs.SetProfile(0.0, length);
    ASSERT_NEAR(ours.duration, theirs.Duration(), 1e-12 * ours.duration);
    coasting += ours.duration > 2.0 * ours.blend_time * (1.0 + 1e-12) ? 1 : 0;
    for (int k = 0; k <= 50; ++k) {
      const double t = ours.duration * k / 50.0;
      const LspbProfile::Sample s = ours.sample(t);
      // KDL evaluates polynomials in t whose terms cancel to T / t_s of their size: ten roundings of that.
      const double room = 2e-15 * (1.0 + ours.duration / ours.blend_time);
      EXPECT_NEAR(s.position, theirs.Pos(t), room * length);
      EXPECT_NEAR(s.speed, theirs.Vel(t), room * speed);
      const double to_border = std::min(std::abs(t - ours.blend_time), std::abs(ours.duration - ours.blend_time - t));
      if (k > 0 && k < 50 && to_border > 1e-9 * ours.duration) {
        EXPECT_NEAR(s.acceleration, theirs.Acc(t), room * acceleration);
      }
    }
  }
  EXPECT_GT(coasting, 1000);  // both shapes are really compared
  EXPECT_LT(coasting, 4000);
}

TEST(LspbAgainstKdl, MeetsInTimeMiddleAndEndWhenStretched) {
  Rng rng = Rng(7).split("stretch");
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE(i);
    const double length = std::pow(10.0, rng.uniform(-3.0, 1.0));
    const double speed = std::pow(10.0, rng.uniform(-1.0, 1.0));
    const double acceleration = std::pow(10.0, rng.uniform(-1.0, 1.0));
    KDL::VelocityProfile_Trap theirs(speed, acceleration);
    theirs.SetProfile(0.0, length);
    const double duration = theirs.Duration() * rng.uniform(1.0, 5.0);
    theirs.SetProfileDuration(0.0, length, duration);
    const LspbProfile ours = plan_stretched_profile(length, speed, acceleration, duration);
    // KDL slows the fastest profile down in time, ours takes two phases where it can: other shapes, same ends.
    EXPECT_NEAR(ours.duration, theirs.Duration(), 1e-12 * duration);
    EXPECT_NEAR(ours.sample(0.5 * duration).position, theirs.Pos(0.5 * duration), 1e-10 * length);
    EXPECT_EQ(ours.sample(duration).position, length);
  }
}

}  // namespace
}  // namespace snug::motion
