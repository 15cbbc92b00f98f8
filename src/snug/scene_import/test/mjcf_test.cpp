// MJCF: conventions of poses, classes, masses in closed form, and what is said of the rest.
#include <gtest/gtest.h>

#include <cmath>
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
constexpr double kPi = std::numbers::pi;

std::string free_body(const std::string& inside, const std::string& before = "", const std::string& attributes = "") {
  return "<mujoco>" + before + "<worldbody><body name=\"b\" " + attributes + "><freejoint/>" + inside +
         "</body></worldbody></mujoco>";
}

TEST(Mjcf, WorldOfAFloorAndABoxHasItsNumbers) {
  Imported imported;
  const model::Scenario s = load(R"(<mujoco model="one"><option timestep="0.004" gravity="0 0 -1.62"/>
    <worldbody><geom type="plane" size="0 0 1" friction="0.3"/>
      <body name="crate" pos="0 0 0.5" euler="0 0 90"><freejoint/><geom type="box" size="0.1 0.2 0.3" mass="6" friction=".8"/></body>
    </worldbody><actuator><motor joint="x"/></actuator></mujoco>)",
                                 &imported);
  EXPECT_EQ(s.name, "one");
  EXPECT_EQ(s.time_step, 0.004);
  EXPECT_EQ(s.gravity, Vector3(0, 0, -1.62));
  const model::Body& crate = body(s, "crate");
  EXPECT_EQ(crate.inertia.mass, 6.0);
  EXPECT_NEAR(crate.inertia.inertia(0, 0), 6.0 / 12.0 * (0.4 * 0.4 + 0.6 * 0.6), 1e-12);
  EXPECT_LT((crate.X_WB.R * Vector3::UnitX() - Vector3::UnitY()).norm(), 1e-12) << "degrees unless said";
  EXPECT_EQ(body(s, "world").kind, model::BodyKind::Static);
  // The plane is the top of a slab.
  EXPECT_NEAR(
      body(s, "world").shapes[0].X_BG.p.z() + std::get<geometry::Box>(body(s, "world").shapes[0].shape).half.z(), 0.0,
      1e-15);
  const auto contact = model::find_contact(s, crate.material, body(s, "world").material);
  ASSERT_TRUE(contact);
  EXPECT_EQ(contact->friction, 0.8) << "the larger of the two";
  EXPECT_EQ(contact->torsional_friction, 0.0) << "condim 3 has none";
  EXPECT_TRUE(has_remark(imported, "scene.xml:4: motor: left out")) << imported.yaml;
}

TEST(Mjcf, DensitiesOfSolidsInClosedForm) {
  const auto mass = [](const std::string& geom) {
    return body(load(free_body("<geom density=\"500\" " + geom + "/>")), "b").inertia;
  };
  EXPECT_NEAR(mass(R"(size="0.1")").mass, 500 * 4.0 / 3.0 * kPi * 1e-3, 1e-12) << "a geom without type is a ball";
  EXPECT_NEAR(mass(R"(type="cylinder" size="0.1 0.2")").mass, 500 * kPi * 0.01 * 0.4, 1e-12);
  EXPECT_NEAR(mass(R"(type="capsule" size="0.1 0.2")").mass, 500 * kPi * (0.01 * 0.4 + 4e-3 / 3.0), 1e-12);
  const SpatialInertia ellipsoid = mass(R"(type="ellipsoid" size="0.1 0.2 0.3")");
  EXPECT_NEAR(ellipsoid.mass, 500 * 4.0 / 3.0 * kPi * 6e-3, 1e-12);
  EXPECT_NEAR(ellipsoid.inertia(0, 0), ellipsoid.mass / 5.0 * (0.04 + 0.09), 1e-12);
  const SpatialInertia rod = mass(R"(type="cylinder" size="0.1" fromto="1 0 0 3 0 0")");
  EXPECT_NEAR(rod.mass, 500 * kPi * 0.01 * 2.0, 1e-12);
  EXPECT_LT((rod.com - Vector3(2, 0, 0)).norm(), 1e-12);
  EXPECT_NEAR(rod.inertia(0, 0), rod.mass * 0.01 / 2.0, 1e-9) << "its axis is x";
}

TEST(Mjcf, MeshesWeighWhatTheyEnclose) {
  const std::string tetrahedron =
      R"(<asset><mesh name="t" vertex="0 0 0 1 0 0 0 1 0 0 0 1" face="0 2 1 0 1 3 0 3 2 1 2 3" scale="2 1 1"/></asset>)";
  const model::Body b = body(load(free_body(R"(<geom type="mesh" mesh="t" density="6"/>)", tetrahedron)), "b");
  EXPECT_NEAR(b.inertia.mass, 2.0, 1e-12);
  EXPECT_LT((b.inertia.com - Vector3(0.5, 0.25, 0.25)).norm(), 1e-12);
  EXPECT_EQ(std::get<geometry::ConvexHull>(b.shapes[0].shape).vertices.size(), 4U);
}

