// Planning scenes of MoveIt: what is in them, where it is, and numbers that every reader of YAML takes for numbers.
// That the text is the message is the test of scripts/test-exports.sh.
#include "snug/replay/moveit_export.hpp"

#include <gtest/gtest.h>

#include <regex>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/record/writer.hpp"
#include "snug/replay/test/scratch.hpp"

namespace snug::replay {
namespace {

/// At an instant at which BOX001 is held and BOX002 is not there yet.
std::string scene_of(const test::ScratchFolder& folder, record::Recording recording, MoveItTotals& totals) {
  recording.frames[8].bodies[2].X_WB = record::PoseSample({1e-5, 2.0, -0.25}, Quaternion::Identity());
  record::save_recording(folder / "run.h5", recording);
  record::RecordingReader reader(folder / "run.h5");
  totals = export_moveit_scene(reader, "run.h5", 0.0721, folder / "scene.yaml");
  return read_file((folder / "scene.yaml").string(), "a scene");
}

TEST(MoveItExport, HasWhatIsThereAndNotTheGripper) {
  const test::ScratchFolder folder;
  Rng rng = Rng(5).split("moveit");
  MoveItTotals totals;
  const std::string text = scene_of(folder, test::random_recording(rng, 20), totals);
  EXPECT_DOUBLE_EQ(totals.time, 0.072);
  EXPECT_EQ(totals.objects, 2U);
  EXPECT_EQ(totals.frame, "world");
  EXPECT_TRUE(totals.attached.empty());
  EXPECT_NE(text.find("- id: \"table\""), std::string::npos);
  EXPECT_NE(text.find("- {type: 1, dimensions: [0.2, 0.4, 0.1]}"), std::string::npos);
  EXPECT_NE(text.find("- {type: 3, dimensions: [0.4, 0.03]}"), std::string::npos);  // height, radius
  EXPECT_NE(
      text.find("pose: {position: {x: 1.0e-05, y: 2.0, z: -0.25}, orientation: {x: 0.0, y: 0.0, z: 0.0, w: 1.0}}"),
      std::string::npos);
  EXPECT_EQ(text.find("\"tool\""), std::string::npos);
  EXPECT_EQ(text.find("BOX002"), std::string::npos);
  // 1e-05 is a text to readers of YAML 1.1.
  EXPECT_FALSE(std::regex_search(text, std::regex("[ \\[]-?[0-9]+e-?[0-9]+")));
}

TEST(MoveItExport, WritesHullsAsMeshesAndTheSameBytesAgain) {
  const test::ScratchFolder folder;
  Rng rng = Rng(5).split("moveit");
  record::Recording recording = test::random_recording(rng, 20);
  recording.frames[8].bodies[3].present = true;
  MoveItTotals totals;
  const std::string text = scene_of(folder, recording, totals);
  EXPECT_EQ(totals.objects, 3U);
  EXPECT_NE(text.find("meshes:\n        - {triangles: [{vertex_indices: ["), std::string::npos);
  EXPECT_EQ(scene_of(folder, recording, totals), text);
}

TEST(MoveItExport, WritesACapsuleWithoutLengthAsASphere) {
  const test::ScratchFolder folder;
  Rng rng = Rng(5).split("moveit");
  record::Recording recording = test::random_recording(rng, 20);
  record::ShapeInfo& shape = recording.header.bodies[0].shapes[1];
  shape.kind = record::ShapeKind::Capsule;
  MoveItTotals totals;
  EXPECT_NE(scene_of(folder, recording, totals).find("- {type: 2, dimensions: [0.03]}"), std::string::npos);
  shape.half_length = 0.0;
  const std::string text = scene_of(folder, recording, totals);
  EXPECT_NE(text.find("- {type: 2, dimensions: [0.03]}"), std::string::npos);
  EXPECT_EQ(text.find("type: 3"), std::string::npos);
}

TEST(MoveItExport, RefusesARecordingWithoutFrames) {
  const test::ScratchFolder folder;
  Rng rng = Rng(5).split("moveit");
  record::save_recording(folder / "run.h5", test::random_recording(rng, 0));
  record::RecordingReader reader(folder / "run.h5");
  EXPECT_THROW((void)export_moveit_scene(reader, "run.h5", std::nullopt, folder / "scene.yaml"), InputError);
}

}  // namespace
}  // namespace snug::replay
