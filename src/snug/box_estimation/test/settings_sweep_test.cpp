// EstimatorSettings: none stands on a knife's edge.
#include "snug/box_estimation/settings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "snug/box_estimation/test/scene.hpp"

namespace snug::box_estimation {
namespace {

using namespace test;

/// A pointer to each number of some settings.
struct Numbers {
  std::string section;
  std::vector<std::pair<std::string, double*>> reals;
  std::vector<std::pair<std::string, int*>> wholes;
  void operator()(const char* name, double& value, const char*, Basis, const char*) {
    reals.emplace_back(section + "." + name, &value);
  }
  void operator()(const char* name, int& value, const char*, Basis, const char*) {
    wholes.emplace_back(section + "." + name, &value);
  }
};

Numbers numbers_of(EstimatorSettings& settings) {
  Numbers numbers;
  settings.sections([&](const char* section, auto& part) {
    numbers.section = section;
    part.fields(numbers);
  });
  return numbers;
}

/// A box at rest, one that was moved and one that was taken away; what is stated of each.
struct Disturbed {
  Disturbed() : cell("structured_light"), boxes(three_boxes()), real(boxes) {
    input = expect(cell, boxes, 3);
    real[1].X_WP = level(0.12, 0.22, 0.03, 0.3);
    real.erase(real.begin() + 2);
    frame = frame_of(cell, real, 3);
  }
  Cell cell;
  std::vector<Box> boxes, real;
  EstimateInput input;
  camera::Frame frame;
};

/// Every setting, a tenth less and a tenth more (whole numbers: one): what is seen, moved and missing stays the same,
/// and poses stay within their three deviations. What stands on a knife's edge fails here.
TEST(EstimatorSettings, NoneStandsOnAKnifesEdge) {
  const Disturbed scene;
  EstimatorSettings settings;
  const Numbers numbers = numbers_of(settings);
  const auto expect_right = [&](const std::string& what) {
    SCOPED_TRACE(what);
    const Estimate estimate = estimate_boxes(scene.frame, scene.input, settings);
    ASSERT_EQ(estimate.fault, FrameFault::None);
    EXPECT_EQ(estimate.boxes[0].sight, Sight::Seen);
    EXPECT_EQ(estimate.boxes[1].sight, Sight::Seen);
    EXPECT_EQ(estimate.boxes[2].sight, Sight::Missing);
    EXPECT_EQ(estimate.boxes[1].findings, std::vector<Finding>{Finding::Moved});
    for (std::size_t i = 0; i < 2; ++i) {
      const double deviation = std::sqrt(estimate.boxes[i].covariance.topLeftCorner<3, 3>().trace());
      EXPECT_LT((estimate.boxes[i].X_WP.p - scene.boxes[i == 0 ? 0 : 1].X_WP.p).norm(), i == 0 ? 4.0 * deviation : 1.0);
      EXPECT_LT((estimate.boxes[i].X_WP.p - scene.real[i].X_WP.p).norm(), 4.0 * deviation);
    }
  };
  expect_right("as they are");
  for (const auto& [name, value] : numbers.reals) {
    const double usual = *value;
    for (const double factor : {0.9, 1.1}) {
      *value = std::min(factor * usual, name == "search.same_normal" ? 0.999 : factor * usual);
      if (name == "tracking.doubtful_part_on") *value = std::min(*value, 1.0);
      expect_right(name + " times " + std::to_string(factor));
    }
    *value = usual;
  }
  for (const auto& [name, value] : numbers.wholes) {
    const int usual = *value, step = std::max(1, usual / 10);
    for (const int changed : {usual - step, usual + step}) {
      *value = changed;
      expect_right(name + " = " + std::to_string(changed));
    }
    *value = usual;
  }
  EXPECT_EQ(settings, EstimatorSettings{});
}

}  // namespace
}  // namespace snug::box_estimation
