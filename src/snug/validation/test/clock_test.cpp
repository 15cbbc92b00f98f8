// Clocks are found to a fraction of a sample, with errors that cover, and refused where there is nothing to find.
#include "snug/validation/clock.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "snug/core/rng.hpp"

namespace snug::validation {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Speed of something that moves now and then: bumps of different length and height.
double speed_at(double time, int channel) {
  double speed = 0.0;
  for (int k = 0; k < 25; ++k) {
    const double middle = 4.0 + 9.7 * k + 2.3 * channel + 1.7 * std::sin(1.3 * k * k);
    const double half = 0.7 + 0.3 * std::cos(2.1 * k + channel);
    const double x = (time - middle) / half;
    if (std::abs(x) < 1.0) speed += (0.4 + 0.02 * k) * std::pow(std::cos(0.5 * std::numbers::pi * x), 2);
  }
  return speed;
}

Signals sampled(double rate_hz, double offset, double rate, double noise, Rng rng, double last = 240.0) {
  Signals signals;
  signals.channels.resize(3);
  for (int i = 0; i / rate_hz <= last; ++i) {
    const double time = i / rate_hz;
    signals.times.push_back(offset + (1.0 + rate) * time);
    for (int c = 0; c < 3; ++c)
      signals.channels[static_cast<std::size_t>(c)].push_back(speed_at(time, c) + noise * rng.normal());
  }
  return signals;
}

TEST(FitClock, FindsShiftAndRateBetweenSamples) {
  Rng rng = Rng(5).split("clocks");
  const Signals reference = sampled(125.0, 0.0, 0.0, 0.0, rng);
  int covered_shift = 0, covered_rate = 0;
  constexpr int kRounds = 40;
  for (int round = 0; round < kRounds; ++round) {
    SCOPED_TRACE(round);
    const double offset = rng.uniform(-20.0, 20.0), rate = 1e-6 * rng.uniform(-100.0, 100.0);
    const auto fit = fit_clock(reference, sampled(120.0, offset, rate, 0.02, rng.split(std::to_string(round))));
    ASSERT_TRUE(fit);
    const double shift_error = fit->shift - (offset + rate * fit->middle);
    // 0.02 m/s of noise on 3 x 29000 samples, of which half move with 1 m/s^2: 0.02 / sqrt(40000) s.
    EXPECT_LT(std::abs(shift_error), 5e-4);
    EXPECT_LT(fit->shift_error, 3e-4);
    covered_shift += std::abs(shift_error) < 2.0 * fit->shift_error ? 1 : 0;
    covered_rate += std::abs(fit->rate - rate) < 2.0 * fit->rate_error ? 1 : 0;
  }
  // Two standard errors cover 95 %: 38 of 40, and less than 33 with a probability of 2e-3.
  EXPECT_GE(covered_shift, 33);
  EXPECT_GE(covered_rate, 33);
}

TEST(FitClock, IsExactWithoutNoise) {
  const Rng rng(1);
  const auto fit = fit_clock(sampled(125.0, 0.0, 0.0, 0.0, rng), sampled(360.0, 1.23456, 0.0, 0.0, rng));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->shift, 1.23456, 2e-6);  // what lines between samples 3 ms apart leave
  EXPECT_NEAR(fit->rate, 0.0, 1e-7);
  EXPECT_GT(fit->correlation, 0.9999);
}

TEST(FitClock, TimesGoThereAndBack) {
  ClockFit fit;
  fit.shift = 3.0;
  fit.rate = 5e-5;
  fit.middle = 100.0;
  EXPECT_NEAR(fit.to_reference(fit.to_measured(17.0)), 17.0, 1e-9);
  EXPECT_NEAR(fit.to_measured(100.0), 103.0, 1e-12);
}

TEST(FitClock, LivesWithLossesOfHalfOfAllSamples) {
  Rng rng = Rng(8).split("losses");
  const Signals reference = sampled(125.0, 0.0, 0.0, 0.0, rng);
  Signals measured = sampled(360.0, -4.321, 0.0, 0.01, rng);
  for (auto& channel : measured.channels) {
    for (std::size_t i = 0; i < channel.size(); i += 720) {
      if (rng.uniform() > 0.5) continue;
      for (std::size_t k = i; k < std::min(i + 720, channel.size()); ++k) channel[k] = kNaN;
    }
  }
  const auto fit = fit_clock(reference, measured);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->shift, -4.321, 1e-3);
}

