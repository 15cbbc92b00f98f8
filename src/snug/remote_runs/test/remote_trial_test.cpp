// What does not go together is refused before anything is asked or moved.
#include "snug/remote_runs/remote_trial.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "snug/core/input_error.hpp"

namespace snug::remote_runs {
namespace {

const model::Scenario& demonstrator() {
  static const model::Scenario scenario =
      model::load_scenario(std::filesystem::path(SNUG_SOURCE_DIR) / "scenarios/box-demonstrator.yaml");
  return scenario;
}

template <class Work>
std::string complaint_of(Work work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string complaint_of_frames(const PlantChoice& plant) {
  return complaint_of([&] { (void)make_frames(plant, demonstrator(), {}); });
}

std::string complaint_of_ur(const PlantChoice& plant) {
  return complaint_of([&] {
    const std::string sequence = "1";
    (void)run_ur_trial(plant, {demonstrator(), sequence, {}, {}, {}, {}}, {});
  });
}

TEST(PlantChoice, OptionsOfARobotNeedOne) {
  PlantChoice plant{.address = "ur://127.0.0.1", .is_dry = true, .may_move = true};
  EXPECT_NO_THROW(refuse_options_of_a_robot(plant));
  plant.address = "click://127.0.0.1:5555";
  EXPECT_NE(complaint_of([&] { refuse_options_of_a_robot(plant); }).find("--dry-run"), std::string::npos);
  plant = {.observe = "tcp://127.0.0.1:1"};
  EXPECT_NE(complaint_of([&] { refuse_options_of_a_robot(plant); }).find("--observe"), std::string::npos);
  EXPECT_EQ(complaint_of([] { refuse_options_of_a_robot({}); }), "");
}

TEST(MakeFrames, NeedsPerceptionSourceAndAPlantThatACameraCanSee) {
  EXPECT_EQ(complaint_of_frames({}), "");
  EXPECT_FALSE(make_frames({}, demonstrator(), {}));
  EXPECT_NE(complaint_of_frames({.frames = "folder"}).find("with --perception exact"), std::string::npos);
  EXPECT_NE(complaint_of_frames({.perception = "frames"}).find("frames, without --frames"), std::string::npos);
  EXPECT_NE(complaint_of_frames({.perception = "frames", .frames = "folder"}).find("of a plant in this program"),
            std::string::npos);
  model::Scenario blind = demonstrator();
  blind.cameras.clear();
  const PlantChoice plant{.address = "click://127.0.0.1:5555", .perception = "frames", .frames = "folder"};
  EXPECT_NE(complaint_of([&] { (void)make_frames(plant, blind, {}); }).find("cameras"), std::string::npos);
}

TEST(UrTrial, AsksBeforeItMovesARobotElsewhereAndNeedsWhoTellsWhereBoxesAre) {
  EXPECT_NE(complaint_of_ur({.address = "ur://192.0.2.1"}).find("--yes-this-moves-a-robot"), std::string::npos);
  EXPECT_NE(complaint_of_ur({.address = "ur://127.0.0.1"}).find("'exact' without --observe"), std::string::npos);
}

}  // namespace
}  // namespace snug::remote_runs
