// Belief files: what is read is what was written, and what cannot be is said.
#include "snug/planning/belief_json.hpp"

#include <gtest/gtest.h>

#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/planning/test/believed.hpp"

namespace snug::planning {
namespace {

TEST(BeliefFile, GivesBackTheBelief) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    const PlanRequest request{test::random_belief(seed), model::ItemIndex(1), {0.25, 1}};
    const PlanRequest read = parse_request(format_request(request), "belief.json");
    EXPECT_EQ(read.belief, request.belief);
    EXPECT_EQ(read.item, request.item);
    EXPECT_EQ(read.budget, request.budget);
    EXPECT_EQ(hash(read.belief), hash(request.belief));
    EXPECT_NO_THROW(expect_can_be_saved(request.belief));
  }
}

TEST(BeliefFile, BeliefsThatDifferHaveOtherHashes) {
  const BeliefSnapshot belief = test::random_belief(1);
  const std::uint64_t was = hash(belief);
  const auto changed = [&](const auto& change) {
    BeliefSnapshot other = belief;
    change(other);
    EXPECT_NE(other, belief);
    return hash(other) != was;
  };
  EXPECT_TRUE(changed([](auto& b) { b.robot.X_WE.p.x() += 1e-15; }));
  EXPECT_TRUE(changed([](auto& b) { b.worlds[1].weight *= 1.0 + 1e-15; }));
  EXPECT_TRUE(changed([](auto& b) { b.boxes[0]->covariance(2, 3) += 1e-18; }));
  EXPECT_TRUE(changed([](auto& b) { b.skips_left -= 1; }));
  EXPECT_TRUE(changed([](auto& b) { b.next.reset(); }));
  EXPECT_TRUE(changed([](auto& b) { b.agent.seed += 1; }));
  EXPECT_TRUE(changed([](auto& b) { b.items[0].size.x() += 1e-6; }));
  EXPECT_TRUE(changed([](auto& b) { b.skipped.emplace_back(1); }));
  EXPECT_TRUE(changed([](auto& b) { b.failed.pop_back(); }));
}

TEST(BeliefFile, SaysWhatIsWrong) {
  const std::string good = format_request({test::random_belief(1), model::ItemIndex(1), {}});
  const auto key_of = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    try {
      (void)parse_request(text, "belief.json");
    } catch (const InputError& error) {
      return error.key;
    }
    return std::string("nothing");
  };
  EXPECT_EQ(key_of("\"snug_belief\"", "\"belief_of_another\""), "snug_belief");
  EXPECT_EQ(key_of("\"snug_belief\":1", "\"snug_belief\":2"), "snug_belief");
  EXPECT_EQ(key_of("\"item\":1", "\"item\":7"), "item");
  EXPECT_EQ(key_of("\"skips_left\":", "\"skips_leftt\":"), "belief.skips_left");
  EXPECT_EQ(key_of("\"weight\":1.0", "\"weight\":\"much\""), "belief.worlds.[0].weight");
  EXPECT_EQ(key_of("\"weight\":1.0", "\"weight\":1.5"), "hash") << "it is another belief than the one that was saved";
  EXPECT_EQ(key_of("\"sent\":[0]", "\"sent\":[9]"), "sent");
}

TEST(BeliefFile, AScenarioThatItsTextDoesNotGiveCannotBeSaved) {
  BeliefSnapshot belief = test::random_belief(1);
  belief.scenario.recovery.most_tries += 1;  // the text does not say so
  EXPECT_THROW(expect_can_be_saved(belief), InputError);
  belief.scenario.source_text.clear();
  EXPECT_THROW(expect_can_be_saved(belief), InputError);
}

}  // namespace
}  // namespace snug::planning
