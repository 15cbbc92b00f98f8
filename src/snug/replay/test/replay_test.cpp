// Tests of recordings in the replay form: what is decoded is the recording, rounded.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/record/writer.hpp"
#include "snug/replay/replay.hpp"
#include "snug/replay/test/scratch.hpp"

namespace snug::replay {
namespace {

using test::ScratchFolder;

template <class Work>
std::string complaint(Work work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

Form form_of(const record::Recording& recording, const Selection& selection = {}) {
  const ScratchFolder folder;
  record::save_recording(folder / "run.h5", recording);
  record::RecordingReader reader(folder / "run.h5");
  return decode_form(encode_recording(reader, "run.h5", selection), "run.h5");
}

const Channel& channel(const Form& form, std::string_view name) {
  const Channel* found = find_channel(form, std::string(name));
  if (found == nullptr) throw std::runtime_error("no channel " + std::string(name));
  return *found;
}

void expect_pose(const Channel& poses, std::size_t row, const record::PoseSample& X) {
  constexpr double kHalf = 0.5e-5 + 1e-12;  // half a quantum, and rounding of the division
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(poses.at(row, static_cast<std::size_t>(i)), X.p[i], kHalf);
  const Quaternion quat(poses.at(row, 3), poses.at(row, 4), poses.at(row, 5), poses.at(row, 6));
  const double sign = quat.dot(X.quat) < 0.0 ? -1.0 : 1.0;
  EXPECT_LE((quat.coeffs() - sign * X.quat.coeffs()).cwiseAbs().maxCoeff(), kHalf);
}

void expect_wrench(const Channel& wrenches, std::size_t row, const Wrench& F) {
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(wrenches.at(row, static_cast<std::size_t>(i)), as_vector(F)[i], 0.5e-3 + 1e-12);
  }
}

TEST(Replay, KeepsToolAndCupWithinHalfAQuantum) {
  Rng rng = Rng(1).split("replay");
  const record::Recording recording = test::random_recording(rng, 60);
  const Form form = form_of(recording);
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    SCOPED_TRACE(i);
    const record::Frame& frame = recording.frames[i];
    EXPECT_NEAR(channel(form, "time").at(i, 0), frame.time, 0.5e-6 + 1e-12);
    EXPECT_EQ(channel(form, "program_row").at(i, 0), frame.program_row);
    expect_pose(channel(form, "tool.pose"), i, frame.X_WE);
    expect_pose(channel(form, "tool.pose_command"), i, frame.X_WE_command);
    for (int k = 0; k < 6; ++k) {
      EXPECT_NEAR(channel(form, "tool.twist").at(i, static_cast<std::size_t>(k)), as_vector(frame.V_WE)[k], 0.51e-4);
    }
    EXPECT_EQ(channel(form, "cup.command").at(i, 0), frame.cup.vacuum_command ? 1.0 : 0.0);
    EXPECT_NEAR(channel(form, "cup.pressure_gauge").at(i, 0), frame.cup.pressure_gauge, 5.0);
    EXPECT_EQ(channel(form, "cup.attached_body").at(i, 0), frame.cup.attached_body);
    expect_wrench(channel(form, "cup.wrench"), i, frame.cup.F_PSo_S);
    expect_wrench(channel(form, "flange.wrench"), i, frame.F_flange);
    EXPECT_NEAR(channel(form, "solver.residual").at(i, 0), frame.solver.residual, 0.51e-8);
    EXPECT_EQ(channel(form, "solver.iterations").at(i, 0), frame.solver.iterations);
    EXPECT_EQ(channel(form, "solver.status").at(i, 0), static_cast<double>(frame.solver.status));
    if (frame.cup.attached_body < 0) {
      EXPECT_TRUE(std::isnan(channel(form, "cup.pose").at(i, 0)));
      EXPECT_TRUE(std::isnan(channel(form, "cup.deformation").at(i, 1)));
    } else {
      expect_pose(channel(form, "cup.pose"), i, frame.cup.X_ES);
      EXPECT_NEAR(channel(form, "cup.deformation").at(i, 0), frame.cup.length, 0.51e-5);
      EXPECT_NEAR(channel(form, "cup.deformation").at(i, 1), frame.cup.bend, 0.51e-5);
    }
  }
}

TEST(Replay, KeepsBodiesWithOneRowForThoseThatNeverMove) {
  Rng rng = Rng(2).split("replay");
  const record::Recording recording = test::random_recording(rng, 40);
  const Form form = form_of(recording);
  EXPECT_EQ(channel(form, "body.0.pose").rows, 1u);
  EXPECT_EQ(find_channel(form, "body.0.present"), nullptr);
  for (std::size_t body = 1; body < 4; ++body) {
    const Channel& poses = channel(form, "body." + std::to_string(body) + ".pose");
    const Channel& present = channel(form, "body." + std::to_string(body) + ".present");
    for (std::size_t i = 0; i < recording.frames.size(); ++i) {
      const record::BodySample& sample = recording.frames[i].bodies[body];
      EXPECT_EQ(present.at(i, 0), sample.present ? 1.0 : 0.0);
      if (sample.present) expect_pose(poses, i, sample.X_WB);
      EXPECT_EQ(std::isnan(poses.at(i, 0)), !sample.present);
    }
  }
}

TEST(Replay, KeepsJointsOfARobotAndHasNoChannelsForThemWithoutOne) {
  Rng rng = Rng(10).split("replay");
  const record::Recording recording = test::random_robot_recording(rng, 20);
  const Form form = form_of(recording);
  EXPECT_EQ(channel(form, "joints.position").spec.columns, recording.header.joints);
  EXPECT_EQ(channel(form, "body.3.present").rows, 20u);
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    for (std::size_t k = 0; k < 2; ++k) {
      const record::JointSample& joint = recording.frames[i].joints[k];
      EXPECT_NEAR(channel(form, "joints.position").at(i, k), joint.position, 0.51e-5);
      EXPECT_NEAR(channel(form, "joints.velocity").at(i, k), joint.velocity, 0.51e-4);
      EXPECT_NEAR(channel(form, "joints.torque").at(i, k), joint.torque, 0.51e-2);
    }
  }
  EXPECT_EQ(find_channel(form_of(test::random_recording(rng, 5)), "joints.position"), nullptr);
}

