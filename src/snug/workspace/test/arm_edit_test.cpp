// Arms that are dropped onto the page: what a URDF says, its meshes beside it, and hostile ones.
#include "snug/workspace/arm_edit.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/model/scenario.hpp"
#include "snug/robot/load_arm.hpp"
#include "snug/workspace/catalogue.hpp"

namespace snug::workspace {
namespace {

namespace fs = std::filesystem;

const fs::path kScenarios = fs::path(SNUG_SOURCE_DIR) / "scenarios";

std::string gantry(const std::string& mesh = "") {
  const auto slide = [](const char* name, const char* parent, const char* child, const char* axis) {
    return std::string("<joint name=\"") + name + "\" type=\"prismatic\"><parent link=\"" + parent +
           "\"/><child link=\"" + child + "\"/><axis xyz=\"" + axis +
           "\"/><limit lower=\"-1.5\" upper=\"1.5\" effort=\"3000\" velocity=\"2\"/></joint>";
  };
  const auto link = [](const char* name, const std::string& more) {
    return std::string("<link name=\"") + name +
           "\"><inertial><mass value=\"5\"/><inertia ixx=\"0.3\" iyy=\"0.3\" izz=\"0.3\"/></inertial>" + more +
           "</link>";
  };
  const std::string collision =
      mesh.empty() ? "" : "<collision><geometry><mesh filename=\"" + mesh + "\"/></geometry></collision>";
  return "<robot name=\"gantry\"><link name=\"frame\"/>" + link("bridge", collision) + link("carriage", "") +
         link("mast", "") + slide("x", "frame", "bridge", "1 0 0") + slide("y", "bridge", "carriage", "0 1 0") +
         slide("z", "carriage", "mast", "0 0 1") + "</robot>";
}

std::string taken_in(const std::string& text, const std::set<std::string>& files = {}) {
  return take_in_urdf(text, "arm.urdf", [&](const std::string& name) { return files.contains(name); });
}

TEST(ArmEdit, SaysWhichLinksCanCarryTheTool) {
  const ArmFacts plain = read_arm_facts(gantry("a/b.stl"), "arm.urdf");
  EXPECT_EQ(plain.name, "gantry");
  EXPECT_EQ(plain.links, (std::vector<std::string>{"mast"}));
  EXPECT_EQ(plain.meshes, (std::vector<std::string>{"a/b.stl"}));
  const ArmFacts ur = read_arm_facts(read_file(kScenarios / "robots/ur10.urdf", "a URDF"), "ur10.urdf");
  ASSERT_GE(ur.links.size(), 3U);
  EXPECT_EQ(ur.links[0], "E");
  EXPECT_EQ(ur.links[1], "tool0");
}

TEST(ArmEdit, NamesMeshesByTheirFilesAlone) {
  EXPECT_EQ(taken_in(gantry("")), gantry("")) << "byte for byte, where nothing is named otherwise";
  for (const char* path : {"package://robot/meshes/link.stl", "file:///etc/link.stl", "../../link.stl", "/etc/link.stl",
                           "C:\\meshes\\link.stl", "link.stl"}) {
    const std::string text = taken_in(gantry(path), {"link.stl"});
    EXPECT_NE(text.find("filename=\"link.stl\""), std::string::npos) << path;
    EXPECT_EQ(text.find(".."), std::string::npos) << path;
    EXPECT_EQ(text.find("/etc"), std::string::npos) << path;
  }
  try {
    (void)taken_in(gantry("package://robot/meshes/link.stl"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.got.find("link.stl"), std::string::npos);
    EXPECT_NE(error.expected.find("dropped together"), std::string::npos);
  }
}

TEST(ArmEdit, RefusesWhatIsNoArm) {
  std::string deep = "<robot>";
  for (int i = 0; i < 2000; ++i) deep += "<a>";
  const std::vector<std::string> hostile = {
      "",
      "no XML",
      "<html/>",
      "<robot",
      deep,
      "<robot name=\"x\"/>",
      "<robot><link name=\"a\"/></robot>",
      "<robot>\xff</robot>",
      "<!DOCTYPE r [<!ENTITY a SYSTEM \"file:///etc/passwd\">]><robot name=\"&a;\"><link name=\"&a;\"/></robot>"};
  for (const std::string& text : hostile) EXPECT_THROW((void)taken_in(text), InputError) << text.substr(0, 60);
  for (const char* mesh :
       {"..", "a b.stl", "meshes/.hidden.stl", "x.exe", "-rf.stl", "a;b.stl", "", "link.stl\n/etc/passwd"})
    EXPECT_THROW((void)taken_in(gantry(std::string("m/") + mesh), {"link.stl"}), InputError) << mesh;
  // A circle of links is no arm either, and ends.
  EXPECT_THROW(
      (void)taken_in(
          "<robot><link name=\"a\"/><joint type=\"fixed\"><parent link=\"a\"/><child link=\"a\"/></joint></robot>"),
      InputError);
}

TEST(ArmEdit, PutsTheArmIntoACell) {
  const test::ScratchFolder scratch;
  const std::string cell = read_file(kScenarios / "init/cell.yaml", "a cell");
  std::ofstream(scratch.path() / "gantry.urdf") << gantry();
  const std::string name = (scratch.path() / "cell.yaml").string();
  const std::string text = put_arm(cell, name, "gantry.urdf", "mast", scratch / "gantry.urdf");
  const model::Scenario scenario = model::parse_scenario(text, name);
  ASSERT_TRUE(scenario.robot.has_value());
  EXPECT_EQ(robot::load_arm(scenario).joint_count(), 3);
  EXPECT_NE(text.find("# What is packed into: a tote"), std::string::npos) << "comments stay";
  // Once more, where it stands elsewhere by then: it stays there.
  std::string moved = text;
  moved.replace(moved.find("pose: {position: [0.0, 0.0, 0.0], yaw_deg: 0.0}"), 47,
                "pose: {position: [0.1, 0.2, 0.3], yaw_deg: 9.0}");
  const std::string again = put_arm(moved, name, "gantry.urdf", "mast", scratch / "gantry.urdf");
  EXPECT_EQ(again, moved);
  EXPECT_THROW((void)put_arm(cell, name, "none.urdf", "mast", scratch / "none.urdf"), InputError);
  EXPECT_THROW((void)put_arm(cell, name, "gantry.urdf", "no such link", scratch / "gantry.urdf"), InputError);
  EXPECT_THROW((void)put_arm("{name: x}", name, "gantry.urdf", "mast", scratch / "gantry.urdf"), InputError);
}

TEST(ArmEdit, BlocksEndBeforeTheCommentsOfTheNext) {
  const std::string text = "a: 1\ncup:\n  x: 1\n\n  # still inside\n  y: 2\n\n# of b\nb: 2\n";
  EXPECT_EQ(find_block(text, "cup"), "cup:\n  x: 1\n\n  # still inside\n  y: 2\n");
  EXPECT_EQ(replace_block(text, "t", "cup", "cup: {}\n"), "a: 1\ncup: {}\n\n# of b\nb: 2\n");
  EXPECT_EQ(find_block(text, "x"), "");
  EXPECT_EQ(replace_block("name: n", "t", "cup", "cup: {}\n"), "name: n\n\ncup: {}\n");
}

TEST(Catalogue, EveryCupIsOneThatACellCanHave) {
  const std::string cell = read_file(kScenarios / "init/cell.yaml", "a cell");
  const std::string text = put_cup(cell, "cell.yaml", find_cup("40-1.5-foam"));
  EXPECT_DOUBLE_EQ(model::parse_scenario(text, "cell.yaml").cup.lip_radius, 0.02);
  EXPECT_NE(text.find("snug cup estimate --diameter 40 --bellows 1.5 --lip foam"), std::string::npos);
  EXPECT_THROW((void)find_cup("41-1.5-foam"), InputError);
  const cup::CupSheet sheet = read_cup_sheet(42.0, 2.5, "nitrile", "plain", -55.0, 9.0);
  const std::string typed = put_cup(cell, "cell.yaml", sheet);
  EXPECT_NE(typed.find("# snug cup estimate --diameter 42 --bellows 2.5 --material nitrile --lip plain --vacuum -55kPa "
                       "--stroke 9: an estimate"),
            std::string::npos);
  EXPECT_NEAR(model::parse_scenario(typed, "cell.yaml").cup.lip_radius, 0.021, 1e-9);
  EXPECT_THROW((void)read_cup_sheet(42.0, 2.5, "wood", "plain", -55.0, {}), InputError);
  EXPECT_THROW((void)read_cup_sheet(42.0, 2.5, "nitrile", "none", -55.0, {}), InputError);
  EXPECT_THROW((void)put_cup(cell, "cell.yaml", read_cup_sheet(42.0, 2.0, "nitrile", "plain", -55.0, {})), InputError);
  EXPECT_THROW((void)put_cup(cell, "cell.yaml", read_cup_sheet(4200.0, 1.5, "nitrile", "plain", -55.0, {})),
               InputError);
  EXPECT_THROW((void)put_cup(cell, "cell.yaml", read_cup_sheet(42.0, 1.5, "nitrile", "plain", 55.0, {})), InputError);
  for (const CatalogueContainer& one : container_catalogue()) EXPECT_EQ(one.is_pallet, one.height == 0.0) << one.name;
}

}  // namespace
}  // namespace snug::workspace
