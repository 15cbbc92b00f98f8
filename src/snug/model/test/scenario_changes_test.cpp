// What is said of a scenario for one run: applied in one order, said again as words, boxes left out by name.
#include "snug/model/scenario_changes.hpp"

#include <gtest/gtest.h>

#include "snug/core/input_error.hpp"

namespace snug::model {
namespace {

const std::filesystem::path kSource = SNUG_SOURCE_DIR;

TEST(ScenarioChanges, AreAppliedAndSaidAgainAsWords) {
  ScenarioChanges changes;
  EXPECT_FALSE(changes.any());
  changes.set = {"seed=77"};
  changes.container = "400x300x200";
  changes.items = {"orders"};
  EXPECT_TRUE(changes.any());
  using Words = std::vector<std::pair<std::string, std::string>>;
  EXPECT_EQ(words_of(changes), (Words{{"--items", "orders"}, {"--container", "400x300x200"}, {"--set", "seed=77"}}));
  const Scenario plain = load_scenario(kSource / "scenarios/box-demonstrator.yaml");
  const Scenario loaded =
      load_changed(kSource / "scenarios/box-demonstrator.yaml", changes, [](const std::string& name) {
        EXPECT_EQ(name, "orders");
        return (kSource / "scenarios/orders-example.csv").string();
      });
  EXPECT_EQ(loaded.seed, 77U);
  EXPECT_NEAR(find_container(loaded, loaded.target)->inner_size.z(), 0.2, 1e-12);
  EXPECT_GT(loaded.parcels.size(), plain.parcels.size());
}

TEST(WithTimeStep, IsAWholePartOfTheTickAndNoShorterThanTheScenarios) {
  Scenario scenario = load_scenario(kSource / "scenarios/box-demonstrator.yaml");
  scenario.time_step = 0.001;
  scenario.controller.tick = 0.008;
  const auto step = [&](double longest) { return with_time_step(scenario, longest).time_step; };
  EXPECT_EQ(step(0.0), 0.001);
  EXPECT_EQ(step(0.0005), 0.001);
  EXPECT_EQ(step(0.002), 0.002);
  EXPECT_DOUBLE_EQ(step(0.003), 0.008 / 3.0);
  EXPECT_EQ(step(0.1), 0.008);
}

TEST(RequireParcel, NamesTheNearest) {
  const Scenario scenario = load_scenario(kSource / "scenarios/box-demonstrator.yaml");
  const std::string id = scenario.parcels.front().id;
  EXPECT_EQ(require_parcel(scenario, id, "--parcel").id, id);
  EXPECT_THROW((void)require_parcel(scenario, id + "x", "--parcel"), InputError);
}

TEST(LeaveOut, TakesBoxesOutOfOneSequenceAndNamesTheNearest) {
  Scenario scenario = load_scenario(kSource / "scenarios/box-demonstrator.yaml");
  const Sequence before = scenario.sequences.front();
  const std::string box = before.items[1].parcel;
  leave_out(scenario, before.name, {box});
  EXPECT_EQ(scenario.sequences.front().items.size(), before.items.size() - 1);
  EXPECT_NE(scenario.sequences.front().items[1].parcel, box);
  try {
    leave_out(scenario, before.name, {box + "x"});
    FAIL() << "there is no such box";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("nearest is '"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace snug::model
