// Items files: orders as CSV and JSON, more boxes and sequences as YAML, and what is wrong with broken ones.
#include "snug/model/items_file.hpp"
#include "snug/core/test/scratch_folder.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <fstream>
#include <set>

#include "snug/core/input_error.hpp"
#include "snug/model/test/scenario_text.hpp"

namespace snug::model {
namespace {

using test::demonstrator;

const std::filesystem::path kSource = SNUG_SOURCE_DIR;

std::string where_of_error(std::string_view csv) {
  try {
    (void)parse_orders_csv(csv, "orders.csv");
  } catch (const InputError& error) {
    return error.where + " " + error.key;
  }
  return "";
}

TEST(OrdersCsv, ReadsColumnsInAnyOrderWithDefaults) {
  const auto lines = parse_orders_csv(
      "mass_kg,length_mm,width_mm,height_mm,count,upright_only,max_load_kg,order\r\n"
      "0.5, 200,150,100,2,1,,A\r\n\r\n1.5,300,150,100,,,4.5,B",
      "orders.csv");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].size, Vector3(0.2, 0.15, 0.1));
  EXPECT_EQ(lines[0].count, 2);
  EXPECT_TRUE(lines[0].handling.upright_only);
  EXPECT_FALSE(lines[0].handling.max_load.has_value());
  EXPECT_EQ(lines[1].count, 1);
  EXPECT_EQ(lines[1].handling.max_load, 4.5);
  EXPECT_EQ(lines[1].order, "B");
  EXPECT_EQ(lines[1].line, 4);
}

TEST(OrdersCsv, NamesLineAndColumnOfWhatIsWrong) {
  const std::string header = "length_mm,width_mm,height_mm,mass_kg\n";
  EXPECT_EQ(where_of_error(""), "orders.csv ");
  EXPECT_EQ(where_of_error(header), "orders.csv ");
  EXPECT_EQ(where_of_error("length_mm,width_mm,height_mm\n"), "orders.csv:1 mass_kg");
  EXPECT_EQ(where_of_error("length_mm,widht_mm,height_mm,mass_kg\n1,1,1,1"), "orders.csv:1 widht_mm");
  EXPECT_EQ(where_of_error(header + "1,2,3\n"), "orders.csv:2 ");
  EXPECT_EQ(where_of_error(header + "100,200,nan,1\n"), "orders.csv:2 height_mm");
  EXPECT_EQ(where_of_error(header + "100,200,50,1\n100,-5,50,1\n"), "orders.csv:3 width_mm");
  EXPECT_EQ(where_of_error(header + "100,200,50,0\n"), "orders.csv:2 mass_kg");
  EXPECT_EQ(where_of_error(header + "100,200,50,1e999\n"), "orders.csv:2 mass_kg");
  EXPECT_EQ(where_of_error(header + "100,200,50,1kg\n"), "orders.csv:2 mass_kg");
  const std::string more = "count,no_stack,length_mm,width_mm,height_mm,mass_kg\n";
  EXPECT_EQ(where_of_error(more + "2.7,0,100,200,50,1\n"), "orders.csv:2 count");
  EXPECT_EQ(where_of_error(more + "2,0.5,100,200,50,1\n"), "orders.csv:2 no_stack");
}

TEST(OrdersCsv, ReadsWhatSpreadsheetsWrite) {
  const auto lines = parse_orders_csv(
      "\xEF\xBB\xBFlength_mm,width_mm,height_mm,mass_kg,article\r\n"
      "200,150,100,0.5,\"tea, 5\"\" tin\"\r\n\"300\",150,100,1.5,coffee\r\n",
      "orders.csv");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].article, "tea, 5\" tin");
  EXPECT_EQ(lines[1].size.x(), 0.3);
}

TEST(OrdersCsv, RefusesSemicolonsAndQuotesThatAreNotClosed) {
  const auto refusal = [](const std::string& csv) -> std::string {
    try {
      (void)parse_orders_csv(csv, "orders.csv");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::string said = refusal("length_mm;width_mm;height_mm;mass_kg\n100;100;100;1\n");
  EXPECT_EQ(said.find("orders.csv:1: got semicolons between columns; expected commas"), 0U) << said;
  const std::string open = refusal("article,length_mm,width_mm,height_mm,mass_kg\n\"a,100,100,100,1\n");
  EXPECT_EQ(open.find("orders.csv:2: got a quote that is not closed"), 0U) << open;
}

TEST(OrdersJson, ReadsItemsInTheOrderOfTheirNumbers) {
  const auto lines = parse_orders_json(
      R"({"7": {"item_sequence": {"10": {"id": "b", "length/mm": 100, "width/mm": 80, "height/mm": 60, "weight/kg": 1},
                                  "2": {"id": "a", "length/mm": 200, "width/mm": 80, "height/mm": 60, "weight/kg": 2}}}})",
      "x.json");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].article, "a");
  EXPECT_EQ(lines[1].article, "b");
  EXPECT_THROW((void)parse_orders_json("{", "x.json"), InputError);
  EXPECT_THROW((void)parse_orders_json("[]", "x.json"), InputError);
  EXPECT_THROW((void)parse_orders_json(R"({"7": 3})", "x.json"), InputError);
  EXPECT_THROW((void)parse_orders_json(R"({"7": {"item_sequence": {"1": {"id": "a"}}}})", "x.json"), InputError);
}