TEST(Replay, NeverFlipsTheSignOfAQuaternionBetweenFrames) {
  Rng rng = Rng(3).split("replay");
  record::Recording recording = test::random_recording(rng, 200);
  for (std::size_t i = 0; i < recording.frames.size();
       ++i) {  // turns twice about z; the recording's sign flips at random
    const double angle = 4.0 * M_PI * static_cast<double>(i) / 200.0;
    Quaternion quat(Eigen::AngleAxisd(angle, Vector3::UnitZ()));
    if (rng.index(2) == 0) quat.coeffs() = -quat.coeffs();
    recording.frames[i].bodies[2].X_WB.quat = quat;
  }
  const Form form = form_of(recording);
  const Channel& poses = channel(form, "body.2.pose");
  for (std::size_t i = 1; i < poses.rows; ++i) {
    double dot = 0.0;
    for (std::size_t k = 3; k < 7; ++k) dot += poses.at(i, k) * poses.at(i - 1, k);
    EXPECT_GT(dot, 0.99) << i;  // cos of half the angle between frames, 1.8 degrees
  }
}

TEST(Replay, KeepsEveryContactOfEveryFrame) {
  Rng rng = Rng(4).split("replay");
  const record::Recording recording = test::random_recording(rng, 60);
  const Form form = form_of(recording);
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    SCOPED_TRACE(i);
    const std::vector<record::ContactSample>& contacts = recording.frames[i].contacts;
    std::size_t seen = 0;
    const auto first = static_cast<std::size_t>(channel(form, "contacts.frame_first").at(i, 0));
    const auto count = static_cast<std::size_t>(channel(form, "contacts.frame_count").at(i, 0));
    for (std::size_t run = first; run < first + count; ++run) {
      const auto block = static_cast<std::size_t>(channel(form, "contacts.frame_block").at(run, 0));
      const auto point = static_cast<std::size_t>(channel(form, "contacts.block_first").at(block, 0));
      const auto points = static_cast<std::size_t>(channel(form, "contacts.block_count").at(block, 0));
      for (std::size_t at = point; at < point + points; ++at, ++seen) {
        ASSERT_LT(seen, contacts.size());
        EXPECT_EQ(channel(form, "contacts.block_body").at(block, 0), contacts[seen].body_a);
        EXPECT_EQ(channel(form, "contacts.block_body").at(block, 1), contacts[seen].body_b);
        for (int k = 0; k < 3; ++k) {  // half a quantum of the form and one of the recording
          const auto axis = static_cast<std::size_t>(k);
          EXPECT_NEAR(channel(form, "contacts.point").at(at, axis), contacts[seen].p_WQ[k], 0.51e-4);
          EXPECT_NEAR(channel(form, "contacts.normal").at(at, axis), contacts[seen].n_AB_W[k], 0.51e-3);
          EXPECT_NEAR(channel(form, "contacts.force").at(at, axis), contacts[seen].force_B_W[k], 0.51e-2);
        }
        EXPECT_NEAR(channel(form, "contacts.gap").at(at, 0), contacts[seen].phi, 0.6e-7);
        EXPECT_EQ(channel(form, "contacts.state").at(at, 0), static_cast<double>(contacts[seen].state));
      }
    }
    EXPECT_EQ(seen, contacts.size());
  }
  std::size_t all = 0;
  for (const record::Frame& frame : recording.frames) all += frame.contacts.size();
  EXPECT_LT(channel(form, "contacts.point").rows, all);  // what rests is stored once
}

