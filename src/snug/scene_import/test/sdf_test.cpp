// SDF: frames, welds, inertias, surfaces, includes, and what is said of the rest.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numbers>

#include "scenes.hpp"
#include "snug/core/test/scratch_folder.hpp"

namespace snug::scene_import {
namespace {

using test::body;
using test::expect_refusal;
using test::has_remark;
using test::load;

std::string world(const std::string& inside) {
  return "<sdf version=\"1.9\"><world name=\"w\">" + inside + "</world></sdf>";
}
std::string link(const std::string& name, const std::string& inside,
                 const std::string& shape = "<box><size>0.2 0.2 0.2</size></box>") {
  return "<link name=\"" + name + "\">" + inside + "<collision name=\"c\"><geometry>" + shape +
         "</geometry></collision></link>";
}

TEST(Sdf, WorldOfAPlaneAndABoxHasItsNumbers) {
  Imported imported;
  const model::Scenario s = load(
      world(
          "<gravity>0 0 -3</gravity><physics><max_step_size>0.002</max_step_size></physics><plugin name=\"p\"/>\n"
          "<model name=\"ground\"><static>true</static><link name=\"l\"><collision "
          "name=\"c\"><geometry><plane><normal>0 0 1"
          "</normal></plane></geometry><surface><friction><ode><mu>0.9</mu><mu2>0.9</mu2></ode></friction></surface></"
          "collision></link></model>"
          "<model name=\"crate\"><pose>1 2 3 0 0 1.5707963267948966</pose>" +
          link("l",
               "<inertial><pose>0.1 0 0 0 0 0</pose><mass>4</mass><inertia><ixx>0.1</ixx><iyy>0.2</iyy><izz>0.25</izz>"
               "<ixy>0.01</ixy></inertia></inertial>") +
          "</model>"),
      &imported);
  EXPECT_EQ(s.gravity, Vector3(0, 0, -3));
  EXPECT_EQ(s.time_step, 0.002);
  const model::Body& crate = body(s, "crate");
  EXPECT_EQ(crate.X_WB.p, Vector3(1, 2, 3));
  EXPECT_LT((crate.X_WB.R.col(0) - Vector3::UnitY()).norm(), 1e-12);
  EXPECT_EQ(crate.inertia.mass, 4.0);
  EXPECT_EQ(crate.inertia.com, Vector3(0.1, 0, 0));
  EXPECT_EQ(crate.inertia.inertia(0, 1), 0.01);
  EXPECT_EQ(model::find_contact(s, crate.material, body(s, "ground").material)->friction, 0.9)
      << "the smaller of the two";
  EXPECT_TRUE(has_remark(imported, "scene.xml:1: plugin: left out"));
}

TEST(Sdf, PosesFollowTheirFrames) {
  const double quarter = std::numbers::pi / 2.0;
  const model::Scenario s = load(world(
      "<frame name=\"table\"><pose>0 0 1 0 0 0</pose></frame>"
      "<model name=\"m\"><pose relative_to=\"table\" degrees=\"true\">1 0 0 0 0 90</pose>"
      "<frame name=\"f\" attached_to=\"a\"><pose>0 0 1 0 0 0</pose></frame>" +
      link("a", "<pose>1 0 0 0 0 0</pose>") + link("b", "<pose relative_to=\"f\">1 0 0 0 0 0</pose>") +
      link("c", "<pose relative_to=\"j\" rotation_format=\"quat_xyzw\">0 0 1 0 0 0 1</pose>") +
      "<joint name=\"j\" type=\"fixed\"><pose>0 0 0.5 0 0 0</pose><parent>a</parent><child>b</child></joint></model>"));
  EXPECT_LT((body(s, "m/a").X_WB.p - Vector3(1, 1, 1)).norm(), 1e-12);
  EXPECT_LT((body(s, "m/c").X_WB.p - Vector3(1, 2, 3.5)).norm(), 1e-12);
  EXPECT_LT(angle_between(body(s, "m/c").X_WB.R, exp_rotation(Vector3(0, 0, quarter))), 1e-9);
  // b is welded to a: one body with the sum of two default inertias.
  const model::Body& a = body(s, "m/a");
  ASSERT_EQ(a.shapes.size(), 2U);
  EXPECT_LT((a.shapes[1].X_BG.p - Vector3(1, 0, 1)).norm(), 1e-12);
  EXPECT_EQ(a.inertia.mass, 2.0);
  EXPECT_NEAR(a.inertia.inertia(1, 1), 2.0 + 2 * 0.5, 1e-12) << "two balls of unit inertia, sqrt(2) apart, across";
}

TEST(Sdf, PlacementFramesPlaceTheModelByWhatIsInIt) {
  const model::Scenario s =
      load(world("<model name=\"m\" placement_frame=\"b\"><pose>5 0 0 0 0 0</pose>" + link("a", "") +
                 link("b", "<pose>1 0 0 0 0 1.5707963267948966</pose>") + "</model>"));
  EXPECT_LT((body(s, "m/b").X_WB.p - Vector3(5, 0, 0)).norm(), 1e-12);
  EXPECT_LT(angle_between(body(s, "m/b").X_WB.R, Matrix3::Identity()), 1e-9);
  EXPECT_LT((body(s, "m/a").X_WB.p - Vector3(5, 1, 0)).norm(), 1e-12);
}

TEST(Sdf, AutomaticInertiasAreThoseOfTheShapes) {
  const model::Scenario s = load(
      world("<model name=\"m\"><link name=\"l\"><inertial auto=\"true\"><density>500</density></inertial>"
            "<collision name=\"c\"><geometry><box><size>0.2 0.2 0.4</size></box></geometry></collision>"
            "<collision name=\"d\"><density>1000</density><pose>0 0 0.4 0 0 0</pose><geometry><cylinder><radius>0.1"
            "</radius><length>0.4</length></cylinder></geometry></collision></link></model>"));
  const SpatialInertia& inertia = body(s, "m").inertia;
  const double box = 500 * 0.016, rod = 1000 * std::numbers::pi * 0.004;
  EXPECT_NEAR(inertia.mass, box + rod, 1e-12);
  EXPECT_NEAR(inertia.com.z(), 0.4 * rod / (box + rod), 1e-12);
}

TEST(Sdf, JointsToTheWorldAndMovingOnesHold) {
  Imported imported;
  const model::Scenario s =
      load(world("<model name=\"m\">" + link("a", "") + link("b", "<pose>0 0 0.3 0 0 0</pose>") +
                 "<joint name=\"w\" type=\"fixed\"><parent>world</parent><child>a</child></joint>\n"
                 "<joint name=\"r\" type=\"revolute\"><parent>a</parent><child>b</child></joint></model>"),
           &imported);
  EXPECT_EQ(body(s, "m/a").kind, model::BodyKind::Static);
  EXPECT_EQ(body(s, "m/b").kind, model::BodyKind::Static);
  EXPECT_TRUE(has_remark(imported, "scene.xml:2: joint (revolute): held where it is"));
}

TEST(Sdf, ShapesWithoutSizesAndNamesOfModelsThemselves) {
  const model::Scenario s =
      load(world("<model name=\"m\">" + link("a", "", "<sphere/>") + "<model name=\"n\"><pose>3 0 0 0 0 0</pose>" +
                 link("b", "", "<box/>") +
                 "</model>"
                 "<joint name=\"j\" type=\"fixed\"><parent>a</parent><child>n::__model__</child></joint></model>"));
  const model::Body& a = body(s, "m");
  ASSERT_EQ(a.shapes.size(), 2U);
  EXPECT_EQ(std::get<geometry::Capsule>(a.shapes[0].shape).radius, 1.0);
  EXPECT_EQ(std::get<geometry::Box>(a.shapes[1].shape).half, Vector3(0.5, 0.5, 0.5));
}

TEST(Sdf, JointsToModelsThatAreLeftOutAreSaid) {
  Imported imported;
  (void)load(world("<model name=\"m\">" + link("a", "") +
                   "<include><uri>https://fuel.example/w</uri><name>w</name></include>"
                   "<joint name=\"j\" type=\"fixed\"><parent>a</parent><child>w::link</child></joint></model>"),
             &imported);
  EXPECT_TRUE(has_remark(imported, "of a model that was left out"));
}

TEST(Sdf, IncludesAreFoundAboveTheSceneOrSaid) {
  const snug::test::ScratchFolder folder;
  std::filesystem::create_directories(folder / "models/crate");
  std::filesystem::create_directories(folder / "worlds");
  std::ofstream(folder / "models/crate/model.config")
      << "<model><sdf version=\"1.5\">old.sdf</sdf><sdf version=\"1.9\">new.sdf</sdf></model>";
  std::ofstream(folder / "models/crate/new.sdf")
      << "<sdf version=\"1.9\"><model name=\"crate\"><pose>9 9 9 0 0 0</pose>" << link("l", "") << "</model></sdf>";
  const std::string scene = world(
      "<include><uri>model://crate</uri><name>one</name><pose>0 0 1 0 0 0</pose></include>"
      "<include><uri>model://crate</uri><name>two</name><static>true</static></include>"
      "<include><uri>https://fuel.example/crate</uri></include><include><uri>model://none</uri></include>");
  Imported imported;
  const model::Scenario s = load(scene, &imported, (folder / "worlds").string());
  EXPECT_EQ(body(s, "one").X_WB.p, Vector3(0, 0, 1));
  EXPECT_EQ(body(s, "two").X_WB.p, Vector3(9, 9, 9));
  EXPECT_EQ(body(s, "two").kind, model::BodyKind::Static);
  EXPECT_TRUE(has_remark(imported, "have to be downloaded"));
  EXPECT_TRUE(has_remark(imported, "neither beside the scene nor above it"));
}

TEST(Sdf, SlipsAreRefusedWithLineAndElement) {
  expect_refusal(world("<model name=\"m\">\n" + link("a", "<pose relative_to=\"bb\">0 0 0 0 0 0</pose>") +
                       link("b", "") + "</model>"),
                 "scene.xml:2: link 'a': got frame 'm::bb'");
  expect_refusal(world("<model name=\"m\">" + link("a", "<pose relative_to=\"b\">0 0 0 0 0 0</pose>") +
                       link("b", "<pose relative_to=\"a\">0 0 0 0 0 0</pose>") + "</model>"),
                 "relative to each other");
  expect_refusal(world("<model name=\"m\">" + link("a", "") + link("a", "") + "</model>"), "a second 'm::a'");
  expect_refusal(world("<model name=\"m\">" + link("a", "<pose>0 0 0</pose>") + "</model>"), "6 finite numbers");
  expect_refusal(world("<model name=\"m\">" + link("a", "", "<box><size>1 0 1</size></box>") + "</model>"),
                 "metres, > 0");
  expect_refusal(world("<model name=\"m\">" + link("a", "<inertial><mass>-1</mass></inertial>") + "</model>"),
                 "kg, > 0");
  expect_refusal(world("<model name=\"m\">" + link("a", "") +
                       "<joint name=\"j\" type=\"fixed\"><parent>a</parent><child>bb</child></joint></model>"),
                 "bb");
  expect_refusal(world(""), "without a body");
}

}  // namespace
}  // namespace snug::scene_import
