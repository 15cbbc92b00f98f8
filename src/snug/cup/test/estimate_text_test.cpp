// The words of data sheets, the catalogue as text, and questions line by line.
#include "snug/cup/estimate_text.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "snug/core/input_error.hpp"
#include "snug/cup/json_lines.hpp"

namespace snug::cup {
namespace {

TEST(GaugePressure, IsReadWithItsUnit) {
  for (const char* text : {"-60kPa", "-600mbar", "-0.6bar", "-60000Pa", "-60 kPa"})
    EXPECT_DOUBLE_EQ(parse_gauge_pressure(text, "--vacuum"), -60000.0) << text;
  for (const char* text : {"-60", "kPa", "-60psi", "nankPa", "-60kPa!", ""})
    EXPECT_THROW((void)parse_gauge_pressure(text, "--vacuum"), InputError) << text;
}

TEST(CupMaterial, IsKnownByItsName) { EXPECT_EQ(cup_material_of("nitrile"), CupMaterial::Nitrile); }

TEST(Catalogue, HasALineAndAnEntryForEachCup) {
  const std::string table = format_catalogue_table();
  const auto cups = static_cast<std::ptrdiff_t>(cup_catalogue().size());
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), cups + 1);
  const auto json = nlohmann::json::parse(format_catalogue_json());
  ASSERT_EQ(json.size(), cup_catalogue().size());
  const CupEstimate first = estimate_cup(cup_catalogue().front());
  EXPECT_EQ(json[0].at("pull_off_N").at("value"), first.pull_off.value);
  EXPECT_EQ(nlohmann::json::parse(format_json(first)).at("parameters").size(), first.estimates.size());
}

TEST(JsonLines, AreAnsweredOneByOneAndEnd) {
  const AnswerLine echo = [](std::string_view line, int number, std::string_view source) {
    return std::string(source) + ":" + std::to_string(number) + " " + std::string(line);
  };
  std::istringstream input("a\n\n \t\r\nb");
  std::vector<std::string> answers;
  answer_json_lines(input, "x", echo, [&](const std::string& answer) { answers.push_back(answer); });
  EXPECT_EQ(answers, (std::vector<std::string>{"x:1 a", "x:4 b"}));
  std::istringstream endless(std::string(200000, 'a'));
  EXPECT_THROW(answer_json_lines(endless, "x", echo, [](const std::string&) {}), InputError);
}

}  // namespace
}  // namespace snug::cup
