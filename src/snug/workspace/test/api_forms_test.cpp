// The one description of the interface of `snug ui`: the page's types are made of it, and it tells wrong answers from
// right ones.
#include "snug/workspace/api_forms.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace snug::workspace {
namespace {

using OrderedJson = nlohmann::ordered_json;

TEST(ApiForms, TellWhereAnAnswerIsOther) {
  const OrderedJson box = {{"id", "A"}, {"end", "packed"}, {"reason", ""}, {"packed", true}};
  EXPECT_EQ(find_deviation(box, "BoxEnd"), "");
  OrderedJson other = box;
  other["packed"] = 1;
  EXPECT_EQ(find_deviation(other, "BoxEnd"), "packed. 1 instead of boolean");
  other = box;
  other.erase("end");
  EXPECT_EQ(find_deviation(other, "BoxEnd"), "end: missing");
  other = box;
  other["more"] = 1;
  EXPECT_EQ(find_deviation(other, "BoxEnd"), "more: not in BoxEnd");
  EXPECT_EQ(find_deviation(OrderedJson::array({box, other}), "BoxEnd[]"), "1.more: not in BoxEnd");
  EXPECT_EQ(find_deviation(OrderedJson::array({1, 2}), "[number, number, number]"),
            " [1,2] instead of [number, number, number]");
  EXPECT_EQ(find_deviation(OrderedJson(), "number | null"), "");
  EXPECT_EQ(find_deviation(OrderedJson("b"), "\"a\" | \"b\""), "");
  EXPECT_NE(find_deviation(OrderedJson("c"), "\"a\" | \"b\""), "");
  EXPECT_EQ(find_deviation(OrderedJson{{"a", 1}}, "Record<string, number>"), "");
  EXPECT_NE(find_deviation(OrderedJson{{"a", "1"}}, "Record<string, number>"), "");
}

/// To write the file anew: SNUG_WRITE_TYPES=1 in the environment.
TEST(ApiForms, AreWhatThePageReads) {
  const std::filesystem::path path = std::filesystem::path(SNUG_SOURCE_DIR) / "viewer/src/workspace/api_types.ts";
  if (std::getenv("SNUG_WRITE_TYPES") != nullptr) std::ofstream(path) << format_api_types();
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  EXPECT_EQ(text.str(), format_api_types());
}

}  // namespace
}  // namespace snug::workspace
