// Tests of the readers and of the block: what is read, what is refused and where, what a scenario takes.
#include <gtest/gtest.h>

#include <cmath>

#include "snug/identification/releases.hpp"
#include "snug/identification/scenario_block.hpp"
#include "snug/identification/static_poses.hpp"
#include "snug/identification/test/helpers.hpp"
#include "snug/model/scenario.hpp"

namespace snug::identification {
namespace {

using nlohmann::json;

json pose_record() {
  return {{"mass", 1.0},
          {"com_S", {0.0, 0.0, 0.05}},
          {"W_q_E", {0.0, 1.0, 0.0, 0.0}},
          {"E_o_S_meas", {0.0, 0.0, 0.052}},
          {"E_q_S_meas", {1.0, 0.0, 0.0, 0.0}},
          {"wrench_S_meas", {0.0, 0.0, -9.81, 0.0, 0.0, 0.0}}};
}

json pose_file() { return {{"records", {pose_record(), pose_record()}}}; }

/// A document that counts as two values for each record, two for itself and two for the list.
std::string many_empty_records(std::size_t count) {
  std::string text = "{\"records\": [{}";
  for (std::size_t i = 1; i < count; ++i) text += ",{}";
  return text + "]}";
}

void expect_poses_refused(const json& document, const std::string& part) {
  test::expect_refused([&] { (void)parse_static_poses_json(document.dump(), "poses.json"); }, part);
}

TEST(StaticPoses, AreReadFromJsonWithNoiseAndFrames) {
  json document = pose_file();
  document["noise"] = {{"pos_m", 1e-4}, {"rot_rad", 2e-3}, {"force_N", 0.1}, {"torque_Nm", 0.01}};
  document["E_H_S2_o"] = {0.0, 0.0, 0.030};
  const StaticPoses poses = parse_static_poses_json(document.dump(), "poses.json");
  ASSERT_EQ(poses.poses.size(), 2U);
  EXPECT_TRUE(poses.noise_is_given);
  EXPECT_EQ(poses.noise, (MeasurementNoise{1e-4, 2e-3, 0.1, 0.01}));
  EXPECT_EQ(poses.frames.X_ES2.p, Vector3(0.0, 0.0, 0.030));
  EXPECT_EQ(poses.frames.X_SS1.p, Vector3(0.0, 0.0, -0.025));
  EXPECT_EQ(poses.poses[1].where, "poses.json: records[1]");
  EXPECT_EQ((*poses.poses[1].wrench_S)[2], -9.81);
  EXPECT_EQ(poses.poses[1].load->R_WE(2, 2), -1.0);
}

TEST(StaticPoses, ThatCannotBeUsedAreRefusedWithFileAndPath) {
  json document = pose_file();
  document["records"][1]["E_q_S_meas"] = {0.9, 0.0, 0.0, 0.0};
  expect_poses_refused(document, "poses.json: records[1].E_q_S_meas");
  document = pose_file();
  document["records"][1]["E_o_S_meas"] = {0.0, 0.0};
  expect_poses_refused(document, "records[1].E_o_S_meas");
  document = pose_file();
  document["records"][0]["wrench_S_meas"][4] = "2";
  expect_poses_refused(document, "records[0].wrench_S_meas[4]");
  document = pose_file();
  document["records"][0]["mass"] = 0.0;
  expect_poses_refused(document, "records[0].mass");
  document = pose_file();
  document["records"][1].erase("com_S");
  expect_poses_refused(document, "records[1].com_S");
  document = pose_file();
  document["records"][1]["wrench_S_mes"] = document["records"][1]["wrench_S_meas"];
  expect_poses_refused(document, "perhaps wrench_S_meas");
  document = pose_file();
  document["records"][1]["E_o_S_meas"] = {0.0, 0.0, 52.0};
  expect_poses_refused(document, "metres");
  document = pose_file();
  document["records"][0]["E_q_S_meas"] = {std::sqrt(0.5), std::sqrt(0.5), 0.0, 0.0};
  expect_poses_refused(document, "bent by 90 degrees");
  document = pose_file();
  for (const char* key : {"mass", "com_S", "W_q_E", "wrench_S_meas"}) document["records"][0].erase(key);
  expect_poses_refused(document, "neither a wrench nor a payload");
  expect_poses_refused(json{{"records", json::array()}}, "records");
  expect_poses_refused(json::array(), "an object");
  const std::string text = pose_file().dump();
  test::expect_refused([&] { (void)parse_static_poses_json(many_empty_records(499'999), "poses.json"); },
                       "poses.json: got more than 1000000 values");
  test::expect_refused([&] { (void)parse_static_poses_json(many_empty_records(499'998), "poses.json"); },
                       "poses.json: records[0]");
  const std::string deep = "{\"records\": " + std::string(500'000, '[') + std::string(500'000, ']') + "}";
  test::expect_refused([&] { (void)parse_static_poses_json(deep, "poses.json"); }, "more than 100;");
  for (std::size_t size = 0; size < text.size(); ++size)
    test::expect_refused([&] { (void)parse_static_poses_json(text.substr(0, size), "cut.json"); }, "cut.json");
}

constexpr const char* kHeader = "x,y,z,qw,qx,qy,qz,fx,fy,fz,tx,ty,tz\n";

TEST(StaticPoses, AreReadFromCsv) {
  const StaticPoses poses = parse_static_poses_csv(
      std::string(kHeader) + "0,0,0.052,1,0,0,0,0,0,-9.81,0,0,0.1\n# a comment\n0.001,0,0.05,1,0,0,0,1,2,3,4,5,6\n",
      "p.csv");
  ASSERT_EQ(poses.poses.size(), 2U);
  EXPECT_EQ(poses.poses[1].X_ES.p, Vector3(0.001, 0.0, 0.05));
  EXPECT_EQ((*poses.poses[1].wrench_S)[5], 6.0);
  EXPECT_FALSE(poses.poses[1].load.has_value());
  EXPECT_FALSE(poses.noise_is_given);
  const StaticPoses hanging = parse_static_poses_csv(
      "gripper_qw,gripper_qx,gripper_qy,gripper_qz,mass,com_x,com_y,com_z,x,y,z,qw,qx,qy,qz\n"
      "0,1,0,0,1.5,0.01,0.02,0.03,0,0,0.052,1,0,0,0\n",
      "p.csv");
  EXPECT_EQ(hanging.poses[0].load->mass, 1.5);
  EXPECT_EQ(hanging.poses[0].load->p_SScm, Vector3(0.01, 0.02, 0.03));
  EXPECT_EQ(hanging.poses[0].load->R_WE(1, 1), -1.0);
}

TEST(StaticPoses, InCsvThatCannotBeUsedAreRefusedWithFileAndLine) {
  const auto refused = [](const std::string& text, const std::string& part) {
    test::expect_refused([&] { (void)parse_static_poses_csv(text, "p.csv"); }, part);
  };
  refused(std::string(kHeader) + "0,0,0.052,2,0,0,0,0,0,-9.81,0,0,0\n", "p.csv:2");
  refused(std::string(kHeader) + "0,0,0.052,1,0,0,0,0,0\n", "p.csv:2");
  refused(kHeader, "no rows");
  refused("x,y,z,qw,qx,qy,qz,fx\n0,0,0.05,1,0,0,0,1\n", "fy, fz, tx, ty, tz");
  refused("x,y,z,qw,qx,qy,qz\n0,0,0.05,1,0,0,0\n", "neither a wrench nor a payload");
  test::expect_refused([] { (void)load_static_poses("none.json"); }, "none.json");
  test::expect_refused([] { (void)load_static_poses(SNUG_SOURCE_DIR "/README.md"); }, ".json or .csv");
}

json release_case() {
  json entry = {{"mass", 0.5},
                {"com_S", {0.0, 0.0, 0.05}},
                {"Ic_S_axes", {{0.002, 0, 0}, {0, 0.002, 0}, {0, 0, 0.003}}},
                {"W_R_E", {{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}},
                {"dt", 0.01}};
  for (int i = 0; i < 30; ++i) {
    entry["E_o_S"].push_back({0.0, 0.0, 0.05});
    entry["E_q_S"].push_back({1.0, 0.0, 0.0, 0.0});
    entry["t"].push_back(0.01 * i);
  }
  return entry;
}

void expect_release_refused(const json& entry, const std::string& part) {
  const json document = {{"cases", {release_case(), entry}}};
  test::expect_refused([&] { (void)parse_releases_json(document.dump(), "r.json"); }, part);
}

TEST(Releases, ThatCannotBeUsedAreRefusedWithFileAndPath) {
  EXPECT_EQ(parse_releases_json(json{{"cases", {release_case()}}}.dump(), "r.json").size(), 1U);
  json entry = release_case();
  entry["t"][12] = 0.05;
  expect_release_refused(entry, "cases[1] sample 12");
  expect_release_refused(entry, "time that runs forward");
  entry = release_case();
  entry["t"].erase(3);
  expect_release_refused(entry, "cases[1].t");
  entry = release_case();
  entry["E_q_S"].erase(3);
  expect_release_refused(entry, "cases[1].E_q_S");
  entry = release_case();
  entry["E_q_S"][7] = {1.0, 1.0, 0.0, 0.0};
  expect_release_refused(entry, "cases[1].E_q_S[7]");
  entry = release_case();
  entry["W_R_E"][0] = {1.0, 0.1, 0.0};
  expect_release_refused(entry, "cases[1].W_R_E");
  entry = release_case();
  entry["Ic_S_axes"][2][2] = -0.003;
  expect_release_refused(entry, "positive definite");
  entry = release_case();
  entry.erase("t");
  entry["dt"] = 0.0;
  expect_release_refused(entry, "cases[1].dt");
  const std::string text = json{{"cases", {release_case()}}}.dump();
  for (std::size_t size = 0; size < text.size(); size += 37)
    test::expect_refused([&] { (void)parse_releases_json(text.substr(0, size), "cut.json"); }, "cut.json");
}

TEST(Releases, AreReadFromCsvAndTimeMustRunForward) {
  const std::string header =
      "t,x,y,z,qw,qx,qy,qz,mass,com_x,com_y,com_z,ixx,iyy,izz,ixy,ixz,iyz,gripper_qw,gripper_qx,gripper_qy,gripper_"
      "qz\n";
  const auto row = [](const std::string& t, const std::string& mass) {
    return t + ",0,0,0.05,1,0,0,0," + mass + ",0,0,0.05,0.002,0.002,0.003,0,0,0,0,1,0,0\n";
  };
  std::string text = header;
  for (int i = 0; i < 30; ++i) text += row(std::to_string(0.01 * i), "0.5");
  const std::vector<Release> releases = parse_releases_csv(text, "r.csv");
  ASSERT_EQ(releases.size(), 1U);
  EXPECT_EQ(releases[0].times.size(), 30U);
  EXPECT_EQ(releases[0].load_S.inertia(2, 2), 0.003);
  test::expect_refused([&] { (void)parse_releases_csv(text + row("0.1", "0.5"), "r.csv"); }, "r.csv:32");
  test::expect_refused([&] { (void)parse_releases_csv(text + row("0.5", "0.6"), "r.csv"); }, "another value");
  test::expect_refused([&] { (void)parse_releases_csv(header + row("0", "0.5"), "r.csv"); }, "20 or more");
}

TEST(Releases, AreTheSameAfterWritingAndReading) {
  const std::vector<Release> releases = parse_releases_json(json{{"cases", {release_case()}}}.dump(), "r.json");
  const std::vector<Release> again = parse_releases_json(format_releases(releases), "r.json");
  EXPECT_EQ(again[0].times, releases[0].times);
  EXPECT_EQ(again[0].X_ES, releases[0].X_ES);
  EXPECT_EQ(again[0].load_S, releases[0].load_S);
  EXPECT_EQ(again[0].noise, releases[0].noise);
}

TEST(CupBlock, IsTakenByAScenarioWithWhatIsKnownAndNothingElse) {
  const std::string text =
      format_cup_block({{"lateral", 2307.643383, 13.6, "N/m", Verdict::Identified},
                        {"torsion", 99.0, 500.0, "Nm/rad", Verdict::NotIdentifiable}},
                       {{"axial", -3.0, 1.0, "Ns/m", Verdict::Weak}, {"bend", 0.0413, 0.004, "Nms/rad", Verdict::Weak}},
                       {"from poses.json"});
  EXPECT_NE(text.find("# from poses.json"), std::string::npos);
  const model::CupParams cup = model::parse_scenario("materials: [{name: box}]\n" + text, "block").cup;
  const model::CupParams usual;
  EXPECT_EQ(cup.stiffness.lateral, 2307.64338);  // nine digits
  EXPECT_EQ(cup.stiffness.torsion, usual.stiffness.torsion);
  EXPECT_EQ(cup.damping.axial, usual.damping.axial);
  EXPECT_EQ(cup.damping.bend, 0.0413);
}

TEST(CupBlock, OfNothingKnownChangesNothing) {
  const std::string text = format_cup_block({{"axial", 1.0, 9.0, "N/m", Verdict::NotIdentifiable}}, {}, {});
  EXPECT_EQ(model::parse_scenario("materials: [{name: box}]\n" + text, "block").cup, model::CupParams{});
}

}  // namespace
}  // namespace snug::identification
