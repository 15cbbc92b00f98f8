// Keys of a scenario set from outside: what changes, what does not, and what is refused.
#include "snug/model/scenario_edit.hpp"

#include <gtest/gtest.h>

#include "scenario_text.hpp"

namespace snug::model {
namespace {

using test::demonstrator;

Scenario with(const std::string& key, const std::string& value) {
  return with_values(demonstrator(), {{key, value}}, "--set");
}

std::string refusal_of(const std::string& key, const std::string& value) {
  try {
    (void)with(key, value);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ScenarioEdit, SetsOneKeyAndLeavesTheRest) {
  const Scenario before = demonstrator();
  Scenario after = with("parcel_clearance", "0.001");
  EXPECT_EQ(after.parcel_clearance, 0.001);
  EXPECT_EQ(after, parse_scenario(after.source_text, after.source_name));
  after.parcel_clearance = before.parcel_clearance;
  after.source_text = before.source_text;
  EXPECT_EQ(after, before);
}

TEST(ScenarioEdit, FindsEntriesOfListsByIdByIndexAndByWhatTheyAreBetween) {
  EXPECT_EQ(find_parcel(with("parcels.BOX013.mass", "0.6"), "BOX013")->inertia.mass, 0.6);
  EXPECT_EQ(with("parcels.0.mass", "0.6").parcels[0].inertia.mass, 0.6);
  EXPECT_EQ(with("parcels[0].mass", "0.6").parcels[0].inertia.mass, 0.6);
  const Scenario slippery = with("contacts.pairs.box/container.friction", "0.05");
  const Scenario same = with("contacts.pairs.1.friction", "0.05");
  EXPECT_EQ(slippery.contact_pairs, same.contact_pairs);
  EXPECT_NE(slippery.contact_pairs, demonstrator().contact_pairs);
}

TEST(ScenarioEdit, AddsAKeyThatTheFileLeavesOut) {
  ASSERT_EQ(demonstrator().solver.max_sweeps, SolverSettings{}.max_sweeps);
  EXPECT_EQ(with("solver.max_sweeps", "77").solver.max_sweeps, 77);
  EXPECT_EQ(with("solver.sleep.time", "0.5").solver.sleep.time, 0.5);
}

TEST(ScenarioEdit, TakesLists) { EXPECT_EQ(with("gravity", "[0.0, 0.0, -1.62]").gravity, Vector3(0.0, 0.0, -1.62)); }

TEST(ScenarioEdit, ChangesOneUserOfAnAliasOnly) {
  const Scenario shared = parse_scenario(
      "name: two\nduration: 1.0\nmaterials: [{name: m}]\ncontacts: {default: {friction: 0.3, restitution: "
      "0.0}}\nbodies:\n"
      "  - {name: a, size: &s [0.1, 0.1, 0.1], mass: 1.0, material: m}\n"
      "  - {name: b, size: *s, mass: 1.0, material: m, pose: {position: [1.0, 0.0, 0.0]}}\n",
      "shared");
  const auto half = [](const Scenario& scenario, std::size_t i) {
    return std::get<geometry::Box>(scenario.bodies[i].shapes.at(0).shape).half;
  };
  ASSERT_EQ(half(shared, 0), half(shared, 1));
  const Scenario changed = with_values(shared, {{"bodies.a.size", "[0.2, 0.1, 0.1]"}}, "--set");
  EXPECT_EQ(half(changed, 1), half(shared, 1));
  EXPECT_EQ(half(changed, 0).x(), 0.1);
}

TEST(ScenarioEdit, RefusesWhatTheReaderRefusesAndNamesTheKey) {
  EXPECT_NE(refusal_of("parcel_clearanc", "0.001").find("parcel_clearance"), std::string::npos);
  const std::string rigid = "contacts.pairs.box/workbench.", soft = "contacts.pairs.box/gripper.";
  EXPECT_NE(refusal_of(rigid + "travel", "0.001").find("travel without stiffness"), std::string::npos);
  EXPECT_NE(refusal_of(rigid + "full_area", "0.005").find("full_area without stiffness"), std::string::npos);
  EXPECT_NE(refusal_of(rigid + "damping_ratio", "0.5").find("damping_ratio without stiffness"), std::string::npos);
  EXPECT_NE(refusal_of(rigid + "edge_friction", "-0.1").find("edge_friction"), std::string::npos);
  EXPECT_EQ(refusal_of(rigid + "edge_friction", "0.1"), "");
  EXPECT_NE(refusal_of(soft + "travel", "0.001").find("both, or neither"), std::string::npos);
  EXPECT_NE(refusal_of(soft + "stiffness_beyond", "1e5").find("both, or neither"), std::string::npos);
  EXPECT_NE(refusal_of(soft + "edge_share", "0.1").find("full_area"), std::string::npos);
  EXPECT_NE(refusal_of("solver.max_sweeps", "-1").find("max_sweeps"), std::string::npos);
  EXPECT_NE(refusal_of("solver.max_sweeps", "nan").find("max_sweeps"), std::string::npos);
  EXPECT_NE(refusal_of("parcels.NOBODY.mass", "1").find("NOBODY"), std::string::npos);
  EXPECT_NE(refusal_of("parcels.999.mass", "1").find("999"), std::string::npos);
  EXPECT_NE(refusal_of("seed.x", "1").find("seed"), std::string::npos);
  for (const char* path :
       {"", ".", "solver..x", "solver.", ".solver", "parcels[0", "parcels[]", "parcels]0", "parcels[0]mass"})
    EXPECT_NE(refusal_of(path, "1").find("keys with dots between"), std::string::npos) << path;
  EXPECT_NE(refusal_of("gravity", "[0, 0"), "");
  EXPECT_NE(refusal_of("gravity", "&a [*a]"), "");
}

TEST(ScenarioEdit, ReadsWordsOfTheCommandLine) {
  EXPECT_EQ(parse_key_value("a.b=c=d", "--set"), KeyValue("a.b", "c=d"));
  EXPECT_THROW((void)parse_key_value("a.b", "--set"), InputError);
  EXPECT_THROW((void)parse_key_value("=1", "--set"), InputError);
}

TEST(WithValues, ReachesSkillsAndSettingsThatTheFileDoesNotName) {
  const Scenario scenario = load_scenario(test::project_file("scenarios/box-demonstrator.yaml"));
  const Scenario changed = with_values(scenario,
                                       {{"skills.insertion.overtravel", "0.004"},
                                        {"skills.insertion.tilted.push", "0.002"},
                                        {"packing.last_interference", "0.002"},
                                        {"place_limits.force", "120"}},
                                       "--set");
  EXPECT_EQ(changed.skills.insertion.overtravel, 0.004);
  EXPECT_EQ(changed.skills.insertion.tilted.push, 0.002);
  EXPECT_EQ(changed.packing.last_interference, 0.002);
  EXPECT_EQ(changed.place_limits.force, 120.0);
  EXPECT_NE(changed.source_text, scenario.source_text) << "what is run is what is written down";
  EXPECT_THROW((void)with_values(scenario, {{"skills.insertion.overtravel", "1"}}, "--set"), InputError);
}

}  // namespace
}  // namespace snug::model
