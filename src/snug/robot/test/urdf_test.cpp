// Reading URDF: what is understood, and how everything else is refused: file, line, element, what would do.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <variant>

#include "shipped_arm.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/robot/kinematics.hpp"
#include "snug/robot/urdf_warnings.hpp"

namespace snug::robot {
namespace {

/// Two joints and a tool; `more` stands inside the second link, `last` before the end.
std::string small_arm(const std::string& more = "", const std::string& last = "") {
  return "<robot name=\"small\">\n"  // 1
         "<link name=\"base\"/>\n"   // 2
         "<link name=\"upper\">" +
         more +
         "</link>\n"                                                                                       // 3
         "<link name=\"slider\"/>\n"                                                                       // 4
         "<link name=\"E\"/>\n"                                                                            // 5
         "<joint name=\"turn\" type=\"revolute\"><parent link=\"base\"/><child link=\"upper\"/>\n"         // 6
         "<origin xyz=\"0 0 1\"/><axis xyz=\"0 0 2\"/>\n"                                                  // 7
         "<limit lower=\"-1\" upper=\"1\" effort=\"10\" velocity=\"2\"/></joint>\n"                        // 8
         "<joint name=\"slide\" type=\"prismatic\"><parent link=\"upper\"/><child link=\"slider\"/>\n"     // 9
         "<axis xyz=\"1 0 0\"/><limit lower=\"0\" upper=\"0.5\" effort=\"10\" velocity=\"1\"/></joint>\n"  // 10
         "<joint name=\"tip\" type=\"fixed\"><parent link=\"slider\"/><child link=\"E\"/>\n"               // 11
         "<origin xyz=\"0.1 0 0\" rpy=\"0 1.5707963267948966 0\"/></joint>\n" +                            // 12
         last +
         "</robot>\n";  // 13
}

/// The small arm with a finger that slides along y of its tool; `more` stands inside the joint.
std::string finger(const std::string& more, const char* type = "prismatic") {
  return small_arm("", "<link name=\"f\"/><joint name=\"grip\" type=\"" + std::string(type) +
                           "\"><parent link=\"E\"/><child link=\"f\"/><origin xyz=\"0 0 0.2\"/><axis xyz=\"0 1 0\"/>" +
                           more + "</joint>");
}

void expect_refused(const std::string& text, const std::string& part, const std::string& where = "") {
  try {
    (void)parse_urdf(text, "arm.urdf", "E", SNUG_SOURCE_DIR "/scenarios/robots");
    ADD_FAILURE() << "accepted; expected a complaint with '" << part << "'";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    EXPECT_TRUE(std::string(error.what()).starts_with("arm.urdf:" + where)) << error.what();
  }
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(Urdf, WithoutAnyElementIsRefused) {
  for (const char* text : {"<?xml version=\"1.0\"?>", "<!-- nothing -->"}) {
    try {
      (void)parse_urdf(text, "x.urdf");
      FAIL();
    } catch (const InputError& error) {
      EXPECT_STREQ(error.what(), "x.urdf:1: got no element; expected <robot>");
    }
  }
}

TEST(Urdf, ReadsTurningAndSlidingJoints) {
  const ArmModel arm = parse_urdf(small_arm(), "arm.urdf");
  ASSERT_EQ(arm.joint_count(), 2);
  EXPECT_EQ(arm.joints[1].kind, JointKind::Prismatic);
  JointVector q(2);
  q << 0.5, 0.3;
  const Pose X_WE = forward_tool(arm, q);
  EXPECT_LT((X_WE.p - Vector3(0.4 * std::cos(0.5), 0.4 * std::sin(0.5), 1.0)).norm(), 1e-15);
  EXPECT_LT((X_WE.R.col(2) - Vector3(std::cos(0.5), std::sin(0.5), 0.0)).norm(), 1e-15);
}

TEST(Urdf, HasTheMassesAndShapesOfTheShippedArm) {
  const ArmModel& arm = test::shipped_arm();
  double mass = 0.0;
  for (const SpatialInertia& segment : arm.segments) mass += segment.mass;
  EXPECT_NEAR(mass, 28.435 + 4.0 + 0.22 + 1.0, 1e-12);  // links, base, sensor, gripper with cup
  int capsules = 0;
  for (const Link& link : arm.links)
    for (const model::PlacedShape& shape : link.shapes)
      capsules += std::holds_alternative<geometry::Capsule>(shape.shape);
  EXPECT_EQ(capsules, 9);  // cylinders with two balls, and the cup's ball
  EXPECT_TRUE(is_behind(arm, find_link(arm, "E"), find_link(arm, "flange")));
  EXPECT_FALSE(is_behind(arm, find_link(arm, "flange"), find_link(arm, "E")));
}

TEST(Urdf, WrapsACylinderInAPrismThatContainsIt) {
  const ArmModel arm = parse_urdf(
      small_arm("<collision><geometry><cylinder radius=\"0.1\" length=\"0.4\"/></geometry></collision>"), "arm.urdf");
  const auto& hull = std::get<geometry::ConvexHull>(arm.links[1].shapes.at(0).shape);
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    const Vector3 corner = hull.vertices[static_cast<std::size_t>(hull.faces[f][0])];
    const double offset = hull.normals[f].dot(corner);
    const double support = 0.1 * hull.normals[f].head<2>().norm() + 0.2 * std::abs(hull.normals[f].z());
    EXPECT_GE(offset, support - 1e-12);
    EXPECT_LE(offset, support * 1.01);
  }
}

TEST(Urdf, RefusesWhatItCannotUseWithLineAndElement) {
  expect_refused("", "XML that can be parsed");
  expect_refused("<robot>\n<link name=\"a\">\n</robot>", "XML that can be parsed");
  expect_refused("<sdf/>", "this is SDF", "1");
  expect_refused("<robot name=\"x\"/>", "no <link>", "1");
  expect_refused(small_arm("<colision/>"), "<collision>", "3");
  expect_refused(small_arm("<inertial><mass value=\"-1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\"/></inertial>"),
                 "a mass in kg", "3");
  expect_refused(small_arm("<inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"5\"/></inertial>"),
                 "no distribution of mass", "3");
  expect_refused(small_arm("<collision><geometry><cone/></geometry></collision>"), "<cylinder>", "3");
  expect_refused(small_arm("<collision><geometry><box size=\"1 2\"/></geometry></collision>"), "3 finite numbers", "3");
  expect_refused(small_arm("<collision><geometry><sphere radius=\"nan\"/></geometry></collision>"), "a finite number");
  expect_refused(small_arm("<collision><geometry><mesh filename=\"no.stl\"/></geometry></collision>"), "not there",
                 "3");
  expect_refused(
      small_arm("<collision><geometry><mesh filename=\"package://nothing_here/m.stl\"/></geometry></collision>"),
      "ROS workspace", "3");
  expect_refused(replaced(small_arm(), "upper=\"1\"", "upper=\"-2\""), "lower < upper", "8");
  expect_refused(replaced(small_arm(), "0 0 2", "0 0 0"), "a direction", "7");
  expect_refused(replaced(small_arm(), "0 0 2", "0 0 inf"), "3 finite numbers", "7");
  expect_refused(replaced(small_arm(), "velocity=\"2\"", "velocity=\"-2\""), "velocity and effort >= 0", "8");
  expect_refused(replaced(small_arm(), "type=\"prismatic\"", "type=\"planar\""), "revolute, continuous", "9");
  expect_refused(replaced(small_arm(), "type=\"prismatic\"", "type=\"screw\""), "revolute, continuous", "9");
  expect_refused(replaced(small_arm(), "<axis xyz=\"1 0 0\"/>", "<mimic joint=\"slide\"/>"), "in a circle", "10");
  expect_refused(finger("<mimic joint=\"trun\"/>"), "'trun', which is not there", "13");
  expect_refused(replaced(small_arm(), "<limit lower=\"-1\" upper=\"1\" effort=\"10\" velocity=\"2\"/>", ""),
                 "no <limit>", "6");
  expect_refused(replaced(small_arm(), "<child link=\"upper\"/>", "<child link=\"uper\"/>"), "'upper' perhaps", "6");
  expect_refused(replaced(small_arm(), "link name=\"slider\"", "link name=\"upper\""), "a second link", "4");
  expect_refused(replaced(small_arm(), "<parent link=\"base\"/>", "<parent link=\"E\"/>"), "circle");
  expect_refused(small_arm("", "<link name=\"other\"/>"), "one root");
  expect_refused(small_arm("",
                           "<link name=\"f\"/><joint name=\"turn\" type=\"fixed\"><parent link=\"E\"/><child "
                           "link=\"f\"/></joint>"),
                 "a second joint", "13");
  expect_refused(
      replaced(replaced(small_arm(), "link name=\"E\"", "link name=\"e\""), "child link=\"E\"", "child link=\"e\""),
      "tool frame");
}

TEST(Urdf, MakesHullsOfMeshesBesideIt) {
  const snug::test::ScratchFolder folder;
  std::filesystem::create_directories(folder / "arm_description" / "meshes");
  {  // a ball of 2000 points: more corners than a hull may have
    std::ofstream obj(folder / "arm_description" / "meshes" / "ball.obj");
    int count = 0;
    for (int i = 1; i < 40; ++i)
      for (int j = 0; j < 50; ++j, ++count) {
        const double a = 3.14159265358979 * i / 40, b = 2 * 3.14159265358979 * j / 50;
        obj << "v " << 100 * std::sin(a) * std::cos(b) << " " << 100 * std::sin(a) * std::sin(b) << " "
            << 100 * std::cos(a) << "\n";
      }
    for (int k = 1; k + 2 <= count; k += 3) obj << "f " << k << " " << k + 1 << " " << k + 2 << "\n";
  }
  const auto with_mesh = [](const std::string& name) {
    return small_arm("<collision><geometry><mesh filename=\"" + name +
                     "\" scale=\"0.001 0.001 0.001\"/></geometry></collision>");
  };
  for (const char* name : {"meshes/ball.obj", "package://arm_description/meshes/ball.obj"}) {
    const ArmModel arm = parse_urdf(with_mesh(name), "arm.urdf", "E", folder / "arm_description");
    const auto& hull = std::get<geometry::ConvexHull>(arm.links[1].shapes.at(0).shape);
    EXPECT_LE(hull.vertices.size(), 64u);
    EXPECT_GT(hull.vertices.size(), 30u);
    for (const Vector3& v : hull.vertices) EXPECT_NEAR(v.norm(), 0.1, 1e-5);
  }
}

TEST(Urdf, TakesAnEffortOfZeroAsUnknownAndSaysWhere) {
  const std::string text = replaced(small_arm(), "effort=\"10\" velocity=\"1\"", "effort=\"0\" velocity=\"1\"");
  const ArmModel arm = parse_urdf(text, "arm.urdf");
  EXPECT_EQ(arm.joints[0].max_effort, 10.0);
  EXPECT_EQ(arm.joints[1].max_effort, std::numeric_limits<double>::infinity());
  const snug::test::ScratchFolder folder;
  const std::filesystem::path path = folder / "effort.urdf";
  std::ofstream(path) << text;
  const std::vector<std::string> warnings = find_unknown_efforts(path);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_TRUE(warnings[0].starts_with(path.string() + ":10: joint 'slide'")) << warnings[0];
  EXPECT_TRUE(find_unknown_efforts(SNUG_SOURCE_DIR "/scenarios/robots/ur10.urdf").empty());
}

TEST(Urdf, TakesASpeedOfZeroAsUnknownAndSaysWhere) {
  const std::string text =
      replaced(replaced(small_arm(), "velocity=\"2\"", "velocity=\"0\""), "velocity=\"1\"", "velocity=\"0\"");
  const ArmModel arm = parse_urdf(text, "arm.urdf");
  EXPECT_NEAR(arm.joints[0].max_speed, 3.14159265358979, 1e-12);
  EXPECT_EQ(arm.joints[1].max_speed, 1.0);
  const std::vector<JointLimits> limits = parse_joint_limits(text, "arm.urdf");
  ASSERT_EQ(limits.size(), 2u);
  EXPECT_EQ(limits[0].max_speed, arm.joints[0].max_speed);
  EXPECT_EQ(limits[1].max_speed, 1.0);
  const snug::test::ScratchFolder folder;
  const std::filesystem::path path = folder / "speed.urdf";
  std::ofstream(path) << text;
  const std::vector<std::string> found = find_assumptions(path, "E");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0],
            path.string() + ":6: joint 'turn': velocity 0 is taken as unknown: 180 degrees a second are assumed");
  EXPECT_EQ(found[1], path.string() + ":9: joint 'slide': velocity 0 is taken as unknown: 1 m/s is assumed");
}

