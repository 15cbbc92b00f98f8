// What became of a program elsewhere: objects that told a place, times, and why it failed.
#include "snug/remote_plant/program_text.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace snug::remote_plant {
namespace {

ProgramClientResult result_with_box() {
  ProgramClientResult result;
  result.duration = 2.5;
  result.simulated = 4.0;
  result.wall = 2.0;
  result.ticks = 500;
  click::SensorValue place;
  place.type = click::ValueType::Position;
  place.vector = Vector3(0.1, 0.2, 0.3);
  result.last.objects["BOX\n001"].object.push_back(place);
  return result;
}

TEST(ProgramText, TableHasPlacesInMillimetresAndNothingThatATerminalWouldAct) {
  ProgramClientResult result = result_with_box();
  std::string table = format_table(result);
  EXPECT_NE(table.find("   100.00    200.00    300.00\n"), std::string::npos) << table;
  EXPECT_EQ(table.find("BOX\n"), std::string::npos) << table;
  EXPECT_NE(table.find("program            2.50 s, 500 ticks in 2.00 s, real-time factor 2\n"), std::string::npos)
      << table;
  EXPECT_EQ(table.find("failed"), std::string::npos);
  result.failure = "it stopped";
  result.row = 4;
  EXPECT_NE(format_table(result).find("failed             toward waypoint 5: it stopped\n"), std::string::npos);
}

TEST(ProgramText, JsonHasTheSameInMetres) {
  const auto json = nlohmann::json::parse(format_json(result_with_box()));
  EXPECT_EQ(json.at("real_time_factor"), 2.0);
  EXPECT_EQ(json.at("objects").at("BOX\n001").at("position_m").at(2), 0.3);
  EXPECT_EQ(json.at("failure"), "");
}

}  // namespace
}  // namespace snug::remote_plant