TEST(OrdersJson, ReadsThePublicOrders) {
  const auto path = kSource / "../shared/data/packing/bed_bpp_5_orders.json";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no folder ../shared beside the project: public orders not read";
  const auto lines = load_orders(path);
  std::set<std::string> orders;
  for (const OrderLine& line : lines) orders.insert(line.order);
  EXPECT_EQ(orders.size(), 5U);
  EXPECT_EQ(lines.size(), 200U);  // 26 + 44 + 38 + 34 + 58
}

TEST(AddOrders, MakesParcelsAndOneSequenceForEachOrder) {
  Scenario scenario = demonstrator();
  const std::size_t before = scenario.parcels.size();
  add_orders(scenario,
             parse_orders_csv("order,length_mm,width_mm,height_mm,mass_kg,count,no_stack\n"
                              "A,200,150,100,0.5,3,1\nB,50,50,50,0.1,2,0\nA,100,100,100,1,1,0\n",
                              "orders.csv"),
             "orders.csv");
  EXPECT_EQ(scenario.parcels.size(), before + 6);
  ASSERT_NE(find_sequence(scenario, "A"), nullptr);
  EXPECT_EQ(find_sequence(scenario, "A")->items.size(), 4U);
  EXPECT_EQ(find_sequence(scenario, "B")->items.size(), 2U);
  const Parcel& parcel = *find_parcel(scenario, find_sequence(scenario, "A")->items[0].parcel);
  EXPECT_TRUE(parcel.handling.no_stack);
  // Cuboid of uniform density: Ixx = m (w^2 + h^2) / 12.
  EXPECT_NEAR(parcel.inertia.inertia(0, 0), 0.5 * (0.15 * 0.15 + 0.1 * 0.1) / 12.0, 1e-15);
  EXPECT_THROW(
      add_orders(scenario, parse_orders_csv("order,length_mm,width_mm,height_mm,mass_kg\nA,1,1,1,1\n", "o"), "o"),
      InputError);
}

TEST(AddOrders, WritesDownWhatItAdded) {
  // Lists of the file in block and in flow style; names that would end a quoted text or stand for something else.
  Scenario block = demonstrator(), flow = demonstrator();
  const YAML::Node root = YAML::Load(flow.source_text);
  for (const char* key : {"parcel_types", "parcels", "sequences"}) {
    YAML::Node list = root[key];
    list.SetStyle(YAML::EmitterStyle::Flow);
  }
  YAML::Emitter emitter;
  emitter << root;
  flow = parse_scenario(std::string(emitter.c_str()) + "\n", flow.source_name);
  for (Scenario* scenario : {&block, &flow}) {
    add_orders(*scenario,
               parse_orders_csv("order,article,length_mm,width_mm,height_mm,mass_kg,upright_only,max_load_kg\n"
                                "null,\"a \"\" \\ b: #\",300,200,150,2.5,1,3\n\"- x, [y]\",~,100,90,80.5,1,0,\n",
                                "o"),
               "o");
    const Scenario again = parse_scenario(scenario->source_text, scenario->source_name);
    EXPECT_EQ(again.parcels, scenario->parcels);
    EXPECT_EQ(again.parcel_types, scenario->parcel_types);
    EXPECT_EQ(again.sequences, scenario->sequences);
    EXPECT_EQ(again.sequences.back().name, "- x, [y]");
  }
}

TEST(AddItems, ReadsMoreBoxesAndSequencesAsInAScenario) {
  const snug::test::ScratchFolder folder;
  const auto path = folder / "items.yaml";
  std::ofstream(path) << "parcels:\n  - {id: BOX900, type: B1, material: box, upright_only: true, max_load: 2.5}\n"
                         "sequences:\n  - name: mine\n    items: [{parcel: BOX900, up: Z}, {parcel: BOX013, up: X}]\n";
  Scenario scenario = demonstrator();
  add_items(scenario, path);
  EXPECT_EQ(find_sequence(scenario, "mine")->items.size(), 2U);
  EXPECT_TRUE(find_parcel(scenario, "BOX900")->handling.upright_only);
  EXPECT_EQ(find_parcel(scenario, "BOX900")->handling.max_load, 2.5);
  std::ofstream(path) << "sequences:\n  - name: wrong\n    items: [{parcel: BOX999, up: Z}]\n";
  const std::size_t sequences = scenario.sequences.size();
  EXPECT_THROW(add_items(scenario, path), InputError);
  EXPECT_EQ(scenario.sequences.size(), sequences);  // nothing half added
  std::filesystem::remove(path);
  EXPECT_THROW(add_items(scenario, path), InputError);
}

}  // namespace
}  // namespace snug::model
