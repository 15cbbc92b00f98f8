// Another container, more boxes: what the scenario is then, and that its text says the same.
#include "snug/model/other_container.hpp"
#include "snug/core/test/scratch_folder.hpp"

#include <gtest/gtest.h>

#include "scenario_text.hpp"
#include "snug/model/items_file.hpp"

namespace snug::model {
namespace {

using test::demonstrator;

const Container& target_of(const Scenario& scenario) { return *find_container(scenario, scenario.target); }

/// The scenario as its own text has it, with what only the file's name tells.
Scenario from_text(const Scenario& scenario) { return parse_scenario(scenario.source_text, scenario.source_name); }

template <class Work>
std::string message_of(Work work) {
  try {
    (void)work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(OtherContainer, StandsWhereTheTargetStandsWithItsLongSideAlongTheLongSide) {
  const Scenario before = demonstrator();
  for (const char* words : {"400x300x200", "300x400x200"}) {
    const Scenario after = with_container(before, words);
    EXPECT_TRUE(target_of(after).inner_size.isApprox(Vector3(0.300, 0.400, 0.200)));
    EXPECT_EQ(target_of(after).X_WT, target_of(before).X_WT);
    EXPECT_EQ(target_of(after).material, target_of(before).material);
    EXPECT_EQ(target_of(after).wall_thickness, target_of(before).wall_thickness);
    EXPECT_EQ(after.target, before.target);
    EXPECT_EQ(after.containers[1], before.containers[1]);
    EXPECT_EQ(after, from_text(after));
  }
}

TEST(OtherContainer, IsTheSameForTheSizesThatItHas) {
  const Scenario before = demonstrator();
  Scenario after = with_container(before, "570x370x250");
  EXPECT_TRUE(target_of(after).inner_size.isApprox(target_of(before).inner_size));
  EXPECT_EQ(with_container(before, "tote1"), before);
}

TEST(OtherContainer, CanBeAnotherOneOfTheScenario) {
  const Scenario after = with_container(demonstrator(), "tote2");
  EXPECT_EQ(after.target, "tote2");
  EXPECT_EQ(after, from_text(after));
}

TEST(OtherContainer, MayBeTooSmallForTheBoxesOfTheScenario) {
  const Scenario after = with_container(demonstrator(), "150x150x100");
  EXPECT_FALSE(target_of(after).holds_all);
  EXPECT_EQ(after, from_text(after));
}

TEST(OtherContainer, IsRefusedWithTheReason) {
  const Scenario before = demonstrator();
  const auto message = [&](const char* words) { return message_of([&] { return with_container(before, words); }); };
  EXPECT_NE(message("tote3").find("tote1, tote2"), std::string::npos);
  EXPECT_NE(message("400x300").find("LxWxH"), std::string::npos);
  EXPECT_NE(message("400x300x200x100").find("LxWxH"), std::string::npos);
  EXPECT_NE(message("400x300x").find("LxWxH"), std::string::npos);
  EXPECT_NE(message("").find("LxWxH"), std::string::npos);
  EXPECT_NE(message("nanx300x200").find("10 to 10000 mm"), std::string::npos);
  EXPECT_NE(message("infx300x200").find("10 to 10000 mm"), std::string::npos);
  EXPECT_NE(message("-400x300x200").find("10 to 10000 mm"), std::string::npos);
  EXPECT_NE(message("1x1x1").find("10 to 10000 mm"), std::string::npos);
  EXPECT_NE(message("100000x100000x100000").find("10 to 10000 mm"), std::string::npos);
  EXPECT_NE(message("700x400x200").find("'workbench' is in its way"), std::string::npos);
}

TEST(OtherContainer, MayNotReachUnderWhatStandsOverIt) {
  // Its rim is 62 mm under the bench, whose opening is 410 mm wide: 409 mm are open upward, 411 mm are not.
  EXPECT_NO_THROW((void)with_container(demonstrator(), "500x409x200"));
  EXPECT_THROW((void)with_container(demonstrator(), "500x411x200"), InputError);
}

TEST(Pallet, IsASlabWithoutWalls) {
  const Scenario before = demonstrator();
  const Scenario after = with_pallet(before, "600x400");
  EXPECT_FALSE(target_of(after).has_walls);
  EXPECT_TRUE(target_of(after).inner_size.isApprox(Vector3(0.400, 0.600, 0.250)));
  EXPECT_NEAR(target_of(with_pallet(before, "600x400x800")).inner_size.z(), 0.8, 1e-12);
  const std::vector<PlacedShape> shapes = make_walls(target_of(after));
  ASSERT_EQ(shapes.size(), 1U);
  EXPECT_TRUE(std::get<geometry::Box>(shapes[0].shape).half.isApprox(Vector3(0.2, 0.3, 0.009)));
  EXPECT_NEAR(shapes[0].X_BG.p.z(), -0.009, 1e-12);
  EXPECT_EQ(after, from_text(after));
  EXPECT_THROW((void)with_pallet(before, "600"), InputError);
  EXPECT_THROW((void)with_pallet(before, "tote2"), InputError);
  EXPECT_THROW((void)with_pallet(before, "1200x800"), InputError);
}

TEST(ItemsText, HoldsTheBoxesOfOrders) {
  Scenario scenario = demonstrator();
  add_orders(
      scenario,
      parse_orders_csv("order,article,length_mm,width_mm,height_mm,mass_kg,count,upright_only,no_stack,max_load_kg\n"
                       "night shift,\"tea: 20\",220.5,150,100,0.75,3,1,0,2.5\n"
                       "night shift,null,330,150,100,1.25,1,0,1,\n"
                       "7,# glass,900,700,600,9.0,2,0,0,0\n",
                       "orders.csv"),
      "orders.csv");
  EXPECT_EQ(scenario, from_text(scenario));
  EXPECT_EQ(from_text(scenario).sequences.size(), 7U);
}

TEST(ItemsText, HoldsWhatAnItemsFileHasAndGoesWithAnotherContainer) {
  const snug::test::ScratchFolder folder;
  const auto path = folder / "items.yaml";
  std::ofstream(path) << "parcel_types:\n  - {name: tall, size: [0.1, 0.1, 0.25], mass: 0.5}\n"
                         "parcels:\n  - {id: T1, type: tall, material: box, com: [0, 0, -0.02]}\n"
                         "sequences:\n  - {name: mixed, task_stiffness: 12, items: [{parcel: T1, up: -Z, yaw_deg: 90}, "
                         "{parcel: BOX013, up: X}]}\n";
  Scenario scenario = with_container(demonstrator(), "400x300x200");
  add_items(scenario, path);
  EXPECT_EQ(scenario, from_text(scenario));
  ASSERT_NE(find_sequence(from_text(scenario), "mixed"), nullptr);
  EXPECT_EQ(scenario.source_text.find("# changed: --container 400x300x200\n# changed: --items "), 0U);
  const Scenario again = with_container(scenario, "300x300x300");
  EXPECT_EQ(again.parcels, scenario.parcels);
  EXPECT_EQ(again, from_text(again));
}

TEST(ItemsText, RefusesWhatAScenarioCouldNotSay) {
  const std::string header = "order,article,length_mm,width_mm,height_mm,mass_kg\n";
  const auto add = [&](const std::string& line) {
    Scenario scenario = demonstrator();
    scenario.parcel_clearance = 0.002;
    add_orders(scenario, parse_orders_csv(header + line, "orders.csv"), "orders.csv");
    return 0;
  };
  EXPECT_NE(message_of([&] { return add("a,b,100,100,2,1"); }).find("parcel_clearance"), std::string::npos);
  EXPECT_NE(message_of([&] { return add("a," + std::string(101, 'x') + ",100,100,20,1"); }).find("orders.csv:2"),
            std::string::npos);
  EXPECT_NE(message_of([&] { return add("1,b,100,100,20,1"); }).find("not taken"), std::string::npos);
}

}  // namespace
}  // namespace snug::model
