// EstimatorSettings: each field is listed once with unit and reason, as in the documentation.
#include "snug/box_estimation/settings.hpp"

#include <gtest/gtest.h>

#include <set>
#include <sstream>
#include <string>

#include "snug/core/read_file.hpp"

namespace snug::box_estimation {
namespace {

const char* name_of(Basis basis) {
  switch (basis) {
    case Basis::Derived:
      return "derived";
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

}  // namespace
}  // namespace snug::box_estimation