/// A tetrahedron with edges of 0.1 m as OBJ.
void write_mesh(const std::filesystem::path& path) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path) << "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
}

TEST(Urdf, FindsAPackageWhoseFolderHasAnotherNameAndSaysSo) {
  const snug::test::ScratchFolder scratch;
  const std::filesystem::path folder = scratch / "renamed";
  write_mesh(folder / "meshes/link.obj");
  const std::filesystem::path path = folder / "urdf/arm.urdf";
  std::filesystem::create_directories(path.parent_path());
  const std::string mesh =
      "<collision><geometry><mesh filename=\"package://arm_support/meshes/link.obj\"/></geometry></collision>";
  std::ofstream(path) << small_arm(mesh + mesh);
  EXPECT_EQ(load_urdf(path).links[1].shapes.size(), 2u);
  const std::vector<std::string> found = find_assumptions(path, "E");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0], path.string() + ":3: 'package://arm_support/meshes/link.obj' is taken from '" + folder.string() +
                          "': its package is in no folder of its name");
  // A folder of the name is preferred, and nothing is said of one whose package.xml has the name.
  std::ofstream(folder / "package.xml") << "<package><name>arm_support</name></package>";
  EXPECT_TRUE(find_assumptions(path, "E").empty());
  std::ofstream(folder / "package.xml") << "<package><name>other</name></package>";
  write_mesh(scratch / "arm_support/meshes/link.obj");
  EXPECT_TRUE(find_assumptions(path, "E").empty());
  // What is no file is no mesh, whatever stands above the URDF.
  std::ofstream(path) << small_arm(
      "<collision><geometry><mesh filename=\"package://arm_support\"/></geometry></collision>");
  EXPECT_THROW((void)load_urdf(path), InputError);
  std::ofstream(path) << small_arm("<collision><geometry><mesh filename=\"\"/></geometry></collision>");
  EXPECT_TRUE(find_assumptions(path, "E").empty());
}

