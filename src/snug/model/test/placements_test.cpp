// Placements: what a list of boxes and poses may say, and the line and key that each mistake is blamed on.
#include "snug/model/placements.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scenario_text.hpp"

namespace snug::model {
namespace {

using test::demonstrator;

/// `key` of the second placement, which stands in line 3 of a text of three lines.
struct Mistake {
  std::string line;
  std::string key;
  std::string got;
  std::string expected;
  int at = 3;
};

void expect_blamed(const Mistake& mistake) {
  const std::string text = "# two boxes\n- {box: BOX027, position: [0.1, 0.2, 0.05]}\n" + mistake.line + "\n";
  SCOPED_TRACE(mistake.line);
  try {
    (void)parse_placements(text, "list.yaml", demonstrator());
    ADD_FAILURE() << "no complaint about " << mistake.key;
  } catch (const InputError& error) {
    SCOPED_TRACE(error.what());
    EXPECT_EQ(error.where, "list.yaml:" + std::to_string(mistake.at));
    EXPECT_EQ(error.key, mistake.key);
    EXPECT_NE(error.got.find(mistake.got), std::string::npos);
    EXPECT_NE(error.expected.find(mistake.expected), std::string::npos);
  }
}

TEST(Placements, ReadsPositionsAndBothWaysToSayAnOrientation) {
  const auto entries = parse_placements(
      "- {box: BOX027, position: [0.25, -0.5, 0.125]}\n"
      "- {box: BOX013, position: [-1, 0, 2], yaw_deg: 90}\n"
      "- box: BOX014\n"
      "  position: [0, 0, 0]\n"
      "  quat_wxyz: [0.70710678, 0.0, -0.70710678, 0.0]\n",
      "list.yaml", demonstrator());
  ASSERT_EQ(entries.size(), 3U);
  EXPECT_EQ(entries[0].parcel, "BOX027");
  EXPECT_EQ(entries[0].X_TP.p, Vector3(0.25, -0.5, 0.125));
  EXPECT_EQ(entries[0].X_TP.R, Matrix3::Identity());
  // 1e-15: a few roundings of sine and cosine.
  EXPECT_LT((entries[1].X_TP.R * Vector3::UnitX() - Vector3::UnitY()).norm(), 1e-15);
  EXPECT_EQ(entries[1].X_TP.p, Vector3(-1.0, 0.0, 2.0));
  // A quarter turn about -y lifts the x axis of the box. 1e-8: the quaternion has eight digits.
  EXPECT_LT((entries[2].X_TP.R * Vector3::UnitX() - Vector3::UnitZ()).norm(), 1e-8);
  EXPECT_LT((entries[2].X_TP.R.transpose() * entries[2].X_TP.R - Matrix3::Identity()).norm(), 1e-15);
  EXPECT_EQ(entries[0].line, 1);
  EXPECT_EQ(entries[1].line, 2);
  EXPECT_EQ(entries[2].line, 3);
}

TEST(Placements, KeepsTheOrderOfTheFileForPackingSequenceOneOfTheReport) {
  const auto entries = load_placements(test::project_file("scenarios/demo-placements.yaml"), demonstrator());
  const Sequence& sequence = *find_sequence(demonstrator(), "1");
  ASSERT_EQ(entries.size(), 12U);
  for (std::size_t i = 0; i < entries.size(); ++i) EXPECT_EQ(entries[i].parcel, sequence.items[i].parcel);
}

TEST(Placements, NormalizesAQuaternionWithFourDigits) {
  const auto entries = parse_placements("- {box: BOX027, position: [0, 0, 0], quat_wxyz: [0.7071, 0, 0, 0.7071]}",
                                        "list.yaml", demonstrator());
  EXPECT_LT((entries[0].X_TP.R * Vector3::UnitX() - Vector3::UnitY()).norm(), 1e-15);
}

// What `snug pack --plan` writes.
TEST(Placements, ReadsAPlan) {
  const std::string text =
      "{\"sequence\": \"1\", \"agent\": \"margin\", \"placements\": [\n"
      "{\"box\": \"BOX014\", \"position\": [0.1, -0.2, 0.3], \"quaternion_wxyz\": [0.0, 0.0, 0.707106781, "
      "0.707106781],\n"
      " \"up\": \"Y\", \"up_sign\": 1, \"yaw_quarter\": 1}]}\n";
  const auto entries = parse_placements(text, "plan.json", demonstrator());
  ASSERT_EQ(entries.size(), 1U);
  EXPECT_EQ(entries[0].parcel, "BOX014");
  EXPECT_EQ(entries[0].X_TP.p, Vector3(0.1, -0.2, 0.3));
  EXPECT_LT((entries[0].X_TP.R * Vector3::UnitY() - Vector3::UnitZ()).norm(), 1e-8) << "the y axis is up";
  for (const char* changed : {"quaternion_wxyz", "position", "box", "placements"}) {
    std::string wrong = text;
    wrong.replace(wrong.find(changed), 3, "xyz");
    EXPECT_THROW((void)parse_placements(wrong, "plan.json", demonstrator()), InputError) << changed;
  }
}

TEST(Placements, BlamesLineAndKeyOfABoxThatCannotBePlaced) {
  expect_blamed({"- {box: BOX047, position: [0, 0, 0]}", "[1].box", "BOX047", "nearest is 'BOX0"});
  expect_blamed({"- {box: BOX027, position: [0, 0, 0]}", "[1].box", "BOX027", "at most once"});
  expect_blamed({"- {box: [BOX013], position: [0, 0, 0]}", "[1].box", "a list of 1", "a name"});
  expect_blamed({"- {position: [0, 0, 0]}", "[1].box", "nothing", ""});
}

TEST(Placements, BlamesLineAndKeyOfAPositionThatIsNone) {
  expect_blamed({"- {box: BOX013}", "[1].position", "nothing", ""});
  expect_blamed({"- {box: BOX013, position: [0, 0]}", "[1].position", "a list of 2", "a list of 3"});
  expect_blamed({"- {box: BOX013, position: [0, 0, .nan]}", "[1].position[2]", ".nan", "a finite number"});
  expect_blamed({"- {box: BOX013, position: [0, 1e999, 0]}", "[1].position[1]", "1e999", "a finite number"});
  expect_blamed({"- {box: BOX013, position: [61, 102, 7600]}", "[1].position[2]", "7600", "metres"});
  expect_blamed({"- {box: BOX013, position: [0, -1e17, 0]}", "[1].position[1]", "-1e17", "at most 1e+12"});
  expect_blamed({"- {box: BOX013, position: [0.061 m, 0, 0]}", "[1].position[0]", "0.061 m", "without unit text"});
}

TEST(Placements, BlamesLineAndKeyOfAnOrientationThatIsNone) {
  const std::string start = "- {box: BOX013, position: [0, 0, 0], ";
  expect_blamed({start + "quat_wxyz: [1, 0, 0]}", "[1].quat_wxyz", "a list of 3", "w, x, y, z"});
  expect_blamed({start + "quat_wxyz: [0, 0, 0, 0]}", "[1].quat_wxyz", "a list of 4", "unit quaternion"});
  expect_blamed({start + "quat_wxyz: [1, 1, 0, 0]}", "[1].quat_wxyz", "a list of 4", "unit quaternion"});
  expect_blamed({start + "quat_wxyz: [1, 0, 0, .inf]}", "[1].quat_wxyz[3]", ".inf", "a finite number"});
  expect_blamed({start + "yaw_deg: north}", "[1].yaw_deg", "north", "a finite number"});
  expect_blamed({start + "yaw_deg: 1.0e6}", "[1].yaw_deg", "1.0e6", "degrees"});
  expect_blamed({start + "yaw_deg: 90, quat_wxyz: [1, 0, 0, 0]}", "[1].quat_wxyz", "both 'yaw_deg' and 'quat_wxyz'",
                 "one of the two"});
}

TEST(Placements, BlamesAnUnknownKeyAndNamesTheNearest) {
  expect_blamed({"- {box: BOX013, position: [0, 0, 0], yaw: 90}", "[1].yaw", "", "yaw_deg"});
  expect_blamed({"- {box: BOX013, positon: [0, 0, 0]}", "[1].positon", "", "position"});
  expect_blamed({"- BOX013", "[1]", "BOX013", "a mapping"});
}

TEST(Placements, RefusesTextThatIsNoListAndAFileThatIsNotThere) {
  const auto parse = [](const char* text) { (void)parse_placements(text, "list.yaml", demonstrator()); };
  EXPECT_THROW(parse(""), InputError);
  EXPECT_THROW(parse("[]"), InputError);
  EXPECT_THROW(parse("{box: BOX013, position: [0, 0, 0]}"), InputError);
  EXPECT_THROW(parse("- {box: BOX013, position: [0, 0"), InputError);
  EXPECT_THROW((void)load_placements("no/such/list.yaml", demonstrator()), InputError);
}

}  // namespace
}  // namespace snug::model
