// Sheets of boxes: headings and units of several languages, what is asked for, and what hostile ones do.
#include "snug/model/items_sheet.hpp"

#include <gtest/gtest.h>

#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/model/items_file.hpp"

namespace snug::model {
namespace {

std::string orders_of(std::string_view text, const SheetAnswers& answers = {}) {
  return read_items_sheet(text, "sheet.csv", answers).orders;
}

std::vector<std::string> asked_of(std::string_view text, const SheetAnswers& answers = {}) {
  std::vector<std::string> about;
  for (const SheetQuestion& one : read_items_sheet(text, "sheet.csv", answers).questions) about.push_back(one.about);
  return about;
}

TEST(ItemsSheet, LeavesOrdersAsTheyAre) {
  const std::string text = "length_mm,width_mm,height_mm,mass_kg\n18x,100,90,0.4\n";
  EXPECT_EQ(orders_of(text), text);
}

TEST(ItemsSheet, KnowsUnitsInHeadingsAndBehindNumbers) {
  EXPECT_EQ(orders_of("Length (cm),Width [mm],HEIGHT_m,Weight in g,Qty\n20,150,0.1,500,2\n"),
            "length_mm,width_mm,height_mm,mass_kg,count\n200,150,100,0.5,2\n");
  EXPECT_EQ(orders_of("length,width,height,mass\n20 cm,6 in,90 mm,1 lb\n"),
            "length_mm,width_mm,height_mm,mass_kg\n200,152.4,90,0.453592\n");
}

TEST(ItemsSheet, ReadsSemicolonsDecimalCommasAndOtherLanguages) {
  const std::string text =
      "Auftrag;Artikel;L\xC3\x84NGE cm;Breite cm;H\xC3\xB6he cm;Gewicht "
      "kg;Bemerkung\n7;\"Tee;lose\";20,5;15;10;1.000,25;x\n";
  EXPECT_EQ(orders_of(text), "order,article,length_mm,width_mm,height_mm,mass_kg\n7,Tee;lose,205,150,100,1000.25\n");
}

TEST(ItemsSheet, ReadsSizesOfOneColumn) {
  EXPECT_EQ(orders_of("sku\tSize (L x W x H)\tkg weight\nA\t20x15 \xC3\x97 10 cm\t0.5\n"),
            "article,length_mm,width_mm,height_mm,mass_kg\nA,200,150,100,0.5\n");
}

TEST(ItemsSheet, TheWeightThatACartonMayHoldIsNotItsMass) {
  EXPECT_EQ(orders_of("length mm,width mm,height mm,max_weight_kg,tare_weight_kg\n300,250,200,10,0.3\n"),
            "length_mm,width_mm,height_mm,mass_kg\n300,250,200,0.3\n");
  try {
    (void)orders_of("length mm,width mm,height mm,max. weight kg\n300,250,200,10\n");
    ADD_FAILURE() << "was read";
  } catch (const InputError& error) {
    EXPECT_EQ(error.key, "mass_kg");
  }
}

TEST(ItemsSheet, ColumnsThatCompeteAreNamed) {
  try {
    (void)orders_of("name,inner_length_mm,outer_length_mm,width mm,height mm,weight kg\na,1,2,3,4,5\n");
    ADD_FAILURE() << "was read";
  } catch (const InputError& error) {
    EXPECT_EQ(error.got, "more than one column: inner_length_mm, outer_length_mm");
  }
}

TEST(ItemsSheet, AsksForUnitsThatItDoesNotSay) {
  const std::string text = "length,width,height,mass\n20,15,10,500\n";
  const ItemsSheet sheet = read_items_sheet(text, "sheet.csv", {});
  EXPECT_TRUE(sheet.orders.empty());
  ASSERT_EQ(sheet.questions.size(), 2U);
  EXPECT_EQ(sheet.questions[0].about, "length");
  EXPECT_EQ(sheet.questions[0].choices[1], (SheetQuestion::Choice{"cm", "200 x 150 x 100 mm"}));
  EXPECT_EQ(sheet.questions[1].choices[1], (SheetQuestion::Choice{"g", "0.5 kg"}));
  EXPECT_EQ(orders_of(text, {"cm", "g", ""}), "length_mm,width_mm,height_mm,mass_kg\n200,150,100,0.5\n");
}

TEST(ItemsSheet, AsksWhetherACommaIsOneOfThousands) {
  const std::string unclear = "length mm;width mm;height mm;mass g\n200;150;100;1,250\n";
  EXPECT_EQ(asked_of(unclear), std::vector<std::string>{"decimal"});
  EXPECT_NE(orders_of(unclear, {"", "", "comma"}).find("100,0.00125\n"), std::string::npos);
  EXPECT_NE(orders_of(unclear, {"", "", "point"}).find("100,1.25\n"), std::string::npos);
  EXPECT_TRUE(asked_of("length mm;width mm;height mm;mass g\n200,5;150;100;1,250\n").empty());  // 200,5 says it
}

TEST(ItemsSheet, ReadsCommasAndPointsBesideEachOther) {
  EXPECT_EQ(orders_of("length cm;width cm;height cm;mass kg\n18,5;12;10.5;0,4\n"),
            "length_mm,width_mm,height_mm,mass_kg\n185,120,105,0.4\n");
}

TEST(ItemsSheet, KeepsWhatItCannotReadInItsLine) {
  const std::string orders = orders_of("length mm;width mm;height mm;mass kg\n\n1e5x;100;100;1\n");
  try {
    (void)parse_orders_csv(orders, "sheet.csv");
    FAIL() << orders;
  } catch (const InputError& error) {
    EXPECT_EQ(error.where, "sheet.csv:3");
    EXPECT_EQ(error.key, "length_mm");
  }
}

TEST(ItemsSheet, SaysWhichColumnIsMissingOrThereTwice) {
  for (const auto& [text, key] : {std::pair{"length mm,width mm,mass kg\n1,1,1\n", "height_mm"},
                                  std::pair{"length mm,l mm,width mm,height mm,mass kg\n1,1,1,1,1\n", "length_mm"},
                                  std::pair{"size mm,length mm,mass kg\n1x1x1,1,1\n", "length_mm"}}) {
    try {
      (void)read_items_sheet(text, "sheet.csv", {});
      FAIL() << text;
    } catch (const InputError& error) {
      EXPECT_EQ(error.key, key);
      EXPECT_EQ(error.where, "sheet.csv:1");
    }
  }
}

TEST(ItemsSheet, EndsForAnyText) {
  Rng rng = Rng(5).split("sheets");
  const std::string pieces[] = {"length", "mass",     ";",    ",",     "\t",     "\n", "\"", "1,250", "20 cm",
                                "x",      "\xC3\x97", "size", "width", "height", "-",  "kg", " ",     "1e400"};
  for (int i = 0; i < 3000; ++i) {
    std::string text;
    for (int k = 0; k < 20; ++k) text += pieces[static_cast<std::size_t>(rng.uniform(0.0, 17.999))];
    try {
      (void)read_items_sheet(text, "sheet.csv", {});
    } catch (const InputError&) {
      continue;
    }
  }
}

}  // namespace
}  // namespace snug::model