/// p_Ef of the finger: along y where it was fixed.
double slid(const std::string& more) {
  const ArmModel arm = parse_urdf(finger(more), "arm.urdf");
  EXPECT_EQ(arm.joint_count(), 2);
  const Link& link = arm.links[static_cast<std::size_t>(find_link(arm, "f"))];
  EXPECT_EQ(link.segment, 2);
  const Pose X_Ef = arm.X_SE.inverse() * link.X_SL;
  EXPECT_NEAR(X_Ef.p.z(), 0.2, 1e-15);
  return X_Ef.p.y();
}

TEST(Urdf, FixesJointsOffThePathWhereTheyAreNearestToZero) {
  EXPECT_NEAR(slid("<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>"), 0.0, 1e-15);
  EXPECT_NEAR(slid("<limit lower=\"0.01\" upper=\"0.04\" effort=\"1\" velocity=\"1\"/>"), 0.01, 1e-15);
  EXPECT_NEAR(slid("<limit lower=\"-0.4\" upper=\"-0.1\" effort=\"0\" velocity=\"0\"/>"), -0.1, 1e-15);
  EXPECT_NEAR(slid(""), 0.0, 1e-15);
  // One that mimics a joint of the path stands where that joint is at 0.
  EXPECT_NEAR(slid("<mimic joint=\"turn\" multiplier=\"-1\" offset=\"0.03\"/>"), 0.03, 1e-15);
  EXPECT_NEAR(slid("<mimic joint=\"grip\" multiplier=\"2\" offset=\"0.03\"/><limit lower=\"0.01\" upper=\"1\"/>"), 0.05,
              1e-15);
  for (const char* type : {"revolute", "continuous", "planar", "floating"})
    EXPECT_EQ(parse_urdf(finger("", type), "arm.urdf").links.back().X_SL.p,
              parse_urdf(finger(""), "arm.urdf").links.back().X_SL.p);
}