TEST(Replay, TakesOnlyTheFramesAskedFor) {
  Rng rng = Rng(5).split("replay");
  const record::Recording recording = test::random_recording(rng, 50);
  const Form form = form_of(recording, {0.1, 0.3, 3});
  const Channel& time = channel(form, "time");
  ASSERT_EQ(time.rows, 9u);  // frames of 0.104 s .. 0.296 s, every third
  for (std::size_t i = 0; i < time.rows; ++i) {
    EXPECT_NEAR(time.at(i, 0), 0.104 + 0.024 * static_cast<double>(i), 1e-6);
  }
  EXPECT_NE(complaint([&] { (void)form_of(recording, {5.0, 9.0, 1}); }).find("--from"), std::string::npos);
  EXPECT_NE(complaint([&] { (void)form_of(record::Recording{{}, {}, {}, true, ""}); }), "");
}

TEST(Replay, HeaderTellsWhatRanEvenWhenScenarioAndProgramMakeNoSense) {
  Rng rng = Rng(6).split("replay");
  record::Recording recording = test::random_recording(rng, 3);
  recording.header.scenario_text = "of another version";
  recording.header.program_text = "neither";
  recording.header.settings = "{";
  recording.result = "[1, 2";
  const auto header = nlohmann::json::parse(form_of(recording).header_json);
  EXPECT_EQ(header["format"], "snug replay");
  EXPECT_EQ(header["seed"], "18446744073709551615");
  EXPECT_EQ(header["frames"], 3);
  EXPECT_EQ(header["scenario"]["text"], "of another version");
  EXPECT_TRUE(header["settings"].empty());
  EXPECT_TRUE(header["cup"].is_null());
  EXPECT_TRUE(header["speed"].is_null());
  EXPECT_EQ(header["tool"]["body"], 1);
  ASSERT_EQ(header["bodies"].size(), 4u);
  EXPECT_EQ(header["bodies"][3]["shapes"][0]["triangles"].size(), 4u);
  EXPECT_EQ(header["bodies"][0]["shapes"][1]["kind"], "cylinder");
  EXPECT_EQ(header["bodies"][0]["shapes"][1]["radius"], 0.03);
  EXPECT_EQ(header["bodies"][0]["shapes"][1]["half_length"], 0.2);
  // No result: the boxes' events are those of the recording.
  ASSERT_EQ(header["result"]["boxes"].size(), 2u);
  EXPECT_EQ(header["result"]["boxes"][0]["events"][1]["kind"], "release");
  EXPECT_TRUE(header["result"]["boxes"][0]["state"].is_null());
}

TEST(Replay, HeaderTellsWhichBodiesAreLinksOfARobot) {
  Rng rng = Rng(9).split("replay");
  record::Recording recording = test::random_recording(rng, 3);
  EXPECT_TRUE(nlohmann::json::parse(form_of(recording).header_json)["robot"].is_null());
  recording.header.bodies[0].name = "robot/base_link";
  recording.header.bodies[1].name = "robot/forearm_link";
  recording.header.bodies[2].name = "robot/a box of that name is none";
  const auto header = nlohmann::json::parse(form_of(recording).header_json);
  EXPECT_EQ(header["robot"]["links"], nlohmann::json({0, 1}));
}

