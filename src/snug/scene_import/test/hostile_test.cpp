// Files made to harm: bombs, circles, depths, sizes.
#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <filesystem>
#include <fstream>

#include "scenes.hpp"
#include "snug/core/test/scratch_folder.hpp"

namespace snug::scene_import {
namespace {

using test::expect_refusal;

std::string repeated(const std::string& text, int times) {
  std::string all;
  for (int i = 0; i < times; ++i) all += text;
  return all;
}

TEST(HostileScene, WhatIsNoSceneIsNamed) {
  expect_refusal("", "scene.xml");
  expect_refusal("<robot name=\"r\"/>", "URDF");
  expect_refusal("<html/>", "<mujoco> or <sdf>");
  expect_refusal("<mujoco><worldbody>", "scene.xml:1");
  expect_refusal("<mujoco>\n\xff</mujoco>", "scene.xml:2");
  expect_refusal("<mujoco/>", "without a body");
}

TEST(HostileScene, EntitiesAreNotExpanded) {
  const std::string bomb =
      "<!DOCTYPE m [<!ENTITY a \"0 0 0\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;\"><!ENTITY c SYSTEM "
      "\"file:///etc/hostname\">]>"
      "<mujoco><worldbody><geom size=\"&b;\"/></worldbody></mujoco>";
  expect_refusal(bomb, "scene.xml");
}

TEST(HostileScene, DepthsEnd) {
  const std::string deep = repeated("<body>", 300) + "<geom size=\"1\"/>" + repeated("</body>", 300);
  expect_refusal("<mujoco><worldbody>" + deep + "</worldbody></mujoco>",
                 TINYXML2_MAX_ELEMENT_DEPTH < 300 ? "DEPTH" : "more than 200 deep");
  expect_refusal("<mujoco><worldbody>" + repeated("<body>", 5000), "scene.xml:1");
  std::string models = "<link name=\"l\"/>";
  for (int i = 0; i < 80; ++i) models = "<model name=\"m\">" + models + "</model>";
  expect_refusal("<sdf><world name=\"w\">" + models + "</world></sdf>", "deep");
}

TEST(HostileScene, ReplicatesOfReplicatesEnd) {
  std::string inside = "<geom size=\"0.1\"/>";
  for (int i = 0; i < 6; ++i) inside = "<replicate count=\"1000\">" + inside + "</replicate>";
  expect_refusal("<mujoco><worldbody>" + inside + "</worldbody></mujoco>", "more than 20000");
}

TEST(HostileScene, FilesThatIncludeEachOtherEnd) {
  const snug::test::ScratchFolder folder;
  std::ofstream(folder / "a.xml") << "<mujoco><include file=\"b.xml\"/></mujoco>";
  std::ofstream(folder / "b.xml") << "<mujoco><include file=\"a.xml\"/></mujoco>";
  expect_refusal("<mujoco><include file=\"a.xml\"/></mujoco>", "a second time", folder.path().string());
  std::filesystem::create_directories(folder / "m");
  std::ofstream(folder / "m/model.sdf")
      << "<sdf><model name=\"m\"><include><uri>model://m</uri><name>i</name></include>"
         "<include><uri>model://m</uri><name>j</name></include></model></sdf>";
  expect_refusal("<sdf><world name=\"w\"><include><uri>model://m</uri></include></world></sdf>", "deep",
                 folder.path().string());
}

TEST(HostileScene, NumbersThatAreNoneAndSizesBeyondReasonAreRefused) {
  for (const char* size : {"nan", "inf", "1e999", "-1", "0", "1e9", "", "1 2 3 4", "0x10"}) {
    SCOPED_TRACE(size);
    expect_refusal(std::string("<mujoco><worldbody><geom type=\"sphere\" size=\"") + size + "\"/></worldbody></mujoco>",
                   "scene.xml:1: geom");
  }
  expect_refusal("<mujoco><worldbody><replicate count=\"99999999\"><geom size=\"1\"/></replicate></worldbody></mujoco>",
                 "count");
  expect_refusal(
      "<mujoco><asset><mesh name=\"m\" vertex=\"0 0 0 1 0 0 0 1 0 0 0 1\" face=\"0 1 9\"/></asset><worldbody>"
      "<geom type=\"mesh\" mesh=\"m\"/></worldbody></mujoco>",
      "a face of no vertex");
}

TEST(HostileScene, NamesAreMadeUniqueAndPrintable) {
  const Imported imported = parse_scene(
      "<mujoco><worldbody><body name=\"a&#10;b&quot;: {\"><freejoint/><geom size=\"0.1\"/></body>"
      "<body name=\"ab&quot;: {\" pos=\"1 0 0\"><freejoint/><geom size=\"0.1\"/></body></worldbody></mujoco>",
      "scene.xml", ".");
  EXPECT_EQ(imported.refusal, "");
  const model::Scenario s = model::parse_scenario(imported.yaml, "x");
  ASSERT_EQ(s.bodies.size(), 2U);
  EXPECT_EQ(s.bodies[1].name, "ab\": { (2)");
}

}  // namespace
}  // namespace snug::scene_import
