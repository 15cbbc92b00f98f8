// Pacer: steps are due at whole periods, and lateness is counted.
#include "snug/served_cell/pacer.hpp"

#include <gtest/gtest.h>

namespace snug::served_cell {
namespace {

using std::chrono::microseconds;

TEST(Histogram, TellsQuantilesWithinFivePercent) {
  Histogram histogram;
  for (int i = 1; i <= 10000; ++i) histogram.add(1e-6 * i);
  EXPECT_NEAR(histogram.quantile(0.5), 5000e-6, 0.05 * 5000e-6);
  EXPECT_NEAR(histogram.quantile(0.99), 9900e-6, 0.05 * 9900e-6);
  EXPECT_EQ(histogram.worst(), 10000e-6);
  EXPECT_EQ(histogram.quantile(1.0), histogram.worst());
  histogram.add(1e9);  // beyond all bins
  EXPECT_EQ(histogram.count(), 10001);
}

TEST(Pacer, IsDueAtWholePeriodsHoweverLateItsStepsAre) {
  Pacer pacer(0.008);
  const Pacer::Clock::time_point start{};
  pacer.start(start);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(pacer.due(), start + microseconds(8000 * i));
    pacer.step(pacer.due() + microseconds(i % 2 == 0 ? 100 : 9000));
  }
  EXPECT_EQ(pacer.missed(), 500);
  EXPECT_NEAR(pacer.lateness().quantile(0.5), 100e-6, 6e-6);
}

TEST(Pacer, DoesNotHurryAfterALongPause) {
  Pacer pacer(0.008);
  const Pacer::Clock::time_point start{};
  pacer.start(start);
  pacer.step(start + std::chrono::seconds(5));
  EXPECT_EQ(pacer.due(), start + std::chrono::seconds(5) + microseconds(8000));
}

}  // namespace
}  // namespace snug::served_cell