TEST(Replay, HeaderTakesTheResultThatTheRunStored) {
  Rng rng = Rng(7).split("replay");
  record::Recording recording = test::random_recording(rng, 3);
  std::ifstream file(SNUG_SOURCE_DIR "/scenarios/box-demonstrator.yaml");
  std::ostringstream text;
  text << file.rdbuf();
  recording.header.scenario_text = text.str();
  recording.result = R"({"duration_s": 10.0, "wall_s": 0.5, "real_time_factor": 20.0, "filling_degree_percent": 12.5,
    "failure": "too deep", "warnings": ["rough"], "boxes": [{"id": "BOX001", "state": "packed", "up": "X", "X_TP": {"p": [1, 2, 3],
    "quat_wxyz": [1, 0, 0, 0]}, "events": [{"time_s": 4.5, "kind": "seal", "body": "BOX001", "text": "t"}]}]})";
  const auto header = nlohmann::json::parse(form_of(recording).header_json);
  EXPECT_EQ(header["speed"]["wall_s"], 0.5);
  EXPECT_EQ(header["result"]["failure"], "too deep");
  EXPECT_EQ(header["result"]["warnings"], nlohmann::json({"rough"}));
  EXPECT_EQ(header["result"]["packed"], 1);
  EXPECT_EQ(header["result"]["boxes"][0]["pose"], nlohmann::json({1, 2, 3, 1, 0, 0, 0}));
  EXPECT_EQ(header["result"]["boxes"][0]["events"][0]["time"], 4.5);
  EXPECT_EQ(header["result"]["report_table7"]["filling_percent"], 75.66);
  // Report eq. 1 with the boxes of Table 9 and the container of 570 x 370 x 250 mm, worked out by hand.
  EXPECT_NEAR(header["result"]["report_table7"]["same_boxes_percent"].get<double>(), 74.22, 0.005);
  const auto& agents = header["result"]["report_table7"]["agents"];
  EXPECT_EQ(header["result"]["report_table7"]["agent"], "I.AM.");
  ASSERT_EQ(agents.size(), 3U);
  EXPECT_EQ(agents[0]["agent"], "I.AM.");
  EXPECT_EQ(agents[1]["filling_percent"], 32.21);
  EXPECT_EQ(agents[2]["agent"], "Manual Operator");
  EXPECT_EQ(header["cup"]["lip_radius"], 0.035);
}

TEST(Replay, HeaderGivesWhatTheScenarioSaysOfOthersWhateverItsSequencesAreCalled) {
  Rng rng = Rng(10).split("replay");
  record::Recording recording = test::random_recording(rng, 3);
  std::ifstream file(SNUG_SOURCE_DIR "/scenarios/box-demonstrator.yaml");
  std::ostringstream text;
  text << file.rdbuf();
  recording.header.scenario_text = text.str();
  recording.result = R"({"duration_s": 1.0, "wall_s": 1.0, "boxes": []})";
  const auto replace = [&](const std::string& from, const std::string& to) {
    std::string& all = recording.header.scenario_text;
    const std::size_t at = all.find(from);
    ASSERT_NE(at, std::string::npos);
    all.replace(at, from.size(), to);
  };
  replace("  - name: \"1\"", "  - name: mine");
  replace("{agent: \"I.AM. (the report's robot, programmed by hand)\", packed_count: 12, filling_percent: 75.66}",
          "{agent: you, filling_percent: 50.0}");
  recording.header.sequence = "mine";
  const auto table = nlohmann::json::parse(form_of(recording).header_json)["result"]["report_table7"];
  EXPECT_EQ(table["agent"], "you");
  EXPECT_EQ(table["filling_percent"], 50.0);
  EXPECT_TRUE(table["boxes"].is_null());
  EXPECT_TRUE(table["same_boxes_percent"].is_null());
  ASSERT_EQ(table["agents"].size(), 3U);
  EXPECT_EQ(table["agents"][0]["filling_percent"], 50.0);
  EXPECT_EQ(table["agents"][1]["filling_percent"], 32.21);
}

TEST(Replay, RefusesTextThatIsNotUtf8) {
  Rng rng = Rng(8).split("replay");
  record::Recording recording = test::random_recording(rng, 1);
  recording.header.scenario_text = "\xff\xfe broken";
  EXPECT_THROW((void)form_of(recording), InputError);
}

TEST(Page, WritesWholeFilesOrNone) {
  const ScratchFolder folder;
  write_file(folder / "a.html", "first");
  write_file(folder / "a.html", "second");
  std::ifstream file(folder / "a.html");
  std::string text;
  std::getline(file, text);
  EXPECT_EQ(text, "second");
  EXPECT_NE(complaint([&] { write_file(folder / "no/such/a.html", "x"); }), "");
  EXPECT_NE(complaint([&] { write_file(folder / "", "x"); }), "");
  std::filesystem::create_directory(folder / "b.html");
  EXPECT_NE(complaint([&] { write_file(folder / "b.html", "x"); }), "");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / ""), {}), 2);  // nothing half-written is left
}

}  // namespace
}  // namespace snug::replay