TEST(Urdf, SaysInOneLineWhichJointsItFixed) {
  const snug::test::ScratchFolder folder;
  const std::filesystem::path path = folder / "fingers.urdf";
  std::ofstream(path) << finger("");
  const std::vector<std::string> found = find_assumptions(path, "E");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0], path.string() + ":13: 1 moving joint off the path to the tool frame 'E' fixed: 'grip'");
  EXPECT_TRUE(find_assumptions(SNUG_SOURCE_DIR "/scenarios/robots/ur10.urdf", "E").empty());
  std::ofstream(path) << "no XML";
  EXPECT_TRUE(find_assumptions(path, "E").empty());
}

TEST(Urdf, TakesContinuousJointsWithoutLimitAndSaysSo) {
  const std::string limit = "<limit lower=\"-1\" upper=\"1\" effort=\"10\" velocity=\"2\"/>";
  const std::string text = replaced(replaced(small_arm(), limit, ""), "type=\"revolute\"", "type=\"continuous\"");
  const ArmModel arm = parse_urdf(text, "arm.urdf");
  EXPECT_EQ(arm.joints[0].upper, std::numeric_limits<double>::infinity());
  EXPECT_EQ(arm.joints[0].lower, -std::numeric_limits<double>::infinity());
  EXPECT_NEAR(arm.joints[0].max_speed, 3.14159265358979, 1e-12);
  const snug::test::ScratchFolder folder;
  const std::filesystem::path path = folder / "endless.urdf";
  std::ofstream(path) << text;
  const std::vector<std::string> found = find_assumptions(path, "E");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].starts_with(path.string() + ":6: joint 'turn': continuous, without limit")) << found[0];
}

