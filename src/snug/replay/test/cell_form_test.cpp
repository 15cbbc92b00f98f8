// Tests of a cell as a form of one frame: what stands there, the arm at its start, and without its file.
#include "snug/replay/cell_form.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "snug/cell/test/demonstrator.hpp"
#include "snug/replay/form.hpp"

namespace snug::replay {
namespace {

using cell::demonstrator;

TEST(CellForm, ShowsWhatStandsThereAndTheArmAtItsStart) {
  const model::Scenario& scenario = demonstrator();
  const Form form = decode_form(encode_cell(scenario), "cell");
  const auto header = nlohmann::json::parse(form.header_json);
  EXPECT_EQ(header["frames"], 1);
  EXPECT_EQ(header["container"]["name"], scenario.target);
  const auto& bodies = header["bodies"];
  const auto index_of = [&](const std::string& name) {
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (bodies[i]["name"] == name) return static_cast<int>(i);
    return -1;
  };
  for (const char* name : {"workbench", "tote1", "tote2", "conveyor", "tool", "robot/forearm_link"})
    EXPECT_GE(index_of(name), 0) << name;
  const Channel* tool = find_channel(form, "body." + std::to_string(index_of("tool")) + ".pose");
  ASSERT_NE(tool, nullptr);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(tool->at(0, static_cast<std::size_t>(i)), scenario.controller.X_WE_start.p[i], 1e-4);
  const Channel* joints = find_channel(form, "joints.position");
  ASSERT_NE(joints, nullptr);
  EXPECT_EQ(joints->spec.columns.size(), 6U);
}

TEST(CellForm, IsMadeWhereTheStartIsOutOfReachAndWithoutARobot) {
  model::Scenario far = demonstrator();
  far.robot->X_WB.p.x() -= 5.0;
  EXPECT_NO_THROW((void)decode_form(encode_cell(far), "cell"));
  model::Scenario none = demonstrator();
  none.robot->urdf = "none.urdf";
  EXPECT_EQ(find_channel(decode_form(encode_cell(none), "cell"), "joints.position"), nullptr);
  none.robot.reset();
  none.tool.reset();
  EXPECT_NO_THROW((void)decode_form(encode_cell(none), "cell"));
}

}  // namespace
}  // namespace snug::replay