TEST(Mjcf, HollowsOfAMeshCountAsItsInertiaSays) {
  // A prism over an arrow head: a square of 2 m less a quarter of it. Volume 3; its hull is the square: 4.
  const auto mass = [](const std::string& inertia) {
    const std::string mesh =
        R"(<asset><mesh name="t" vertex="0 0 0 1 1 0 -1 1 0 -1 -1 0 1 -1 0 0 0 1 1 1 1 -1 1 1 -1 -1 1 1 -1 1" )"
        R"(face="0 2 1 0 3 2 0 4 3 5 6 7 5 7 8 5 8 9 1 2 7 1 7 6 2 3 8 2 8 7 3 4 9 3 9 8 0 1 6 0 6 5 4 0 5 4 5 9")" +
        inertia + "/></asset>";
    return body(load(free_body(R"(<geom type="mesh" mesh="t" density="1"/>)", mesh)), "b").inertia.mass;
  };
  EXPECT_NEAR(mass(R"( inertia="exact")"), 3.0, 1e-12);
  EXPECT_NEAR(mass(R"( inertia="convex")"), 4.0, 1e-12);
  EXPECT_GT(mass(""), 3.0) << "legacy counts pyramids of faces that look at the centre";
}

TEST(Mjcf, RotationsInEachOfTheirForms) {
  const auto turn = [](const std::string& attribute, const std::string& compiler = "") {
    return body(load(free_body("<geom size=\"0.1\"/>", compiler, attribute)), "b").X_WB.R;
  };
  const Matrix3 about_z = exp_rotation(Vector3(0, 0, kPi / 6));
  EXPECT_LT(angle_between(turn(R"(euler="0 0 30")"), about_z), 1e-9);
  EXPECT_LT(angle_between(turn(R"(axisangle="0 0 2 30")"), about_z), 1e-9);
  EXPECT_LT(angle_between(turn(R"(axisangle="0 0 2 0.5235987755982988")", R"(<compiler angle="radian"/>)"), about_z),
            1e-9);
  EXPECT_LT(angle_between(turn(R"(quat="0.9659258262890683 0 0 0.25881904510252074")"), about_z), 1e-9);
  EXPECT_LT(angle_between(turn(R"(xyaxes="0.8660254037844387 0.5 0 -1 1.7320508075688772 0")"), about_z), 1e-9);
  EXPECT_LT((turn(R"(zaxis="1 0 0")").col(2) - Vector3::UnitX()).norm(), 1e-9);
  const Matrix3 X = exp_rotation(Vector3(0.1, 0, 0)), Y = exp_rotation(Vector3(0, 0.2, 0)),
                Z = exp_rotation(Vector3(0, 0, 0.3));
  const std::string angles = R"(euler="0.1 0.2 0.3")";
  EXPECT_LT(angle_between(turn(angles, R"(<compiler angle="radian"/>)"), X * Y * Z), 1e-9) << "about the turned axes";
  EXPECT_LT(angle_between(turn(angles, R"(<compiler angle="radian" eulerseq="XYZ"/>)"), Z * Y * X), 1e-9);
}

TEST(Mjcf, ClassesFramesAndWeldsReachTheBody) {
  const model::Scenario s = load(R"(<mujoco>
    <default><geom density="100"/><default class="heavy"><geom density="900" type="box" size=".1 .1 .1"/></default></default>
    <worldbody><frame pos="1 0 0" euler="0 0 90"><body name="b" pos="1 0 0" childclass="heavy"><freejoint/>
      <geom/><body pos="0 0 1"><geom class="main" size="0.1"/><geom pos="1 0 0"/></body></body></frame></worldbody></mujoco>)");
  const model::Body& b = body(s, "b");
  EXPECT_LT((b.X_WB.p - Vector3(1, 1, 0)).norm(), 1e-12);
  ASSERT_EQ(b.shapes.size(), 3U);
  EXPECT_LT((b.shapes[2].X_BG.p - Vector3(1, 0, 1)).norm(), 1e-12);
  const double box = 900 * 8e-3, ball = 100 * 4.0 / 3.0 * kPi * 1e-3;
  EXPECT_NEAR(b.inertia.mass, 2 * box + ball, 1e-12);
  EXPECT_LT((b.inertia.com - Vector3(box, 0, box + ball) / (2 * box + ball)).norm(), 1e-12);
}

TEST(Mjcf, InertialsStandBeforeGeomsUnlessTheCompilerSaysSo) {
  const std::string inside =
      R"(<inertial pos="0.1 0 0" mass="3" fullinertia="0.02 0.03 0.04 0.001 0 0"/><geom type="box" size="0.1 0.1 0.1"/>)";
  const SpatialInertia own = body(load(free_body(inside)), "b").inertia;
  EXPECT_EQ(own.mass, 3.0);
  EXPECT_LT((own.com - Vector3(0.1, 0, 0)).norm(), 1e-15);
  EXPECT_EQ(own.inertia(0, 1), 0.001);
  EXPECT_NEAR(body(load(free_body(inside, R"(<compiler inertiafromgeom="true"/>)")), "b").inertia.mass, 8.0, 1e-12);
  EXPECT_NEAR(body(load(free_body(inside, R"(<compiler settotalmass="12"/>)")), "b").inertia.mass, 12.0, 1e-12);
}

