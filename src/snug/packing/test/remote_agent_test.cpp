// Remote agents: what they are asked, what their answers become, and answers of all kinds.
#include "snug/packing/remote_agent.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "snug/core/input_error.hpp"
#include "snug/packing/test/scene.hpp"

namespace snug::packing {
namespace {

using nlohmann::json;
using test::make_box;

/// An agent whose every decision is this text.
std::unique_ptr<Agent> answering(const std::string& answer) {
  return make_agent("mine", {PackingSettings{}, {}, {}, {}, [answer](const std::string& line) {
                               return json::parse(line)["ask"] == "begin" ? std::string("{}") : answer;
                             }});
}

Expected<Decision, NoPlace> decide(const std::string& answer) {
  return answering(answer)->decide(ContainerState{}, make_box("a", Vector3(0.2, 0.1, 0.1)));
}

TEST(RemoteAgent, IsAskedOnceToBeginAndForEveryItem) {
  std::vector<json> asked;
  const auto agent = make_agent(
      "mine", {PackingSettings{}, make_future_model(test::demonstrator()), {}, {}, [&](const std::string& line) {
                 asked.push_back(json::parse(line));
                 return std::string(R"({"places": [0]})");
               }});
  EXPECT_EQ(agent->name(), "mine");
  ContainerState state;
  const std::vector<Item> items = test::shuffled_items(test::demonstrator(), 1);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto decision = agent->decide(state, items[i]);
    ASSERT_TRUE(decision.has_value());
    state = with_candidate(state, items[i], decision->candidates.front());
  }
  ASSERT_EQ(asked.size(), 4U);
  EXPECT_EQ(asked[0]["ask"], "begin");
  EXPECT_EQ(asked[0]["container"]["inner_size"][1], 0.57);
  EXPECT_EQ(asked[0]["future"].size(), test::demonstrator().parcels.size());
  EXPECT_EQ(asked[3]["ask"], "decide");
  EXPECT_EQ(asked[3]["item"]["id"], items[2].id);
  EXPECT_EQ(asked[3]["boxes"].size(), 2U);
  EXPECT_EQ(asked[3]["boxes"][1]["id"], items[1].id);
  EXPECT_GT(asked[3]["candidates"].size(), 3U);
  test::expect_sound(state, PackingSettings().planned_interference, PackingSettings().min_support);
}

TEST(RemoteAgent, PlacesGivenAsNumbersAreLowered) {
  const auto decision = decide(R"({"places": [{"x": 0.01, "y": 0.02, "up": "Z", "yaw_quarter": 1}]})");
  ASSERT_TRUE(decision.has_value());
  const Placement& placement = decision->candidates.front().placement;
  EXPECT_NEAR(placement.X_TP.p.x(), 0.01, 1e-4);
  EXPECT_NEAR(placement.X_TP.p.y(), 0.02, 1e-4);
  EXPECT_NEAR(placement.X_TP.p.z(), 0.05, 1e-4);
  EXPECT_EQ(placement.orientation.yaw_quarter, 1);
}

TEST(RemoteAgent, KeepsTheOrderOfThePlacesAndLeavesOutThoseThatBreakTheRules) {
  const auto decision = decide(R"({"places": [{"x": 5.0, "y": 0.0}, 1, 0]})");
  ASSERT_TRUE(decision.has_value());
  ASSERT_EQ(decision->candidates.size(), 2U);
  EXPECT_GT(decision->candidates[0].score, decision->candidates[1].score);
}

TEST(RemoteAgent, MaySayThatThereIsNoPlace) {
  EXPECT_EQ(decide(R"({"places": []})").error(), NoPlace::NoSpace);
  EXPECT_EQ(decide(R"({"no_place": "full"})").error(), NoPlace::NoSpace);
  EXPECT_EQ(decide(R"({"places": [{"x": 5.0, "y": 0.0}]})").error(), NoPlace::NoSpace);
}

TEST(RemoteAgent, IsNotAskedForWhatIsInfeasible) {
  const auto decision = answering("not asked")->decide(ContainerState{}, make_box("a", Vector3(2.0, 2.0, 2.0)));
  EXPECT_EQ(decision.error(), NoPlace::TooBig);
}

TEST(RemoteAgent, AnswersThatAreNotUnderstoodAreErrors) {
  for (const char* answer :
       {"", "nonsense", "[]", "3", R"({"places": 3})", R"({"places": [-1]})", R"({"places": [100000]})",
        R"({"places": ["a"]})", R"({"places": [{"x": 0}]})", R"({"places": [{"x": "a", "y": 0}]})",
        R"({"places": [{"x": 0, "y": 0, "up": "W"}]})", R"({"places": [{"x": 0, "y": 0, "yaw_quarter": 4}]})",
        R"({"places": [{"x": 0, "y": 0, "up_sign": 2}]})", R"({"places": [1e400]})", R"({"error": "ValueError: x"})"}) {
    SCOPED_TRACE(answer);
    EXPECT_THROW((void)decide(answer), AgentError);
  }
}

TEST(RemoteAgent, PlacesOutOfReachAreLeftOut) {
  AgentInput input{PackingSettings{},
                   {},
                   {},
                   [](const Placement&) { return false; },
                   [](const std::string&) { return std::string(R"({"places": [0]})"); }};
  const auto agent = make_agent("mine", std::move(input));
  EXPECT_EQ(agent->decide(ContainerState{}, make_box("a", Vector3(0.2, 0.1, 0.1))).error(), NoPlace::NotReachable);
}

}  // namespace
}  // namespace snug::packing