TEST(Urdf, SkipsShapesWithoutExtent) {
  for (const char* empty : {"<collision/>", "<collision><geometry/></collision>",
                            "<collision><geometry><box size=\"0 0 0\"/></geometry></collision>",
                            "<collision><geometry><sphere radius=\"0\"/></geometry></collision>",
                            "<collision><geometry><cylinder radius=\"0\" length=\"0\"/></geometry></collision>",
                            "<collision><geometry><mesh filename=\"\"/></geometry></collision>"})
    EXPECT_TRUE(parse_urdf(small_arm(empty), "arm.urdf").links[1].shapes.empty()) << empty;
  expect_refused(small_arm("<collision><geometry><cylinder radius=\"0\" length=\"1\"/></geometry></collision>"),
                 "metres", "3");
  expect_refused(small_arm("<collision><geometry><box size=\"0 1 1\"/></geometry></collision>"), "metres", "3");
}

TEST(Urdf, LooksAtTheInertiaOfLinksThatMoveOnly) {
  const std::string no_body = "<inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"5\"/></inertial>";
  const ArmModel arm = parse_urdf(
      replaced(small_arm(), "<link name=\"base\"/>", "<link name=\"base\">" + no_body + "</link>"), "arm.urdf");
  EXPECT_EQ(arm.links[0].inertia.mass, 1.0);
  expect_refused(small_arm(no_body), "no distribution of mass", "3");
}

