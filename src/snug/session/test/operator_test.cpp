// Who operates: lines that are read strictly, and a session that does what they say where it can.
#include "snug/session/operator.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "snug/core/input_error.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/session/fold.hpp"
#include "snug/session/test/scripted_plant.hpp"

namespace snug::session {
namespace {

using test::quick_options;
using test::ScriptedPlant;
using test::two_boxes;

std::optional<OperatorOrder> parse(std::string_view text) { return parse_operator_order(text, "said", 7); }

OperatorSource says(std::vector<std::string> lines) {
  OperatorOrders orders;
  for (std::size_t i = 0; i < lines.size(); ++i)
    orders.orders.push_back(*parse_operator_order(lines[i], "said", static_cast<int>(i) + 1));
  orders.is_over = true;
  return [orders] { return orders; };
}

struct Told {
  SessionResult result;
  EventLog log;
  std::vector<std::string> brought, brought_on_the_way;
};

Told pack(std::vector<std::string> lines, SessionOptions options = quick_options()) {
  Told told;
  ScriptedPlant plant;
  plant.passes = true;
  options.log = [&](const SessionEvent& one) { told.log.events.push_back(one); };
  options.operator_orders = says(std::move(lines));
  told.result = session::pack(two_boxes(), "1", options, plant);
  told.brought = plant.brought;
  told.brought_on_the_way = plant.brought_on_the_way;
  return told;
}

std::string lines_of(const EventLog& log) {
  std::string text;
  for (const SessionEvent& one : log.events) text += format_event(one) + "\n";
  return text;
}

TEST(OperatorOrder, ReadsWhatItWrites) {
  const std::vector<OperatorOrder> all{{7, "BOX027", OperatorAction::Hold, 0, ""},
                                       {7, "", OperatorAction::Go, 0, ""},
                                       {7, "a b", OperatorAction::Skip, 0, ""},
                                       {7, "next", OperatorAction::Place, 12, ""},
                                       {7, "#1", OperatorAction::Elsewhere, 0, ""},
                                       {7, "x", OperatorAction::TakeOut, 0, "with \"quotes\" and \\ in it"}};
  for (const OperatorOrder& one : all) EXPECT_EQ(parse(format_operator_order(one)), one) << format_operator_order(one);
  EXPECT_EQ(parse("").has_value() || parse("  # a comment").has_value(), false);
  EXPECT_EQ(parse(" next\tskip \r")->action, OperatorAction::Skip);
}

TEST(OperatorOrder, RefusesWhatIsNone) {
  for (const char* text :
       {"BOX027", "BOX027 skipp", "BOX027 skip now", "BOX027 place", "BOX027 place 0", "BOX027 place -1",
        "BOX027 place 1x", "BOX027 place 99999999999", "BOX027 take-out", "\"BOX027 skip", "\"\" skip", "next \xff"}) {
    EXPECT_THROW((void)parse(text), InputError) << text;
  }
  EXPECT_THROW((void)parse(std::string(5000, 'x')), InputError);
  try {
    (void)parse("BOX027 skipp");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.where, "said:7");
    EXPECT_EQ(error.expected, "'skip'");
  }
}

TEST(OperatorFile, ReadsLinesWhenTheyAreWhole) {
  const std::string path = ::testing::TempDir() + "snug-operator-lines";
  std::ofstream file(path, std::ios::trunc);
  file << "# what I want\nBOX027 ho" << std::flush;
  std::string warned;
  OperatorFile lines(path, {"BOX027", "BOX028"}, [&](const std::string& text) { warned += text; });
  EXPECT_TRUE(lines.read().orders.empty());
  file << "ld\nBOX29 skip\nBOX028 jump\nnext go\n" << std::flush;
  const OperatorOrders said = lines.read();
  ASSERT_EQ(said.orders.size(), 2U);
  EXPECT_FALSE(said.is_over);
  EXPECT_EQ(said.orders[0], (OperatorOrder{2, "BOX027", OperatorAction::Hold, 0, ""}));
  EXPECT_EQ(said.orders[1].line, 5);
  EXPECT_NE(warned.find(":3"), std::string::npos) << warned;
  EXPECT_NE(warned.find("'BOX027'"), std::string::npos) << "the nearest: " << warned;
  EXPECT_NE(warned.find(":4"), std::string::npos) << warned;
}

TEST(OperatorFile, RefusesAtTheStartWhatItCannotUse) {
  EXPECT_THROW(OperatorFile("/nowhere/at/all", {}, {}), InputError);
  EXPECT_THROW(OperatorFile("/", {}, {}), InputError);
  const std::string path = ::testing::TempDir() + "snug-operator-bad";
  std::ofstream(path, std::ios::trunc) << "\nBOX9 skip\n";
  try {
    OperatorFile(path, {"BOX1"}, {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.where, path + ":2");
    EXPECT_EQ(error.expected, "'BOX1'");
  }
}

TEST(Operator, WhoSaysNothingChangesNothing) {
  const Told silent = pack({});
  ScriptedPlant plant;
  plant.passes = true;
  const SessionResult alone = session::pack(two_boxes(), "1", quick_options(), plant);
  EXPECT_EQ(motion::format_program(silent.result.program), motion::format_program(alone.program));
  EXPECT_EQ(silent.result.plan, alone.plan);
  EXPECT_EQ(silent.brought_on_the_way, plant.brought_on_the_way);
}

TEST(Operator, SkipsAnItem) {
  for (const char* at : {"BOX027 skip", "next skip"}) {
    const Told told = pack({at});
    ASSERT_EQ(told.result.items.size(), 2U) << at;
    EXPECT_EQ(told.result.items[0].end, ItemEnd::Skipped);
    EXPECT_EQ(told.result.items[0].reason, "by the operator");
    EXPECT_TRUE(told.result.items[0].sends.empty());
    ASSERT_EQ(told.result.items[0].operator_steps.size(), 1U);
    EXPECT_EQ(told.result.items[0].operator_steps[0].order, "BOX027 skip");
    EXPECT_EQ(told.result.items[1].end, ItemEnd::Placed);
    EXPECT_EQ(told.result.plan.size(), 1U);
    EXPECT_FALSE(told.result.percent_before_skips.has_value()) << "no place was missing";
  }
}

TEST(Operator, ChoosesACandidateOfTheDecision) {
  const Told alone = pack({});
  std::vector<planning::Tried> tried;
  for (const SessionEvent& one : alone.log.events) {
    const auto* planned = std::get_if<event::Planned>(&one);
    if (planned != nullptr && tried.empty()) tried = planned->tried;
  }
  ASSERT_GE(tried.size(), 2U);
  const Told other = pack({"BOX027 elsewhere"});
  const ItemReport& item = other.result.items[0];
  ASSERT_FALSE(item.sends.empty());
  EXPECT_NE(item.planned, alone.result.items[0].planned);
  EXPECT_EQ(item.operator_steps.size(), 1U);
  // The place that is said is the candidate's: the one that is planned may be pressed in by some mm, or the other end
  // up. Of candidates at one place the first has the most utility.
  const auto chosen = std::ranges::find_if(tried, [&](const planning::Tried& one) {
    const Vector3 p = 1e3 * one.planned.X_TP.p;
    return item.operator_steps[0].text == fmt::format("({:.0f}, {:.0f}, {:.0f}) mm is planned", p.x(), p.y(), p.z());
  });
  ASSERT_NE(chosen, tried.end()) << item.operator_steps[0].text;
  const auto number = chosen - tried.begin() + 1;
  const Told by_number = pack({"BOX027 place " + std::to_string(number)});
  EXPECT_EQ(motion::format_program(by_number.result.program), motion::format_program(other.result.program));
}

TEST(Operator, IsToldWhyAnOrderIsNotFollowed) {
  const Told told = pack({"BOX027 place 999", "BOX027 go", "BOX027 take-out BOX028", "BOX028 take-out BOX028"});
  const auto& steps = told.result.items[0].operator_steps;
  ASSERT_EQ(steps.size(), 3U);
  for (const OperatorStep& one : steps) EXPECT_FALSE(one.was_followed || one.text.empty()) << one.order;
  EXPECT_EQ(steps[0].text, "it is not packed") << "before the item comes";
  EXPECT_NE(steps[1].text.find("candidates"), std::string::npos);
  ASSERT_EQ(told.result.items[1].operator_steps.size(), 1U);
  EXPECT_EQ(told.result.items[1].operator_steps[0].text, "it is not packed");
  EXPECT_EQ(told.result.plan.size(), 2U);
}

TEST(Operator, HoldsTheSessionUntilALineSaysWhatToDo) {
  OperatorOrders orders;
  orders.orders.push_back(*parse_operator_order("next hold", "said", 1));
  int asked = 0;
  SessionOptions options = quick_options();
  options.operator_orders = [&] {
    if (++asked == 3) orders.orders.push_back(*parse_operator_order("next go", "said", 2));
    return orders;
  };
  ScriptedPlant plant;
  const SessionResult result = session::pack(two_boxes(), "1", options, plant);
  EXPECT_EQ(result.items[0].end, ItemEnd::Placed);
  EXPECT_EQ(result.items[0].operator_steps.size(), 2U);
  EXPECT_GE(asked, 3);
  EXPECT_EQ(result.plan.size(), 2U);
}

TEST(Operator, AHeldSessionCanBeInterrupted) {
  OperatorOrders orders;
  orders.orders.push_back(*parse_operator_order("next hold", "said", 1));
  SessionOptions options = quick_options();
  int asked = 0;
  options.operator_orders = [&] { return ++asked, orders; };
  options.is_interrupted = [&] { return asked > 1; };
  ScriptedPlant plant;
  const SessionResult result = session::pack(two_boxes(), "1", options, plant);
  EXPECT_EQ(result.stop_reason, StopReason::Interrupted);
  EXPECT_TRUE(result.plan.empty());
}

TEST(Operator, TakesABoxOutBeforeTheNextComes) {
  const Told told = pack({"BOX028 take-out BOX027"});
  ASSERT_EQ(told.result.items.size(), 2U);
  EXPECT_TRUE(told.brought_on_the_way.empty()) << "the aligner has to be free";
  EXPECT_EQ(told.result.items[0].end, ItemEnd::TakenOut);
  EXPECT_EQ(told.result.items[0].reason, "by the operator");
  EXPECT_EQ(told.result.items[1].end, ItemEnd::Placed);
  ASSERT_EQ(told.result.plan.size(), 1U);
  EXPECT_EQ(told.result.plan[0].item, "BOX028");
  const bool has_returned = std::ranges::any_of(told.result.program.waypoints, [](const motion::Waypoint& one) {
    return one.item == "BOX027" && one.motion_class == motion::MotionClass::RePick;
  });
  EXPECT_TRUE(has_returned) << "the robot did so";
}

TEST(Operator, TheSameOrdersAtTheSameItemsGiveTheSameBytes) {
  const std::vector<std::string> lines{"next elsewhere", "next take-out BOX027"};
  const Told once = pack(lines), again = pack(lines);
  EXPECT_EQ(motion::format_program(once.result.program), motion::format_program(again.result.program));
  // As the log has them, with their items.
  std::vector<std::string> bound;
  for (const SessionEvent& one : once.log.events) {
    if (const auto* operated = std::get_if<event::Operated>(&one)) bound.push_back(operated->order);
  }
  EXPECT_EQ(bound, (std::vector<std::string>{"BOX027 elsewhere", "BOX028 take-out BOX027"}));
  const Told repeated = pack(bound);
  EXPECT_EQ(motion::format_program(repeated.result.program), motion::format_program(once.result.program));
}

TEST(Operator, WhatWasFollowedBeforeIsNotFollowedAgainByASessionThatGoesOn) {
  const std::vector<std::string> lines{"next skip", "next hold", "next go"};
  EventLog log = pack(lines).log;
  const auto end = std::ranges::find_if(log.events, [](const SessionEvent& one) {
    const auto* started = std::get_if<event::ItemStarted>(&one);
    return started != nullptr && started->item == model::ItemIndex(1);
  });
  log.events.erase(end + 1, log.events.end());
  SessionOptions options = quick_options();
  options.resume = find_resume_point(parse_log(lines_of(log), "log"), "log");
  const Told told = pack(lines, options);
  ASSERT_EQ(told.result.items.size(), 2U);
  EXPECT_EQ(told.result.items[0].end, ItemEnd::Skipped);
  EXPECT_EQ(told.result.items[1].end, ItemEnd::Placed);
  EXPECT_EQ(told.result.items[1].operator_steps.size(), 2U) << "held, and gone on with";
}

}  // namespace
}  // namespace snug::session
