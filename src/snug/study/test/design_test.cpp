// Designs: rows from indices, files of studies, Sobol points.
#include "snug/study/design.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "snug/core/input_error.hpp"
#include "snug/study/sobol.hpp"

namespace snug::study {
namespace {

constexpr const char* kGrid =
    "verb: pack\nscenario: a.yaml\noptions: {--samples: 0, --quiet: true, --items: [x.csv, y.csv]}\nrepeat: 2\n"
    "factors:\n  - {option: --agent, values: [margin, contact-aware]}\n"
    "  - {set: cup.lip_radius, values: [0.03, 0.035, 0.04]}\n";

Study drawn(const std::string& design, int rows) {
  return parse_study("verb: pack\ndesign: " + design + "\nrows: " + std::to_string(rows) +
                         "\nfactors:\n  - {set: a, from: 2, to: 4}\n  - {set: b, from: 1, to: 100, scale: log}\n"
                         "  - {option: --n, from: 1, to: 3, whole: true}\n  - {option: --w, values: [x, y]}\n",
                     "study.yaml");
}

std::string refusal_of(const std::string& text) {
  try {
    (void)parse_study(text, "study.yaml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Design, GridHasEveryCombinationWithTheLastFactorFastest) {
  const Study study = parse_study(kGrid, "study.yaml");
  EXPECT_EQ(study.rows(), 12U);
  EXPECT_EQ(row_of(study, 0).values, (std::vector<std::string>{"margin", "0.03"}));
  EXPECT_EQ(row_of(study, 1).values, row_of(study, 0).values);
  EXPECT_EQ(row_of(study, 2).values, (std::vector<std::string>{"margin", "0.035"}));
  EXPECT_EQ(row_of(study, 11).values, (std::vector<std::string>{"contact-aware", "0.04"}));
  std::set<std::vector<std::string>> seen;
  for (std::uint64_t i = 0; i < 12; ++i) seen.insert(row_of(study, i).values);
  EXPECT_EQ(seen.size(), 6U);
}

TEST(Design, WordsOfARowAreThoseOfTheCommandLine) {
  const Study study = parse_study(kGrid, "study.yaml");
  const Row row = row_of(study, 5);
  const std::vector<std::string> expected = {"pack",
                                             "a.yaml",
                                             "--samples",
                                             "0",
                                             "--quiet",
                                             "--items",
                                             "x.csv",
                                             "--items",
                                             "y.csv",
                                             "--agent",
                                             "margin",
                                             "--set",
                                             "cup.lip_radius=0.04",
                                             "--seed",
                                             std::to_string(row.seed)};
  EXPECT_EQ(words_of(study, row), expected);
  EXPECT_EQ(quoted("a b"), "'a b'");
  EXPECT_EQ(quoted("it's"), "'it'\\''s'");
  EXPECT_EQ(quoted(""), "''");
}

TEST(Design, SeedsAreEachRowsOwnOrEachRepetitions) {
  Study study = parse_study(kGrid, "study.yaml");
  std::set<std::uint64_t> seeds;
  for (std::uint64_t i = 0; i < 12; ++i) seeds.insert(row_of(study, i).seed);
  EXPECT_EQ(seeds.size(), 12U);
  study.seed_by = SeedBy::Repeat;
  EXPECT_EQ(row_of(study, 0).seed, row_of(study, 4).seed);
  EXPECT_NE(row_of(study, 0).seed, row_of(study, 1).seed);
}

TEST(Design, AFactorForTheSeedTakesItsPlace) {
  const Study study = parse_study("verb: pack\nfactors: [{option: --seed, values: [5, 6]}]\n", "study.yaml");
  EXPECT_EQ(words_of(study, row_of(study, 1)), (std::vector<std::string>{"pack", "--seed", "6"}));
}

TEST(Design, RandomAndSobolStayInTheirRangesAndHitEveryValue) {
  for (const char* design : {"random", "sobol"}) {
    const Study study = drawn(design, 256);
    double sum = 0.0, log_sum = 0.0;
    std::set<std::string> whole, words;
    for (std::uint64_t i = 0; i < 256; ++i) {
      const Row row = row_of(study, i);
      const double a = std::stod(row.values[0]), b = std::stod(row.values[1]);
      EXPECT_TRUE(a >= 2.0 && a <= 4.0 && b >= 1.0 && b <= 100.0) << a << " " << b;
      sum += a / 256.0;
      log_sum += std::log10(b) / 256.0;
      whole.insert(row.values[2]);
      words.insert(row.values[3]);
    }
    // Four standard errors of a uniform draw; a Sobol design is far better.
    EXPECT_NEAR(sum, 3.0, 4.0 * 2.0 / std::sqrt(12.0 * 256.0));
    EXPECT_NEAR(log_sum, 1.0, 4.0 * 2.0 / std::sqrt(12.0 * 256.0));
    EXPECT_EQ(whole, (std::set<std::string>{"1", "2", "3"}));
    EXPECT_EQ(words, (std::set<std::string>{"x", "y"}));
  }
}

TEST(Design, AFactorMoreLeavesTheDrawsOfTheOthers) {
  const Study one = parse_study("verb: v\ndesign: random\nrows: 5\nfactors: [{set: a, from: 0, to: 1}]\n", "s");
  const Study two = parse_study(
      "verb: v\ndesign: random\nrows: 9\nfactors: [{set: z, from: 0, to: 1}, {set: a, from: 0, to: 1}]\n", "s");
  for (std::uint64_t i = 0; i < 5; ++i) EXPECT_EQ(row_of(one, i).values[0], row_of(two, i).values[1]);
}

TEST(Design, ListHasThePointsThatAreListed) {
  const Study study = parse_study(
      "verb: pack\ndesign: list\nfactors: [{option: --agent}, {set: gravity}]\n"
      "points:\n  - {agent: margin, gravity: [0, 0, -1.6]}\n  - {gravity: [0, 0, -9.8], agent: manual}\n",
      "study.yaml");
  EXPECT_EQ(study.rows(), 2U);
  EXPECT_EQ(row_of(study, 1).values, (std::vector<std::string>{"manual", "[0, 0, -9.8]"}));
}

TEST(Design, PointsOfAListCanNameTheirRecordings) {
  const Study study = parse_study(
      "verb: pack\ndesign: list\nfactors: [{option: --record}]\n"
      "points: [{record: a.h5}, {record: false}, {record: false}]\n",
      "study.yaml");
  EXPECT_EQ(command_of(study, row_of(study, 0)),
            "snug pack --record a.h5 --seed " + std::to_string(row_of(study, 0).seed));
  EXPECT_EQ(command_of(study, row_of(study, 1)).find("--record"), std::string::npos);
}

TEST(Design, FilesThatAreNoStudiesAreRefusedWithTheirLine) {
  for (const auto& [text, word] : std::vector<std::pair<std::string, std::string>>{
           {"", ""},
           {"[1]", "mapping"},
           {"scenario: a\n", "verb"},
           {"verb: study\n", "verb"},
           {"verb: pack\nfactor: []\n", "study.yaml:2"},
           {"verb: pack\ndesign: cube\n", "cube"},
           {"verb: pack\ndesign: sobol\n", "rows"},
           {"verb: pack\ndesign: sobol\nrows: 0\n", "rows"},
           {"verb: pack\ndesign: sobol\nrows: 99999999999\n", "rows"},
           {"verb: pack\nrows: 5\n", "rows"},
           {"verb: pack\nrepeat: 0\n", "repeat"},
           {"verb: pack\nrepeat: -1\n", "repeat"},
           {"verb: pack\nseed: nan\n", "seed"},
           {"verb: pack\nchunk: 0\n", "chunk"},
           {"verb: pack\noptions: {agent: x}\n", "agent"},
           {"verb: pack\noptions: {--json: true}\n", "--json"},
           {"verb: pack\noptions: {-o: x.h5}\n", "-o"},
           {"verb: pack\nfactors: [{values: [1]}]\n", "option"},
           {"verb: pack\nfactors: [{option: --exit, values: [1]}]\n", "exit"},
           {"verb: pack\nfactors: [{option: --a, set: b, values: [1]}]\n", "either"},
           {"verb: pack\nfactors: [{option: --a}]\n", "values"},
           {"verb: pack\nfactors: [{option: --record, values: [a.h5, b.h5]}]\n", "--record"},
           {"verb: pack\ndesign: list\nfactors: [{option: --record}]\npoints: [{record: a.h5}, {record: a.h5}]\n",
            "its own"},
           {"verb: pack\nrepeat: 2\ndesign: list\nfactors: [{option: --record}]\npoints: [{record: a.h5}]\n",
            "its own"},
           {"verb: pack\nfactors: [{option: --a, from: 1, to: 2}]\n", "grid"},
           {"verb: pack\nfactors: [{option: --a, values: []}]\n", "values"},
           {"verb: pack\nfactors: [{option: --a, values: [1]}, {option: --a, values: [2]}]\n", "again"},
           {"verb: pack\ndesign: random\nrows: 2\nfactors: [{set: a, from: 2, to: 1}]\n", "to"},
           {"verb: pack\ndesign: random\nrows: 2\nfactors: [{set: a, from: .nan, to: 1}]\n", "from"},
           {"verb: pack\ndesign: random\nrows: 2\nfactors: [{set: a, from: 0, to: 1, scale: log}]\n", "from"},
           {"verb: pack\ndesign: list\nfactors: [{set: a}]\n", "points"},
           {"verb: pack\ndesign: list\nfactors: [{set: a}]\npoints: [{b: 1}]\n", "b"},
           {"verb: pack\ndesign: list\nfactors: [{set: a}]\npoints: [{}]\n", "a"},
           {"verb: pack\noutputs: [{name: a, worst: left}]\n", "left"},
           {"verb: pack\ntime_limit: 0\n", "time_limit"},
           {"verb: &a [*a]\n", ""}}) {
    SCOPED_TRACE(text);
    const std::string message = refusal_of(text);
    EXPECT_NE(message, "");
    EXPECT_NE(message.find(word), std::string::npos) << message;
  }
}

TEST(Sobol, FirstPointsAreThoseOfTheTable) {
  // Joe and Kuo's own listing of the first points (in the order of indices without Gray code).
  const double second[] = {0.0, 0.5, 0.75, 0.25};
  for (std::uint32_t i = 0; i < 4; ++i) EXPECT_EQ(sobol(i, 1), second[i]);
  EXPECT_EQ(sobol(1, 0), 0.5);
  EXPECT_EQ(sobol(2, 0), 0.25);
  EXPECT_EQ(sobol(3, 0), 0.75);
}

TEST(Sobol, EveryPowerOfTwoOfPointsHasOneInEachInterval) {
  for (int dimension = 0; dimension < kMostSobolDimensions; ++dimension) {
    for (const std::uint32_t count : {2U, 16U, 256U, 1024U}) {
      for (const std::uint32_t shift : {0U, 0x9e3779b9U}) {
        std::set<std::uint32_t> intervals;
        for (std::uint32_t i = 0; i < count; ++i) {
          intervals.insert(static_cast<std::uint32_t>(sobol(i, dimension, shift) * count));
        }
        ASSERT_EQ(intervals.size(), count) << dimension;
      }
    }
  }
}

TEST(Sobol, IntegratesAProductFarBetterThanChance) {
  // Integral of prod (1 + (x_i - 1/2)) over the unit cube is 1; 4096 random points would be off by about 0.02.
  double sum = 0.0;
  for (std::uint32_t i = 0; i < 4096; ++i) {
    double product = 1.0;
    for (int d = 0; d < kMostSobolDimensions; ++d) product *= 0.5 + sobol(i, d);
    sum += product / 4096.0;
  }
  EXPECT_NEAR(sum, 1.0, 0.01);
}

}  // namespace
}  // namespace snug::study
