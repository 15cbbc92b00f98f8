// Representatives, sequences and loads as text: what is written as a block of a scenario is one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "snug/core/input_error.hpp"
#include "snug/core/temporary_folder.hpp"
#include "snug/packing/instances.hpp"
#include "snug/packing/item_text.hpp"
#include "snug/packing/load_text.hpp"

namespace snug::packing {
namespace {

const model::Scenario& demonstrator() {
  static const model::Scenario scenario =
      model::load_scenario(std::filesystem::path(SNUG_SOURCE_DIR) / "scenarios/box-demonstrator.yaml");
  return scenario;
}

Reduction two_kinds() {
  Reduction reduction;
  reduction.representatives = {{Vector3(0.3, 0.2, 0.1), 1.5, 6}, {Vector3(0.2, 0.1, 0.1), 0.5, 2}};
  reduction.groups = 3;
  reduction.boxes = 8;
  reduction.covered_percent = 75.0;
  return reduction;
}

TEST(ItemText, RepresentativesAreTypesOfAScenarioFromWhichBoxesAreDrawn) {
  TemporaryFolder folder("snug-item-text");
  const std::filesystem::path types = folder.path() / "types.yaml";
  std::ofstream(types) << format_yaml(two_kinds());
  const model::Scenario drawn = with_boxes_of_types(demonstrator(), types, 50.0);
  ASSERT_EQ(drawn.parcel_types.size(), 2U);
  EXPECT_EQ(drawn.parcel_types[0].mass, 1.5);
  const double container = model::find_container(demonstrator(), demonstrator().target)->inner_size.prod();
  const auto count = [&](const char* type) {
    return std::ranges::count_if(drawn.parcels, [&](const model::Parcel& parcel) { return parcel.type == type; });
  };
  EXPECT_EQ(count("R1"), static_cast<int>(std::ceil(0.5 * container / 0.006))) << "one type alone fills it";
  const model::Sequence sequence = draw_sequence(drawn, "drawn", {.fill_percent = 50.0}, Rng(1));
  const std::filesystem::path items = folder.path() / "items.yaml";
  std::ofstream(items) << format_boxes_yaml(drawn, {sequence}, "box") << format_sequences_yaml({sequence});
  model::Scenario with = demonstrator();
  model::add_items(with, items);
  const model::Sequence* added = model::find_sequence(with, "drawn");
  ASSERT_NE(added, nullptr);
  EXPECT_EQ(added->items.size(), sequence.items.size());
  EXPECT_EQ(with.parcels.size(), demonstrator().parcels.size() + sequence.items.size()) << "no box that none takes";
}

TEST(ItemText, RefusesAFileWithoutTypes) {
  TemporaryFolder folder("snug-item-text");
  std::ofstream(folder.path() / "none.yaml") << "sequences: []\n";
  EXPECT_THROW((void)with_boxes_of_types(demonstrator(), folder.path() / "none.yaml", 50.0), InputError);
}

TEST(ItemText, TableAndJsonSayHowManyBoxesAreRepresented) {
  const std::string table = format_table(two_kinds(), 20.0);
  EXPECT_NE(table.find("R1      300.0    200.0    100.0     1.500       6     75.0\n"), std::string::npos) << table;
  EXPECT_NE(table.find("8 boxes in 3 groups; 75.0 % are within 20 %"), std::string::npos) << table;
  const auto result = nlohmann::json::parse(format_json(two_kinds()));
  EXPECT_EQ(result.at("representatives").at(1).at("boxes"), 2);
  EXPECT_EQ(result.at("covered_percent"), 75.0);
}

TEST(DrawOrder, HasEveryBoxOnceAndANameOfItsOwn) {
  const model::Sequence order = draw_order(demonstrator(), "random-1", 7);
  EXPECT_EQ(order.items.size(), demonstrator().parcels.size());
  EXPECT_EQ(order, draw_order(demonstrator(), "random-1", 7));
  EXPECT_NE(order.items, draw_order(demonstrator(), "random-1", 8).items);
  EXPECT_THROW((void)draw_order(demonstrator(), demonstrator().sequences.front().name, 7), InputError);
}

TEST(LoadText, SaysWhatIsLoadedOfWhatThereIsAndTheMean) {
  LoadProblem problem;
  problem.name = "A";
  problem.container = {100, 100, 100};
  CargoType type;
  type.name = "cube";
  type.size = {50, 50, 50};
  type.count = 4;
  problem.types = {type};
  const SolvedLoad load{problem, load_container(problem, {0.01, 1})};
  ASSERT_EQ(load.result.boxes.size(), 4U);
  const std::string table = format_load_table({load});
  EXPECT_NE(table.find("A                              4         4    50.00\n"), std::string::npos) << table;
  const auto result = nlohmann::json::parse(format_load_json({load, load}, 2.0));
  EXPECT_EQ(result.at("mean_percent"), 50.0);
  EXPECT_EQ(result.at("problems").at(1).at("available"), 4);
  EXPECT_EQ(result.at("problems").at(0).at("boxes").size(), 4U);
  EXPECT_EQ(result.at("time"), 2.0);
}

TEST(DropLoadLimits, CountsTheBoxesThatHadOne) {
  std::vector<model::OrderLine> lines(3);
  lines[0].count = 2;
  lines[0].handling.no_stack = true;
  lines[1].count = 3;
  lines[1].handling.max_load = 4.0;
  EXPECT_EQ(drop_load_limits(lines), 5);
  EXPECT_EQ(drop_load_limits(lines), 0) << "they are gone";
}

}  // namespace
}  // namespace snug::packing
