// What a controller says of itself, as text: signals by their names, what does not fit with its remedy.
#include "snug/remote_ur/report_text.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace snug::remote_ur {
namespace {

RobotReport some_robot() {
  RobotReport robot;
  robot.model = "UR10";
  robot.version = {5, 12, 0, 1};
  robot.state.digital_outputs = 0b101;
  robot.tool_voltage = 5.0;
  return robot;
}

const Finding kWrong{"payload", Verdict::Differs, "0 kg", "1.2 kg", "set it"};

TEST(ReportText, SaysWhichSignalsAreOnAndWhatToSet) {
  model::RobotIo io;
  io.vacuum = {model::DigitalKind::Standard, 2, false};
  io.blow_off = model::DigitalIo{model::DigitalKind::Standard, 0, true};
  io.vacuum_gauge = model::GaugeIo{};
  const std::string text = format_text(some_robot(), {{"kinematics", Verdict::Fits, "0.1 mm", "", ""}, kWrong}, io);
  EXPECT_EQ(
      text.find("model              UR10, software 5.12.0.1\noutputs that are on 0, 2\ninputs that are on  none\n"), 0U)
      << text;
  EXPECT_NE(text.find("vacuum             standard output 2: on\n"), std::string::npos) << text;
  EXPECT_NE(text.find("blow-off           standard output 0: off (active low)\n"), std::string::npos) << text;
  EXPECT_NE(text.find("vacuum gauge       -50.0 kPa\n"), std::string::npos) << text;
  EXPECT_NE(text.find("differs  payload         0 kg; needed: 1.2 kg\n                         set it\n"),
            std::string::npos)
      << text;
}

TEST(ReportText, FitsUnlessSomethingIsKnownToDiffer) {
  EXPECT_TRUE(fits({{"remote control", Verdict::Unknown, "", "", ""}}));
  EXPECT_FALSE(fits({kWrong}));
  const auto json = nlohmann::json::parse(format_json(some_robot(), {kWrong}));
  EXPECT_EQ(json.at("fits"), false);
  EXPECT_EQ(json.at("findings").at(0).at("remedy"), "set it");
  EXPECT_EQ(json.at("version"), "5.12.0.1");
}

}  // namespace
}  // namespace snug::remote_ur