TEST(Urdf, TakesAnInertiaOfRankOneInSpiteOfRounding) {
  const auto inertia = [](const std::string& m) {
    return small_arm("<inertial><mass value=\"1e-8\"/><inertia ixx=\"" + m + "\" iyy=\"" + m + "\" izz=\"" + m +
                     "\" ixy=\"" + m + "\" ixz=\"" + m + "\" iyz=\"" + m + "\"/></inertial>");
  };
  for (const char* moment : {"1e-8", "3e-8", "7e-7", "1.1e-6"})
    EXPECT_EQ(parse_urdf(inertia(moment), "arm.urdf").joint_count(), 2) << moment;
  expect_refused(
      small_arm("<inertial><mass value=\"1\"/><inertia ixx=\"-1e-6\" iyy=\"1e-5\" izz=\"1e-5\"/></inertial>"),
      "no distribution of mass", "3");
}

TEST(Urdf, RefusesMacrosButNotCommentsOnThem) {
  const std::string with_names =
      replaced(small_arm(), "name=\"small\"", "name=\"small\" xmlns:xacro=\"http://ros.org/wiki/xacro\"");
  EXPECT_EQ(parse_urdf(replaced(with_names, "<link", "<!-- <xacro:arm/> --><link"), "arm.urdf").joint_count(), 2);
  expect_refused(replaced(with_names, "<link", "<xacro:arm/><link"), "xacro macros", "1");
  expect_refused(replaced(with_names, "<link name=\"upper\">", "<link name=\"upper\"><xacro:mass/>"), "xacro macros",
                 "1");
}

TEST(Urdf, WindowsLineEndsCommentsAndAByteOrderMarkChangeNothing) {
  std::string text =
      "\xEF\xBB\xBF<?xml version=\"1.0\"?>\r\n<!-- made by hand -->\r\n" + small_arm("<!-- a link -->", "<!-- end -->");
  for (std::size_t at = 0; (at = text.find("\n", at)) != std::string::npos; at += 2)
    if (text[at - 1] != '\r') text.insert(at, "\r");
  ArmModel arm = parse_urdf(text, "arm.urdf");
  EXPECT_EQ(arm, parse_urdf(small_arm(), "arm.urdf"));
}

TEST(LoadArm, RefusesWhatTheScenarioSaysOfLinksThatAreNotThere) {
  model::Scenario scenario = test::demonstrator();
  scenario.robot->sensor_frame = "ft_senser";
  EXPECT_THROW((void)load_arm(scenario), InputError);
  scenario = test::demonstrator();
  scenario.robot->posture.pop_back();
  EXPECT_THROW((void)load_arm(scenario), InputError);
  scenario = test::demonstrator();
  scenario.robot->posture[2] = 4.0;  // beyond the elbow's limit
  EXPECT_THROW((void)load_arm(scenario), InputError);
  scenario.robot.reset();
  EXPECT_THROW((void)load_arm(scenario), InputError);
}

TEST(Urdf, AToolPoseStandsForALinkOfTheFile) {
  // The same gripper, once as a link of the file and once as a pose: an arm that moves and weighs the same.
  const std::string text = R"(<robot name="a"><link name="base"/>
<link name="arm"><inertial><mass value="3"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial></link><link name="tool0"/>%s
<joint name="j" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="9" velocity="2"/></joint>
<joint name="f" type="fixed"><parent link="arm"/><child link="tool0"/><origin xyz="0.4 0 0.1" rpy="0 1.5 0"/></joint>
</robot>)";
  const double mass = 1.2, length = 0.25;
  const std::string inertia = std::to_string(mass * length * length / 12.0);
  const std::string link = R"(<link name="E"><inertial><origin xyz="0 0 -0.125"/><mass value="1.2"/><inertia ixx=")" +
                           inertia + R"(" iyy=")" + inertia + R"(" izz="0"/></inertial></link>