TEST(FitClock, RemovesConstantOffsetsWhereAsked) {
  const Rng rng(2);
  Signals measured = sampled(500.0, 0.777, 0.0, 0.05, rng);
  for (std::size_t c = 0; c < 3; ++c)
    for (double& value : measured.channels[c]) value += 4.0 * (static_cast<double>(c) - 1.0);
  ClockOptions options;
  options.removes_offsets = true;
  const auto fit = fit_clock(sampled(125.0, 0.0, 0.0, 0.0, rng), measured, options);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->shift, 0.777, 1e-3);
}

TEST(FitClock, SpikesDoNotMoveIt) {
  Rng rng = Rng(4).split("spikes");
  Signals measured = sampled(500.0, 0.5, 0.0, 0.01, rng);
  for (int k = 0; k < 40; ++k) {
    const auto at = static_cast<std::size_t>(rng.index(static_cast<int>(measured.times.size()) - 10));
    for (std::size_t i = at; i < at + 10; ++i) measured.channels[1][i] += 30.0;
  }
  const auto fit = fit_clock(sampled(125.0, 0.0, 0.0, 0.0, rng), measured);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->shift, 0.5, 2e-3);
}

TEST(FitClock, ARateThatNoClockHasIsNotFitted) {
  const Rng rng(3);
  const auto fit = fit_clock(sampled(125.0, 0.0, 0.0, 0.0, rng), sampled(125.0, 0.0, 2e-3, 0.01, rng));
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->rate, 0.0);
}

/// Of 2, 8 and 20 ms, up and down, in the middle and near the ends, beside rates of up to 50 ppm.
TEST(FitClock, TellsSlipsFromDrift) {
  Rng rng = Rng(8).split("slips");
  const Signals reference = sampled(125.0, 0.0, 0.0, 0.0, rng);
  int round = 0;
  double worst = 0.0;
  for (const double size : {0.002, -0.008, 0.020}) {
    for (const double at : {60.0, 190.0}) {
      SCOPED_TRACE(testing::Message() << size << " s at " << at << " s");
      const double rate = 1e-6 * rng.uniform(-50.0, 50.0);
      Signals measured = sampled(120.0, 1.0, rate, 0.005, rng.split(std::to_string(round++)));
      for (double& time : measured.times)
        if (time > at + 1.0) time += size;
      const auto fit = fit_clock(reference, measured);
      ASSERT_TRUE(fit);
      worst = std::max(worst, std::abs(fit->rate - rate) / fit->rate_error);
      ASSERT_EQ(fit->steps.size(), 1U);
      EXPECT_NEAR(fit->steps[0].size, size, 5e-4);
      EXPECT_NEAR(fit->steps[0].time, at, 6.0);  // a block; nothing may move for that long
      EXPECT_NEAR(fit->to_reference(fit->to_measured(at + 30.0)), at + 30.0, 1e-9);
      EXPECT_NEAR(fit->to_reference(fit->to_measured(at - 30.0)), at - 30.0, 1e-9);
    }
  }
  EXPECT_LT(worst, 3.5);  // of six: exceeded once in 350
}

TEST(FitClock, FindsNoSlipWhereThereIsNone) {
  Rng rng = Rng(9).split("no slips");
  const Signals reference = sampled(125.0, 0.0, 0.0, 0.0, rng);
  for (int round = 0; round < 6; ++round) {
    const double rate = 1e-6 * rng.uniform(-100.0, 100.0);
    const auto fit = fit_clock(reference, sampled(120.0, 0.3, rate, 0.02, rng.split(std::to_string(round))));
    ASSERT_TRUE(fit);
    EXPECT_TRUE(fit->steps.empty()) << round;
  }
}

TEST(FitClock, RefusesWhatHasNothingInCommon) {
  Rng rng = Rng(6).split("unlike");
  const Signals reference = sampled(125.0, 0.0, 0.0, 0.0, rng);
  Signals noise = reference;
  for (auto& channel : noise.channels)
    for (double& value : channel) value = rng.normal();
  ASSERT_FALSE(fit_clock(reference, noise));
  Signals still = reference;
  for (auto& channel : still.channels) std::fill(channel.begin(), channel.end(), 0.0);
  const auto fit = fit_clock(reference, still);
  ASSERT_FALSE(fit);
  EXPECT_EQ(fit.error(), NoClock::NothingMoves);
  const auto short_one = fit_clock(reference, sampled(125.0, 0.0, 0.0, 0.0, rng, 0.05));
  ASSERT_FALSE(short_one);
  EXPECT_EQ(short_one.error(), NoClock::NothingInCommon);
}

