// Tests of task files and of edits of numbers: strict, with line and nearest name.
#include "snug/model/scene_task.hpp"

#include <gtest/gtest.h>

#include "snug/core/input_error.hpp"
#include "snug/model/number_edit.hpp"

namespace snug::model {
namespace {

constexpr const char* kTask = R"(scenario: cube.yaml
input_columns: {recording: toss, time: t}
tracked_objects: [{body: cube}]
parameters:
  - {name: friction, path: "contacts.pairs[0].friction", value: 0.2, bounds: [0.1, 0.5]}
)";

std::string complaint(const std::string& text) {
  try {
    (void)parse_scene_task(text, "folder/task.yaml");
  } catch (const InputError& error) {
    return error.what();
  }
  return "taken";
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(SceneTask, ReadsWhatItSays) {
  const SceneTask task = parse_scene_task(kTask, "folder/task.yaml");
  EXPECT_EQ(task.scenario, std::filesystem::path("folder/cube.yaml"));
  EXPECT_EQ(task.recording_column, "toss");
  ASSERT_EQ(task.parameters.size(), 1U);
  EXPECT_EQ(task.parameters[0].paths, (std::vector<std::string>{"contacts.pairs[0].friction"}));
  EXPECT_DOUBLE_EQ(task.parameters[0].step, 0.004);
  EXPECT_DOUBLE_EQ(task.rotation_position_ratio, task.position_noise / task.rotation_noise);
}

TEST(SceneTask, ComplaintsNameLineKeyAndNearest) {
  EXPECT_NE(complaint(replaced(kTask, "scenario:", "scenaro:")).find("scenario"), std::string::npos);
  EXPECT_NE(complaint(replaced(kTask, "value: 0.2", "value: 0.7")).find("within the bounds"), std::string::npos);
  EXPECT_NE(complaint(replaced(kTask, "value: 0.2", "value: .nan")).find("task.yaml:5"), std::string::npos);
  EXPECT_NE(complaint(replaced(kTask, "[0.1, 0.5]", "[0.5, 0.1]")).find("above 0.5"), std::string::npos);
  EXPECT_NE(complaint(std::string(kTask) + "loss: squared\n").find("squares"), std::string::npos);
  EXPECT_NE(
      complaint(std::string(kTask) + "optimize_position: false\noptimize_rotation: false\n").find("something to fit"),
      std::string::npos);
  EXPECT_NE(complaint(std::string(kTask) + "  - {name: friction, path: \"gravity[2]\", value: 0, bounds: [-1, 1]}\n")
                .find("a second time"),
            std::string::npos);
}

TEST(SceneTask, IsWrittenWithNewValues) {
  const SceneTask task = parse_scene_task(kTask, "folder/task.yaml");
  const SceneTask again = parse_scene_task(text_with_values(task, {0.3125}, "folder"), "folder/task.yaml");
  EXPECT_EQ(again.parameters[0].value, 0.3125);
  EXPECT_EQ(again.scenario, task.scenario);
}

constexpr const char* kScene = R"(materials: [{name: box}]
contacts: {default: {friction: 0.3, restitution: 0.1}}
bodies:
  - {name: cube, size: [0.1, 0.2, 0.3], mass: 1, material: box}
)";

TEST(NumberEdit, ChangesTheNumberAtItsPathAndNothingElse) {
  const Scenario scenario = parse_scenario(kScene, "scene.yaml");
  EXPECT_EQ(find_number(scenario, "bodies.cube.size[1]", "here"), 0.2);
  EXPECT_EQ(find_number(scenario, "contacts.default.stiffness", "here"), std::nullopt);
  const NumberEdit edits[] = {{"bodies[0].mass", 2.5}, {"contacts.default.stiffness", 1e4}};
  const Scenario changed = with_numbers(scenario, edits);
  EXPECT_EQ(changed.bodies[0].inertia.mass, 2.5);
  EXPECT_EQ(changed.default_contact->stiffness, 1e4);
  EXPECT_EQ(changed.default_contact->friction, scenario.default_contact->friction);
  EXPECT_EQ(changed.bodies[0].shapes, scenario.bodies[0].shapes);
}

TEST(NumberEdit, RefusesWhatNoScenarioCanHave) {
  const Scenario scenario = parse_scenario(kScene, "scene.yaml");
  const NumberEdit negative[] = {{"bodies.cube.mass", -1.0}};
  EXPECT_THROW((void)with_numbers(scenario, negative), InputError);
  for (const char* path : {"bodies.cub.mass", "bodies.cube.size[7]", "bodies", "", "bodies..mass", "bodies.cube.name",
                           "contacts.default.frictn"})
    EXPECT_THROW((void)find_number(scenario, path, "here"), InputError) << path;
}

}  // namespace
}  // namespace snug::model
