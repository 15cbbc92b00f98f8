// Effects: known models, chance alone, and the page.
#include "snug/study/effects.hpp"

#include <cmath>

#include "scene.hpp"
#include "snug/core/rng.hpp"

namespace snug::study {
namespace {

/// A folder with results that `model` gives for (x, w, row).
template <class Model>
void fill(const Study& study, const Folder& folder, Model model) {
  for (std::uint64_t i = 0; i < study.rows(); ++i) {
    const Row row = row_of(study, i);
    RowResult result;
    result.row = i;
    result.values = {{"y", model(std::stod(row.values[0]), row.values[1] == "left", i)}};
    TableWriter::open(folder.table(i / static_cast<std::uint64_t>(study.chunk)))->append(result);
  }
}

TEST(Effects, AnAdditiveModelHasItsSharesAndNoInteraction) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(4, 20, 50);
  const Folder folder(study, scratch / "f", true);
  // x: 0 .. 3 evenly has variance 5/4; w: 0 or 2 evenly has variance 1.
  fill(study, folder, [](double x, bool is_left, std::uint64_t) { return x + (is_left ? 0.0 : 2.0); });
  const auto effects = find_effects(study, folder);
  ASSERT_EQ(effects.size(), 1U);
  EXPECT_NEAR(effects[0].mean, 2.5, 1e-12);
  EXPECT_NEAR(effects[0].main[0].share, 1.25 / 2.25, 0.02);
  EXPECT_NEAR(effects[0].main[1].share, 1.0 / 2.25, 0.02);
  EXPECT_NEAR(effects[0].interactions[0].share, 0.0, 1e-9);
  EXPECT_NEAR(effects[0].main[0].levels[3].mean, 4.0, 1e-12);
  EXPECT_EQ(effects[0].quantiles.front(), 0.0);
  EXPECT_EQ(effects[0].quantiles.back(), 5.0);
  EXPECT_EQ(effects[0].worst_values.front(), 0.0);
  EXPECT_EQ(effects[0].worst.front(), 0U);
}

TEST(Effects, APureInteractionIsNoMainEffect) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(2, 50, 50);
  const Folder folder(study, scratch / "f", true);
  fill(study, folder, [](double x, bool is_left, std::uint64_t) { return (x > 0.5) == is_left ? 1.0 : -1.0; });
  const auto effects = find_effects(study, folder);
  EXPECT_NEAR(effects[0].main[0].share, 0.0, 0.02);
  EXPECT_NEAR(effects[0].interactions[0].share, 1.0, 0.02);
}

TEST(Effects, ChanceAloneHasNoShareOnAverage) {
  double sum = 0.0, pair = 0.0;
  for (int round = 0; round < 40; ++round) {
    const test::ScratchFolder scratch;
    const Study study = test::grid(6, 10, 200);
    const Folder folder(study, scratch / "f", true);
    Rng rng = Rng(static_cast<std::uint64_t>(round)).split("noise");
    fill(study, folder, [&](double, bool, std::uint64_t) { return rng.normal(); });
    const auto effects = find_effects(study, folder);
    sum += effects[0].main[0].share / 40.0;
    pair += effects[0].interactions[0].share / 40.0;
  }
  // One share varies by about sqrt(2 * 5) / 120 = 0.026: the mean of 40 by 0.004; four times that.
  EXPECT_NEAR(sum, 0.0, 0.017);
  EXPECT_NEAR(pair, 0.0, 0.017);
}

TEST(Effects, OfTheNoiseOfTheComputationAreNone) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(3, 2, 50);
  const Folder folder(study, scratch / "f", true);
  fill(study, folder, [](double x, bool, std::uint64_t) { return 0.3 + 3e-8 * x; });  // a variance of 1e-15
  const auto effects = find_effects(study, folder);
  ASSERT_EQ(effects.size(), 1U);
  EXPECT_TRUE(effects[0].is_noise);
  EXPECT_FALSE(effects[0].main[0].is_seen);
  EXPECT_EQ(make_page(study, status_of(study, folder), effects).find("100 %</b>"), std::string::npos);
}

TEST(Effects, OfChanceAreSeenSeldomAndRealOnesAlways) {
  int seen = 0, real = 0;
  for (int round = 0; round < 40; ++round) {
    const test::ScratchFolder scratch;
    const Study study = test::grid(6, 10, 200);
    const Folder folder(study, scratch / "f", true);
    Rng rng = Rng(static_cast<std::uint64_t>(round)).split("noise");
    fill(study, folder, [&](double, bool is_left, std::uint64_t) { return rng.normal() + (is_left ? 1.0 : 0.0); });
    const auto effects = find_effects(study, folder);
    seen += effects[0].main[0].is_seen ? 1 : 0;
    real += effects[0].main[1].is_seen ? 1 : 0;
  }
  EXPECT_LE(seen, 8) << "two standard deviations: some 5 % by chance";
  EXPECT_EQ(real, 40);
}

TEST(Effects, AddUpToAtMostTheWholeInUnbalancedDesigns) {
  const test::ScratchFolder scratch;
  const Study study = parse_study(
      "verb: fake\ndesign: list\nrepeat: 3\nfactors: [{option: --x}, {option: --w}]\npoints: [{x: 0, w: left}, {x: 1, "
      "w: right}, "
      "{x: 2, w: up}, {x: 0, w: left}, {x: 1, w: right}]\n",
      "s.yaml");
  const Folder folder(study, scratch / "f", true);
  fill(study, folder, [](double x, bool, std::uint64_t i) { return x + 1e-3 * static_cast<double>(i % 3); });
  const auto effects = find_effects(study, folder);
  double sum = 0.0;
  for (const MainEffect& effect : effects[0].main) sum += effect.is_seen ? effect.share : 0.0;
  EXPECT_GT(sum, 0.99);
  EXPECT_LE(sum, 1.0 + 1e-12);
}

TEST(Effects, RangesOfAFactorHaveAsManyRowsEach) {
  const test::ScratchFolder scratch;
  const Study study = parse_study(
      "verb: fake\ndesign: sobol\nrows: 60\nfactors: [{option: --x, from: 0, to: 1}, {option: --w, values: [left]}]\n",
      "s.yaml");
  const Folder folder(study, scratch / "f", true);
  fill(study, folder, [](double x, bool, std::uint64_t) { return x; });
  const auto effects = find_effects(study, folder);
  ASSERT_EQ(effects[0].main[0].levels.size(), kMostLevels);
  for (const Level& level : effects[0].main[0].levels) EXPECT_EQ(level.count, 10U);
}

TEST(Page, EscapesWhatTheStudySays) {
  const test::ScratchFolder scratch;
  Study study = test::grid(2, 2, 50);
  const Folder folder(study, scratch / "f", true);
  fill(study, folder, [](double x, bool, std::uint64_t) { return x; });
  study.name = "<script>alert(1)</script>";
  const std::string page = make_page(study, status_of(study, folder), find_effects(study, folder));
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_NE(page.find("Main effects"), std::string::npos);
  EXPECT_NE(page.find("snug fake --x 0 --w left --seed"), std::string::npos);
}

TEST(Page, SaysSoWhenThereIsNothing) {
  const test::ScratchFolder scratch;
  const Study study = test::grid(2, 2, 50);
  const Folder folder(study, scratch / "f", true);
  const std::string page = make_page(study, status_of(study, folder), find_effects(study, folder));
  EXPECT_NE(page.find("0 of 8 rows"), std::string::npos);
}

}  // namespace
}  // namespace snug::study
