// Parts moved in the text of a scenario: equal to the same written by hand, and nothing else changes.
#include "snug/model/pose_edit.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/rng.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::model {
namespace {

const std::filesystem::path kScenarios = std::filesystem::path(SNUG_SOURCE_DIR) / "scenarios";

Scenario without_text(Scenario scenario) {
  scenario.source_text.clear();
  return scenario;
}

/// The lines of `after` that `before` does not have at the same place.
std::vector<std::string> changed_lines(const std::string& before, const std::string& after) {
  const auto lines_of = [](const std::string& text) {
    std::vector<std::string> lines(1);
    for (const char c : text) {
      if (c == '\n') {
        lines.emplace_back();
      } else {
        lines.back() += c;
      }
    }
    return lines;
  };
  const std::vector<std::string> a = lines_of(before), b = lines_of(after);
  std::vector<std::string> changed;
  for (std::size_t i = 0; i < b.size(); ++i)
    if (i >= a.size() || a[i] != b[i]) changed.push_back(b[i]);
  return changed;
}

/// A body with its pose written as `pose`, indented as it stands in the file.
std::string scene(const std::string& body) {
  return "name: scene\nmaterials: [{name: m}]\ncontacts: {default: {friction: 0.3, restitution: 0.1}}\n"
         "frames:\n  - {name: F, pose: {position: [1.0, 0.0, 0.0], yaw_deg: 90}}\n"
         "  - {name: down, pose: {rpy_deg: [180, 0, 0]}}\n  - {name: tilted, pose: {rpy_deg: [90, 0, 0]}}\nbodies:\n" +
         body + "  - {name: other, kind: static, material: m, size: [1, 1, 1], pose: {position: [50, 0, 0]}}\n";
}

std::string move(const std::string& text, const Vector3& p_W, double yaw) {
  return move_parts(parse_scenario(text, "scene"), std::vector<PoseEdit>{{"bodies.a", p_W, yaw}});
}

TEST(PoseEdit, MakesTheSameScenarioAsOneWrittenByHandAndKeepsComments) {
  const std::string before = read_file(kScenarios / "init/cell.yaml", "a scenario");
  const Scenario cell = parse_scenario(before, "cell");
  const std::vector<PoseEdit> edits = {{"containers.tote", {0.5, 0.05, 0.02}, 0.0},
                                       {"aligner", {-0.45, -0.1, 0.0}, 0.5 * std::numbers::pi},
                                       {"bodies.bench", {0.1, 0.0, -0.0625}, 0.0}};
  const std::string after = move_parts(cell, edits);
  EXPECT_EQ(
      changed_lines(before, after),
      (std::vector<std::string>{
          "  - {name: tote, pose: {position: [0.5, 0.05, 0.02]}, inner_size: [0.400, 0.300, 0.200], material: tote}",
          "  - {name: bench, kind: static, material: bench, size: [1.8, 1.2, 0.1], pose: {position: [0.1, 0.0, "
          "-0.0625]}}",
          "  pose: {yaw_deg: 90.0, position: [-0.45, -0.1, 0.0]}"}));
  std::string by_hand = before;
  const auto replace = [&](const std::string& what, const std::string& with) {
    ASSERT_NE(by_hand.find(what), std::string::npos);
    by_hand.replace(by_hand.find(what), what.size(), with);
  };
  replace("[0.45, 0.0, 0.02]", "[0.5, 0.05, 0.02]");
  replace("{position: [-0.40, -0.10, 0.0]}", "{position: [-0.450, -0.1, 0], yaw_deg: 90}");
  replace("[0.1, 0.0, -0.05]", "[0.1, 0.0, -0.0625]");
  EXPECT_EQ(without_text(parse_scenario(after, "cell")), without_text(parse_scenario(by_hand, "cell")));
}

TEST(PoseEdit, StaysInTheFrameThatAPoseIsWrittenIn) {
  const Scenario demonstrator = load_scenario(kScenarios / "box-demonstrator.yaml");
  const Container& tote = demonstrator.containers.front();
  const Vector3 p_WT = tote.X_WT.p + Vector3(0.01, 0.02, 0.0);
  const std::string text = move_parts(demonstrator, std::vector<PoseEdit>{{"containers.tote1", p_WT, 0.0}});
  EXPECT_EQ(changed_lines(demonstrator.source_text, text),
            (std::vector<std::string>{"    pose: {position: [0.01, 0.02, 0.0], frame: T}"}));
  // The robot is turned by half a turn: the new angle takes the place of the old one.
  const std::string turned =
      move_parts(demonstrator, std::vector<PoseEdit>{{"robot", {0.0, 0.1, 0.0}, -0.5 * std::numbers::pi}});
  EXPECT_EQ(changed_lines(demonstrator.source_text, turned),
            (std::vector<std::string>{
                "  pose: {position: [0.0, 0.1, 0.0], yaw_deg: -90.0}           # W is the controller's \"base\": "
                "base_link turned by half a turn"}));
}

TEST(PoseEdit, FindsPosesInAllTheFormsTheyAreWrittenIn) {
  const std::string head = "  - {name: a, kind: static, material: m, size: [0.1, 0.1, 0.1]";
  for (const std::string& body : {
           head + "}\n",
           head + ", pose: {}}\n",
           head + ", pose: {yaw_deg: 20}}\n",
           head + ", pose: { position: [ 1,2 , 3 ] , yaw_deg: 20.5 }} # position: [0, 0, 0]\n",
           head + ", pose: {rpy_deg: [10, 20, 30], position: [1, 2, 3]}}\n",
           head + ", pose: {frame: F, position: [1, 2, 3]}}\n",
           head + ", pose: {frame: down, position: [1, 2, 3]}}\n",
           std::string("  - name: a\n    kind: static\n    material: m\n    size: [0.1, 0.1, 0.1]\n"),
           std::string("  - name: a\n    kind: static\n    pose:\n      # where\n      position: [1, 2, 3] # m\n      "
                       "yaw_deg: 7\n    material: m\n    size: [0.1, 0.1, 0.1]\n"),
           std::string("  -\n    kind: static\n    pose:\n      frame: F\n    name: \"a\"\n    material: m\n    size: "
                       "[0.1, 0.1, 0.1]\n"),
       }) {
    SCOPED_TRACE(body);
    const std::string before = scene(body);
    const Scenario old = parse_scenario(before, "scene");
    for (const double turn : {0.0, 0.3}) {
      const double yaw = yaw_about_vertical(old.bodies[0].X_WB.R) + turn;
      const std::string text = move(before, {0.25, -0.5, 0.125}, yaw);
      const Scenario now = parse_scenario(text, "scene");
      EXPECT_LT((now.bodies[0].X_WB.p - Vector3(0.25, -0.5, 0.125)).norm(), 1e-6) << text;
      const Matrix3 wanted = exp_rotation(Vector3(0.0, 0.0, turn)) * old.bodies[0].X_WB.R;
      EXPECT_LT(angle_between(now.bodies[0].X_WB.R, wanted), 1e-6) << text;
      EXPECT_EQ(now.bodies[1], old.bodies[1]);
    }
  }
}

TEST(PoseEdit, RefusesWhatWouldChangeMoreThanThePose) {
  const std::string head = "  - {name: a, kind: static, material: m, size: [0.1, 0.1, 0.1], pose: ";
  const auto is_refused = [](const std::string& text, double yaw = 0.0, const std::string& key = "bodies.a") {
    try {
      const Scenario scenario = parse_scenario(text, "scene");
      (void)move_parts(scenario, std::vector<PoseEdit>{{key, Vector3(0.1, 0.2, 0.3), yaw}});
    } catch (const InputError& error) {
      EXPECT_EQ(error.key, key);
      return true;
    }
    return false;
  };
  EXPECT_FALSE(is_refused(scene(head + "{quat_wxyz: [1, 0, 0, 0]}}\n")));
  EXPECT_TRUE(is_refused(scene(head + "{quat_wxyz: [1, 0, 0, 0]}}\n"), 0.1));
  EXPECT_TRUE(is_refused(scene(head + "{frame: tilted}}\n"), 0.1));
  EXPECT_TRUE(is_refused(scene(head + "{position: [1, 2,\n 3]}}\n")));
  EXPECT_TRUE(is_refused(scene(head + "{}}\n"), 0.0, "bodies.none"));
  EXPECT_TRUE(is_refused(scene(head + "{}}\n"), 0.0, "materials.m"));
  EXPECT_TRUE(is_refused(scene(head + "{}}\n"), std::nan("")));
  // One list of numbers for two: to move one would move both.
  const std::string shared =
      scene(head + "{position: &p [1, 2, 3]}}\n" +
            "  - {name: c, kind: static, material: m, size: [0.1, 0.1, 0.1], pose: {position: *p, frame: F}}\n");
  EXPECT_TRUE(is_refused(shared));
  EXPECT_TRUE(is_refused(shared, 0.5 * std::numbers::pi, "bodies.c"));
}

TEST(PoseEdit, MovesAllPartsOfTheShippedScenariosBackAndForth) {
  Rng rng = Rng(3).split("pose edit");
  for (const char* file : {"box-demonstrator.yaml", "pallet-four-cups.yaml", "init/cell.yaml", "init/pallet.yaml"}) {
    const Scenario before = load_scenario(kScenarios / file);
    for (const CellPart& part : find_parts(before)) {
      SCOPED_TRACE(std::string(file) + " " + part.key);
      const double yaw = yaw_about_vertical(part.X_W.R);
      const Vector3 there(rng.uniform(-0.4, 0.4), rng.uniform(-0.4, 0.4), rng.uniform(-0.4, 0.4));
      Scenario moved = before;  // it may overlap there: its reader is not asked
      moved.source_text = move_parts(before, std::vector<PoseEdit>{{part.key, part.X_W.p + there, yaw + 1.0}});
      EXPECT_NE(moved.source_text, before.source_text);
      const Scenario back =
          parse_scenario(move_parts(before, std::vector<PoseEdit>{{part.key, part.X_W.p, yaw}}), before.source_name);
      const auto same = find_parts(back);
      const auto it = std::ranges::find(same, part.key, &CellPart::key);
      ASSERT_NE(it, same.end());
      EXPECT_LT((it->X_W.p - part.X_W.p).norm(), 2e-6);
    }
  }
}

}  // namespace
}  // namespace snug::model
