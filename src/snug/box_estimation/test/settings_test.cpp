// EstimatorSettings: each field is listed once with unit and reason, does something, and stands on no knife's edge.
#include "snug/box_estimation/settings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "snug/box_estimation/test/scene.hpp"
#include "snug/core/read_file.hpp"

namespace snug::box_estimation {
namespace {

using namespace test;

const char* name_of(Basis basis) {
  switch (basis) {
    case Basis::Derived:
      return "derived";
    case Basis::Measured:
      return "measured";
    case Basis::Chosen:
      break;
  }
  return "chosen";
}

/// Size of the fields that a struct lists, with padding where a double follows ints.
struct Sizes {
  std::size_t bytes = 0;
  std::set<std::string> names;
  template <class T>
  void operator()(const char* name, T& /*value*/, const char* unit, Basis basis, const char* reason) {
    bytes = (bytes + sizeof(T) - 1) / sizeof(T) * sizeof(T) + sizeof(T);
    EXPECT_TRUE(names.insert(name).second) << name << " twice";
    EXPECT_NE(unit, nullptr);
    EXPECT_GT(std::string(reason).size(), 3u) << name;
    EXPECT_NE(name_of(basis), nullptr);
  }
};

TEST(EstimatorSettings, ListEveryFieldOnceWithItsReason) {
  EstimatorSettings settings;
  int sections = 0;
  settings.sections([&](const char* section, auto& part) {
    SCOPED_TRACE(section);
    ++sections;
    Sizes sizes;
    part.fields(sizes);
    EXPECT_EQ((sizes.bytes + 7) / 8 * 8, (sizeof part + 7) / 8 * 8) << "a field that is not listed";
  });
  EXPECT_EQ(sections, 8);
}

/// The rows of docs/box-estimation.md.
struct Rows {
  std::string section, text;
  template <class T>
  void operator()(const char* name, T& value, const char* unit, Basis basis, const char* reason) {
    std::ostringstream row;
    row << "| `" << section << '.' << name << "` | " << value << " | " << unit << " | " << name_of(basis) << " | "
        << reason << " |\n";
    text += row.str();
  }
};

TEST(EstimatorSettings, AreThoseOfTheDocumentation) {
  EstimatorSettings settings;
  Rows rows;
  settings.sections([&](const char* section, auto& part) {
    rows.section = section;
    part.fields(rows);
  });
  const std::string docs = read_file(std::string(SNUG_SOURCE_DIR) + "/docs/box-estimation.md", "documentation");
  const std::size_t begin = docs.find("| `tracking.least_points`");
  ASSERT_NE(begin, std::string::npos) << "put these rows there:\n" << rows.text;
  EXPECT_EQ(docs.substr(begin, rows.text.size()), rows.text) << "put these rows there:\n" << rows.text;
}

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
