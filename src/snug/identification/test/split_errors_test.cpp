// What is said of a fit's residuals: when they are no noise, and by how much standard errors grow then.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "snug/identification/internal/scene_search.hpp"

namespace snug::identification::internal {
namespace {

SplitErrors errors_of(double chi2, double numbers, double correlation = 0.0, double drift = 0.0) {
  SplitErrors errors;
  errors.chi2_per_dof = chi2;
  errors.numbers = numbers;
  errors.correlation = correlation;
  errors.drift = drift;
  return errors;
}

TEST(SplitErrors, HangTogetherByMoreThanChanceAndATwentieth) {
  // Of n numbers a correlation is 1 / sqrt(n) by chance: four of them.
  EXPECT_FALSE(errors_of(1.0, 400.0, 0.19).is_systematic());
  EXPECT_TRUE(errors_of(1.0, 400.0, 0.21).is_systematic());
  EXPECT_FALSE(errors_of(1.0, 1e6, 0.049).is_systematic());
  EXPECT_TRUE(errors_of(1.0, 1e6, 0.051).is_systematic());
  EXPECT_FALSE(errors_of(1.0, 1e6, -0.5).is_systematic());  // neighbours that err against each other do no harm
  EXPECT_FALSE(errors_of(1.0, 0.0, 1.0).is_systematic());   // of nothing nothing is known
}

TEST(SplitErrors, AreNoNoiseWhereAnAxisIsOffForLong) {
  EXPECT_FALSE(errors_of(1.0, 1e4, 0.0, 4.5).is_systematic());
  EXPECT_TRUE(errors_of(1.0, 1e4, 0.0, 4.7).is_systematic());
}

TEST(SplitErrors, OfNoiseInflateNothingBelowOneAndByThemselvesAbove) {
  EXPECT_EQ(errors_of(0.4, 1e4).inflation(), 1.0);  // less noise than declared makes no error smaller
  EXPECT_EQ(errors_of(1.0, 1e4).inflation(), 1.0);
  // Within chance of 1, 4 sqrt(2 / n): as it is.
  EXPECT_DOUBLE_EQ(errors_of(1.05, 1e4).inflation(), 1.05);
  // Beyond it, and independent: as it is, too.
  EXPECT_DOUBLE_EQ(errors_of(3.0, 1e4).inflation(), 3.0);
}

TEST(SplitErrors, ThatHangTogetherCountAsTheNeighboursThatSayTheSame) {
  // All of the excess of 2 shared by neighbours of correlation r: (1 + r) / (1 - r) of them err as one.
  const double chi2 = 3.0, r = 0.4;
  const double excess = chi2 - 1.0, shared = r * chi2 / excess;
  EXPECT_NEAR(errors_of(chi2, 1e4, r).inflation(), 1.0 + excess * (1.0 + shared) / (1.0 - shared), 1e-12);
  // More correlation, more inflation; it ends where a hundred samples are one.
  double before = 0.0;
  for (const double correlation : {0.0, 0.1, 0.2, 0.4, 0.6, 0.9}) {
    const double now = errors_of(chi2, 1e4, correlation).inflation();
    EXPECT_GE(now, before) << correlation;
    before = now;
  }
  EXPECT_LE(before, 1.0 + 3.0 * 1.98 / 0.02);
  EXPECT_TRUE(std::isfinite(errors_of(1.0, 1e4, 1.0).inflation()));
}

TEST(SplitErrors, AreNeverInflatedByLessThanTheMisfit) {
  for (const double correlation : {0.0, 0.3, 0.8})
    for (double chi2 = 0.5; chi2 < 20.0; chi2 *= 1.3) {
      const double inflation = errors_of(chi2, 1e5, correlation).inflation();
      EXPECT_GE(inflation, std::max(1.0, chi2) - 1e-12) << chi2 << " " << correlation;
      // An excess that neighbours share entirely is worth a hundred samples at most.
      EXPECT_LE(inflation, 1.0 + std::max(chi2, 1.0) * 1.98 / 0.02) << chi2 << " " << correlation;
    }
}

TEST(RowCounts, AreTheFewerAndTheMoreOfEachBody) {
  const RowCounts a = {{6, 12}, {0}}, b = {{9, 3}, {18}};
  EXPECT_EQ(fewer(a, b), (RowCounts{{6, 3}, {0}}));
  EXPECT_EQ(more(a, b), (RowCounts{{9, 12}, {18}}));
  EXPECT_EQ(fewer(a, b), fewer(b, a));
  EXPECT_EQ(fewer(a, a), a);
  EXPECT_EQ(total(a), 18.0);
  EXPECT_EQ(total(fewer(a, b)) + total(more(a, b)), total(a) + total(b));
  EXPECT_EQ(total({}), 0.0);
}

}  // namespace
}  // namespace snug::identification::internal