TEST(Mjcf, ReplicatesTurnAndStep) {
  const model::Scenario s = load(R"(<mujoco><worldbody><replicate count="4" euler="0 0 90" sep="-">
    <body name="b" pos="2 0 0"><freejoint/><geom size="0.1"/></body></replicate>
    <replicate count="3" offset="0 0 1"><body name="c"><freejoint/><geom size="0.1"/></body></replicate></worldbody></mujoco>)");
  EXPECT_EQ(s.bodies.size(), 7U);
  EXPECT_LT((body(s, "b-1").X_WB.p - Vector3(0, 2, 0)).norm(), 1e-12);
  EXPECT_LT((body(s, "c2").X_WB.p - Vector3(0, 0, 2)).norm(), 1e-12);
}

TEST(Mjcf, JointsAreHeldAndSaid) {
  Imported imported;
  const model::Scenario s = load(R"(<mujoco><worldbody>
    <body name="arm" pos="0 0 1"><joint type="hinge"/><geom type="box" size="0.1 0.1 0.1"/>
      <body name="hand" pos="0 0 0.2"><joint type="slide"/><geom type="box" size="0.1 0.1 0.1"/></body></body></worldbody>
    <equality><weld body1="a"/></equality><sensor><touch site="x"/></sensor></mujoco>)",
                                 &imported);
  EXPECT_EQ(s.bodies.size(), 2U) << "they touch and do not overlap";
  EXPECT_LT((body(s, "hand").X_WB.p - Vector3(0, 0, 1.2)).norm(), 1e-12);
  EXPECT_TRUE(has_remark(imported, "scene.xml:2: joint (hinge): held where it is"));
  EXPECT_TRUE(has_remark(imported, "weld: left out"));
  EXPECT_TRUE(has_remark(imported, "touch: left out"));
}

TEST(Mjcf, AttributesAndMeshesThatAreNotReadAreSaid) {
  Imported imported;
  (void)load(R"(<mujoco><asset><mesh name="s" builtin="sphere" params="1"/></asset><worldbody>
    <geom size="0.1" surfacevel="1 0 0"/><geom type="mesh" mesh="s"/></worldbody></mujoco>)",
             &imported);
  EXPECT_TRUE(has_remark(imported, "scene.xml:2: geom, surfacevel: left out"));
  EXPECT_TRUE(has_remark(imported, "scene.xml:2: geom, of a built-in mesh: left out"));
}

TEST(Mjcf, StaticsThatOverlapAreOneBodyAndLooksDoNotTouch) {
  Imported imported;
  const model::Scenario s = load(R"(<mujoco><worldbody><geom type="plane" size="1 1 1"/>
    <body name="leg"><geom type="box" size="0.1 0.1 0.5"/></body>
    <body name="b" pos="0 0 5"><freejoint/><geom size="0.1" mass="1"/><geom size="1" contype="0" conaffinity="0" mass="2"/></body>
    </worldbody></mujoco>)",
                                 &imported);
  EXPECT_EQ(s.bodies.size(), 2U);
  EXPECT_EQ(s.bodies[0].shapes.size(), 2U);
  EXPECT_EQ(body(s, "b").shapes.size(), 1U);
  EXPECT_EQ(body(s, "b").inertia.mass, 3.0) << "looks weigh";
  EXPECT_TRUE(has_remark(imported, "overlap: one body"));
}

TEST(Mjcf, IncludesAreReadOnceAndNamedInMessages) {
  const snug::test::ScratchFolder folder;
  std::ofstream(folder / "part.xml") << "<mujocoinclude>\n<geom size=\"0.1\"/>\n<geom size=\"x\"/></mujocoinclude>";
  const std::string scene = free_body("<include file=\"part.xml\"/>");
  expect_refusal(scene, "part.xml:3", folder.path().string());
  std::ofstream(folder / "part.xml") << "<mujocoinclude><geom size=\"0.1\"/></mujocoinclude>";
  EXPECT_EQ(body(load(scene, nullptr, folder.path().string()), "b").shapes.size(), 1U);
  expect_refusal(free_body("<include file=\"part.xml\"/><include file=\"part.xml\"/>"), "a second time",
                 folder.path().string());
  expect_refusal(free_body("<include file=\"none.xml\"/>"), "not there", folder.path().string());
}

TEST(Mjcf, BodiesThatBeginInEachOtherAreWrittenAndSaid) {
  const Imported imported = parse_scene(R"(<mujoco><worldbody><geom type="plane" size="1 1 1"/>
    <body name="b"><freejoint/><geom size="0.1"/></body></worldbody></mujoco>)",
                                        "scene.xml", ".");
  EXPECT_NE(imported.refusal.find("overlaps"), std::string::npos) << imported.refusal;
  EXPECT_NE(imported.yaml.find("dynamic"), std::string::npos);
}

}  // namespace
}  // namespace snug::scene_import
