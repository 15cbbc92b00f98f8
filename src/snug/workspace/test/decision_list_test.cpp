// Decisions of a log: candidates, why others lost, predicted against what happened, and where boxes stand.
#include "snug/workspace/decision_list.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "snug/core/input_error.hpp"
#include "snug/session/event_log.hpp"

namespace snug::workspace {
namespace {

using Json = nlohmann::json;
using namespace session;  // NOLINT(google-build-using-namespace): events

std::string log_of(const std::vector<SessionEvent>& events) {
  std::string text;
  for (const SessionEvent& one : events) text += format_event(one) + "\n";
  return text;
}

std::vector<SessionEvent> one_box() {
  event::SessionStarted started{"mine", "margin", "a plant", {model::ParcelId("<b>A"), model::ParcelId("B")},
                                false,  {}};
  const model::ItemIndex item(0);
  event::Planned planned;
  planned.item = item;
  planned.outcome = planning::PlanOutcome::Found;
  planned.tried.resize(3);
  planned.tried[0].verdict = planning::Verdict::Failed;
  planned.tried[0].reason = "it leans";
  planned.tried[1].verdict = planning::Verdict::Best;
  planned.tried[1].planned.X_TP.p = Vector3(0.01, 0.02, 0.05);
  planned.planned = planned.tried[1].planned;
  planned.predicted.force = 12.0;
  event::Operated held{1.0, item, 1, "A hold", true, ""};
  event::MotionEnded ended;
  ended.item = item;
  ended.peak_force = 20.0;
  event::Assessed assessed;
  assessed.item = item;
  assessed.position_error = 0.003;
  event::Counted counted{
      4.0, 10.0, {}, {{item, Pose{Matrix3::Identity(), Vector3(0.1, 0.2, 0.3)}, Vector3(0.2, 0.1, 0.05)}}};
  return {started,
          event::ItemStarted{0.5, item, {}},
          planned,
          held,
          event::Sent{2.0, item, 0.9, {}, false},
          ended,
          assessed,
          event::ItemEnded{3.0, item, ItemEnd::Placed, ""},
          counted};
}

TEST(DecisionList, PutsWhatHappenedBesideWhatWasPredicted) {
  const Json json = Json::parse(format_decisions(log_of(one_box()), "log"));
  ASSERT_EQ(json["decisions"].size(), 1U);
  const Json& one = json["decisions"][0];
  EXPECT_EQ(one["item"], "<b>A");
  EXPECT_EQ(one["candidates"].size(), 3U);
  EXPECT_EQ(one["candidates"][0]["verdict"], "failed");
  EXPECT_EQ(one["candidates"][0]["reason"], "it leans");
  EXPECT_NEAR(one["planned"]["position_mm"][1].get<double>(), 20.0, 1e-9);
  EXPECT_EQ(one["predicted"]["force_N"], 12.0);
  EXPECT_EQ(one["happened"]["force_N"], 20.0);
  EXPECT_NEAR(one["happened"]["position_error_mm"].get<double>(), 3.0, 1e-9);
  EXPECT_EQ(one["end"], "placed");
  EXPECT_EQ(one["operator"][0]["order"], "A hold");
  EXPECT_EQ(json["held"], "");
  EXPECT_NEAR(json["standing"][0]["extent_mm"][0].get<double>(), 200.0, 1e-9);
}

TEST(DecisionList, SaysWhichItemIsHeld) {
  std::vector<SessionEvent> events = one_box();
  events.resize(4);
  const Json json = Json::parse(format_decisions(log_of(events), "log"));
  EXPECT_EQ(json["held"], "<b>A");
  EXPECT_EQ(json["now"], "<b>A");
  EXPECT_TRUE(json["decisions"][0]["happened"].is_null());
}

TEST(DecisionList, RefusesWhatIsNoLogAndLeavesOutABrokenEnd) {
  EXPECT_THROW((void)format_decisions("nonsense\n", "log"), InputError);
  EXPECT_EQ(Json::parse(format_decisions(log_of(one_box()) + "{\"event\":\"plan", "log"))["decisions"].size(), 1U);
  EXPECT_TRUE(Json::parse(format_decisions("", "log"))["decisions"].empty());
}

}  // namespace
}  // namespace snug::workspace
