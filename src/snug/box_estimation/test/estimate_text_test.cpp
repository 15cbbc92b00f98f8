// An estimate as text: keys, units and order for programs, null for what was not seen, warnings for people.
#include "snug/box_estimation/estimate_text.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace snug::box_estimation {
namespace {

using nlohmann::json;

Estimate written_estimate() {
  Estimate estimate;
  estimate.point_part = 0.93;
  BoxEstimate seen;
  seen.id = "box 1";
  seen.sight = Sight::Seen;
  seen.X_WP = {exp_rotation(Vector3(0.0, 0.0, 0.5)), Vector3(0.1, -0.2, 0.05)};
  seen.covariance.diagonal() << 1e-6, 4e-6, 9e-6, 1e-5, 1e-5, 4e-5;
  seen.covariance(0, 5) = seen.covariance(5, 0) = -2e-6;
  seen.points = 4321;
  seen.visible_part = 0.75;
  seen.rms = 3e-4;
  seen.findings = {Finding::Moved, Finding::Leaning};
  BoxEstimate hidden;
  hidden.id = "box 2";
  hidden.covariance.diagonal().setConstant(1e-4);
  estimate.boxes = {seen, hidden};
  Obstacle obstacle;
  obstacle.low = Vector3(0.0, 0.1, 0.0);
  obstacle.high = Vector3(0.05, 0.2, 0.12);
  obstacle.points = 900;
  estimate.obstacles = {obstacle};
  estimate.heights.cell = 0.005;
  estimate.heights.origin = {-0.2, -0.3};
  estimate.heights.height = camera::Grid2<float>(2, 3, std::numeric_limits<float>::quiet_NaN());
  estimate.heights.height(1, 2) = 0.12345678F;
  return estimate;
}

TEST(EstimateText, HasEachNumberUnderItsKey) {
  const json written = json::parse(format_json(written_estimate()));
  EXPECT_EQ(written["frame"], "none");
  EXPECT_EQ(written["point_part"], 0.93);
  ASSERT_EQ(written["boxes"].size(), 2U);
  const json& box = written["boxes"][0];
  EXPECT_EQ(box["box"], "box 1");
  EXPECT_EQ(box["sight"], "seen");
  EXPECT_EQ(box["position_m"], json({0.1, -0.2, 0.05}));
  EXPECT_NEAR(box["quat_wxyz"][0].get<double>(), std::cos(0.25), 1e-15);
  EXPECT_NEAR(box["quat_wxyz"][3].get<double>(), std::sin(0.25), 1e-15);
  EXPECT_EQ(box["covariance"].size(), 6U);
  EXPECT_EQ(box["covariance"][5][0], -2e-6);
  EXPECT_EQ(box["covariance"][1][1], 4e-6);
  EXPECT_EQ(box["points"], 4321);
  EXPECT_EQ(box["findings"], json({"moved", "leaning"}));
  EXPECT_EQ(written["boxes"][1]["sight"], "hidden");
  EXPECT_EQ(written["boxes"][1]["findings"], json::array());
  EXPECT_EQ(written["obstacles"][0]["high_m"], json({0.05, 0.2, 0.12}));
  EXPECT_EQ(written["obstacles"][0]["points"], 900);
  EXPECT_FALSE(written.contains("height_map"));
}

TEST(EstimateText, HasHeightsByRowsToTenthsOfMillimetresAndNullWhereNothingWasSeen) {
  const json map = json::parse(format_json_with_heights(written_estimate()))["height_map"];
  EXPECT_EQ(map["cell_m"], 0.005);
  EXPECT_EQ(map["origin_m"], json({-0.2, -0.3}));
  ASSERT_EQ(map["height_m"].size(), 2U);
  ASSERT_EQ(map["height_m"][1].size(), 3U);
  EXPECT_TRUE(map["height_m"][0][0].is_null());
  EXPECT_NEAR(map["height_m"][1][2].get<double>(), 0.1235, 1e-12);
  // Everything else is what is written without them.
  json whole = json::parse(format_json_with_heights(written_estimate()));
  whole.erase("height_map");
  EXPECT_EQ(whole, json::parse(format_json(written_estimate())));
}

TEST(EstimateText, OfAFrameThatCannotBeUsedSaysSoFirst) {
  Estimate estimate = written_estimate();
  EXPECT_EQ(format_table(estimate).find("cannot be used"), std::string::npos);
  estimate.fault = FrameFault::TooFewPoints;
  estimate.point_part = 0.31;
  EXPECT_TRUE(format_table(estimate).starts_with("frame cannot be used: too_few_points (31 % of its pixels"))
      << format_table(estimate);
  EXPECT_EQ(json::parse(format_json(estimate))["frame"], "too_few_points");
}

TEST(EstimateText, HasARowForEachBoxWithDeviationsInMillimetres) {
  const std::string text = format_table(written_estimate());
  EXPECT_NE(text.find("1.00     2.00     3.00"), std::string::npos) << text;
  EXPECT_NE(text.find("moved leaning"), std::string::npos);
  EXPECT_NE(text.find("obstacle from (0.000, 0.100, 0.000) to (0.050, 0.200, 0.120) m, 900 points"), std::string::npos);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1 + 2 + 1);
}

TEST(EstimateText, OfNothingIsStillAWholeDocument) {
  const json written = json::parse(format_json({}));
  EXPECT_TRUE(written["boxes"].is_array() && written["boxes"].empty());
  EXPECT_TRUE(written["obstacles"].is_array() && written["obstacles"].empty());
  EXPECT_EQ(json::parse(format_json_with_heights({}))["height_map"]["height_m"], json::array());
}

}  // namespace
}  // namespace snug::box_estimation