TEST(ClockFit, GoesThereAndBackAcrossSlipsUpAndDown) {
  ClockFit fit;
  fit.shift = -2.0;
  fit.rate = 8e-5;
  fit.middle = 60.0;
  fit.steps = {{30.0, 0.020, 1e-4}, {70.0, -0.050, 1e-4}, {90.0, 0.004, 1e-4}};
  EXPECT_EQ(fit.slipped(30.0), 0.0);
  EXPECT_EQ(fit.slipped(30.1), 0.020);
  EXPECT_NEAR(fit.slipped(100.0), -0.026, 1e-15);
  for (double t = 0.0; t < 120.0; t += 0.37) {
    // What a slip back repeats is told as the time of the slip: nothing else can be known of it.
    const double back = fit.to_reference(fit.to_measured(t));
    EXPECT_NEAR(back, t, t > 69.9 && t < 70.1 ? 0.051 : 1e-9) << t;
  }
  double before = fit.to_reference(-10.0);
  for (double measured = -10.0; measured < 130.0; measured += 0.003) {
    const double now = fit.to_reference(measured);
    EXPECT_GE(now, before) << measured << ": time does not run backward";
    before = now;
  }
}

TEST(FitClock, OfTheTwoTheOtherWayRoundIsTheOppositeShift) {
  const Rng rng(11);
  const Signals a = sampled(125.0, 0.0, 0.0, 0.0, rng, 120.0), b = sampled(125.0, 2.345, 0.0, 0.0, rng, 120.0);
  const auto forth = fit_clock(a, b), back = fit_clock(b, a);
  ASSERT_TRUE(forth && back);
  EXPECT_NEAR(forth->shift, 2.345, 2e-6);
  EXPECT_NEAR(back->shift, -2.345, 2e-6);
}

TEST(FitClock, AsksForNoOrderOfChannelsAndNoUnit) {
  const Rng rng(12);
  const Signals a = sampled(125.0, 0.0, 0.0, 0.0, rng, 120.0), b = sampled(200.0, -1.5, 0.0, 0.01, rng, 120.0);
  const auto plain = fit_clock(a, b);
  Signals a2 = a, b2 = b;
  for (Signals* one : {&a2, &b2}) {
    std::swap(one->channels[0], one->channels[2]);
    for (auto& channel : one->channels)
      for (double& value : channel) value *= 1024.0;  // exact in binary
  }
  const auto other = fit_clock(a2, b2);
  ASSERT_TRUE(plain && other);
  EXPECT_NEAR(plain->shift, other->shift, 1e-6);
  EXPECT_NEAR(plain->shift_error, other->shift_error, 0.05 * plain->shift_error);
  EXPECT_NEAR(plain->correlation, other->correlation, 1e-6);
}

TEST(FitClock, LooksAsFarAsItIsAllowedTo) {
  const Rng rng(13);
  const Signals a = sampled(125.0, 0.0, 0.0, 0.0, rng, 120.0), b = sampled(125.0, 30.0, 0.0, 0.0, rng, 120.0);
  ClockOptions options;
  options.longest_shift = 35.0;
  const auto found = fit_clock(a, b, options);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->shift, 30.0, 1e-5);
  options.longest_shift = 10.0;
  const auto other = fit_clock(a, b, options);
  EXPECT_TRUE(!other || std::abs(other->shift) <= 10.2);
}

TEST(FitClock, ExpectsOfAClockWhatClocksAre) {
  // With the same signals a rate that is expected to be small is found smaller, and said to be known better.
  const Rng rng(14);
  const Signals a = sampled(125.0, 0.0, 0.0, 0.0, rng), b = sampled(125.0, 0.0, 1e-4, 0.05, rng);
  ClockOptions loose, strict;
  loose.finds_steps = strict.finds_steps = false;
  loose.usual_rate = 1e-2;
  strict.usual_rate = 1e-6;
  const auto free = fit_clock(a, b, loose), tempered = fit_clock(a, b, strict);
  ASSERT_TRUE(free && tempered);
  EXPECT_NEAR(free->rate, 1e-4, 4.0 * free->rate_error);
  EXPECT_LT(std::abs(tempered->rate), std::abs(free->rate));
  EXPECT_LT(tempered->rate_error, free->rate_error);
}

TEST(NoClock, IsSaidInWords) {
  EXPECT_STREQ(describe(NoClock::NothingInCommon), "the signals have too little in common");
  EXPECT_STREQ(describe(NoClock::NothingMoves), "nothing moves");
  EXPECT_STREQ(describe(NoClock::TooUnlike), "no shift makes the two alike");
}

TEST(FitClock, IsTheSameEveryTime) {
  const Rng rng(9);
  const Signals reference = sampled(125.0, 0.0, 0.0, 0.0, rng), measured = sampled(360.0, 2.0, 1e-5, 0.02, rng);
  const auto a = fit_clock(reference, measured), b = fit_clock(reference, measured);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->shift, b->shift);
  EXPECT_EQ(a->shift_error, b->shift_error);
}

}  // namespace
}  // namespace snug::validation