<joint name="g" type="fixed"><parent link="tool0"/><child link="E"/><origin xyz="0 0 0.25"/></joint>)";
  const auto with = [&](const std::string& words) {
    std::string whole = text;
    return whole.replace(whole.find("%s"), 2, words);
  };
  const snug::test::ScratchFolder folder;
  const auto write_arm = [&](const std::string& words) { std::ofstream(folder.path() / "bare.urdf") << with(words); };
  write_arm("");
  model::Scenario scenario = test::demonstrator();
  scenario.source_name = (folder.path() / "cell.yaml").string();
  scenario.robot.emplace();
  scenario.robot->urdf = "bare.urdf";
  scenario.robot->tool_frame = scenario.robot->flange_frame = scenario.robot->sensor_frame = "tool0";
  scenario.robot->X_LE = Pose{Matrix3::Identity(), {0.0, 0.0, length}};
  scenario.robot->posture = {0.0};
  scenario.tool->mass = mass;
  const ArmModel mounted = load_arm(scenario), whole = parse_urdf(with(link), "whole.urdf", "E");

  EXPECT_LT((mounted.X_SE.p - whole.X_SE.p).norm(), 1e-15);
  EXPECT_LT((mounted.X_SE.R - whole.X_SE.R).norm(), 1e-15);
  EXPECT_EQ(mounted.links[static_cast<std::size_t>(mounted.tool_link)].name, "E");
  EXPECT_NEAR(mounted.segments.back().mass, whole.segments.back().mass, 1e-12);
  EXPECT_LT((mounted.segments.back().com - whole.segments.back().com).norm(), 1e-12);
  EXPECT_LT((mounted.segments.back().inertia - whole.segments.back().inertia).norm(), 1e-6);  // text of six decimals
  const SpatialInertia load = distal_inertia(mounted, find_link(mounted, "tool0"));
  EXPECT_NEAR(load.mass, mass, 1e-12);
  EXPECT_NEAR(load.com.z(), 0.5 * length, 1e-12);

  write_arm(link);
  try {
    (void)load_arm(scenario);
    ADD_FAILURE() << "two grippers";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("robot.tool_pose"), std::string::npos) << error.what();
  }
}

TEST(Urdf, AnEffortThatCannotHoldTheArmIsTakenAsUnknown) {
  // 3 kg at 0.4 m, held level: 11.8 Nm by hand. The first joint is vertical and holds nothing.
  const auto efforts_of = [](double first, double second, std::vector<std::string>& warnings) {
    const snug::test::ScratchFolder folder;
    const auto joint = [](const char* name, const char* parent, const char* child, const char* axis, double effort) {
      return fmt::format(R"(<joint name="{}" type="revolute"><parent link="{}"/><child link="{}"/><axis xyz="{}"/>
<limit lower="-3" upper="3" velocity="2" effort="{}"/></joint>)",
                         name, parent, child, axis, effort);
    };
    std::ofstream(folder / "arm.urdf")
        << R"(<robot name="a"><link name="base"/><link name="column"/><link name="arm"><inertial><origin xyz="0.4 0 0"/>
<mass value="3"/><inertia ixx="0.1" iyy="0.1" izz="0.1"/></inertial></link>)"
        << joint("pan", "base", "column", "0 0 1", first) << joint("lift", "column", "arm", "0 1 0", second)
        << "</robot>";
    model::Scenario scenario = test::demonstrator();
    scenario.source_name = (folder / "cell.yaml").string();
    scenario.robot.emplace();
    scenario.robot->urdf = "arm.urdf";
    scenario.robot->tool_frame = scenario.robot->flange_frame = scenario.robot->sensor_frame = "arm";
    scenario.robot->posture = {0.0, 0.0};
    warnings = find_weak_joints(scenario);
    const ArmModel arm = load_arm(scenario);
    return std::pair(arm.joints[0].max_effort, arm.joints[1].max_effort);
  };
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  std::vector<std::string> warnings;
  EXPECT_EQ(efforts_of(2.0, 11.9, warnings), std::pair(2.0, 11.9));
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(efforts_of(2.0, 11.7, warnings), std::pair(2.0, kUnknown));
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_NE(warnings.front().find("joint 'lift': effort 11.7 is taken as unknown"), std::string::npos);
  EXPECT_NE(warnings.front().find("needs 12 Nm"), std::string::npos) << warnings.front();
  EXPECT_EQ(efforts_of(11.7, 11.7, warnings), std::pair(kUnknown, kUnknown)) << "a number for all that nobody knew";
  EXPECT_EQ(warnings.size(), 2U);
}

}  // namespace
}  // namespace snug::robot
