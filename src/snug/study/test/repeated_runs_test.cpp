// Repeated runs: rows as they are read, and their spread in closed form.
#include "snug/study/repeated_runs.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace snug::study {
namespace {

RowResult row(const std::string& boxes, const std::string& hash) {
  RowResult result;
  result.values = {{"boxes", boxes}, {"filling_degree_percent", 42.5}, {"repick_offset_worst_mm", 1.5}};
  if (!hash.empty()) result.values.emplace_back("state_hash", hash);
  result.error = "what it said last";
  return result;
}

TEST(RepeatedRuns, CountPackedBoxesAndKeepWhatWasMeasured) {
  const RepeatedRun run =
      read_repeated_run(row(R"([{"state": "packed"}, {"state": "lost"}, {"state": "packed"}])", "ab"));
  EXPECT_EQ(run.boxes, 3);
  EXPECT_EQ(run.packed, 2);
  EXPECT_EQ(run.filling_degree_percent, 42.5);
  EXPECT_EQ(run.worst_repick_mm, 1.5);
  EXPECT_EQ(run.failure, "") << "the row's last words are no failure where the run came to its end";
}

TEST(RepeatedRuns, SayWhyARowHasNoStateAndReadNoBoxesOfBrokenJson) {
  const RepeatedRun run = read_repeated_run(row("[{\"state\": ", ""));
  EXPECT_EQ(run.boxes, 0);
  EXPECT_EQ(run.failure, "what it said last");
}

TEST(RepeatedRuns, SpreadIsMeanDeviationAndLowestOfThePackedFractions) {
  RepeatedRun all, half;
  all.packed = all.boxes = half.boxes = 4;
  half.packed = 2;
  half.failure = "stop";
  const PackedSpread spread = find_spread({all, half});
  EXPECT_DOUBLE_EQ(spread.mean, 75.0);
  EXPECT_DOUBLE_EQ(spread.deviation, 25.0);
  EXPECT_DOUBLE_EQ(spread.lowest, 50.0);
  EXPECT_EQ(spread.failed, 1);
  EXPECT_EQ(find_spread({}).mean, 0.0);
}

TEST(RepeatedRuns, JsonHasEachRunAndTheSpread) {
  RepeatedRun one;
  one.packed = one.boxes = 1;
  one.state_hash = "ab";
  const auto json = nlohmann::json::parse(format_json({one}));
  EXPECT_EQ(json.at("mean_packed_percent"), 100.0);
  EXPECT_EQ(json.at("runs").at(0).at("state_hash"), "ab");
  EXPECT_NE(format_table({one}).find("mean 100.0 %"), std::string::npos);
}

}  // namespace
}  // namespace snug::study
