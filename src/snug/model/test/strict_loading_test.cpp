// Strict loading: each way to get a scenario wrong is met by the line, the key and what would have been right.
#include <gtest/gtest.h>

#include <numbers>

#include "scenario_text.hpp"
#include "snug/model/yaml_limits.hpp"

namespace snug::model {
namespace {

using test::Complaint;
using test::expect_complaint;
using test::replaced;

const std::string kText = R"(name: small
gravity: [0, 0, -9.81]
time_step: 0.001
solver:
  tolerance: 1.0e-5
  sleep: {enabled: true}
materials:
  - {name: box}
  - {name: wood, density: 620}
contacts:
  pairs:
    - {between: [box, box], friction: 0.2, restitution: 0.05}
    - {between: [box, wood], friction: 0.15, restitution: 0.1}
frames:
  - {name: T, pose: {position: [1, 0, 0]}}
parcel_types:
  - {name: B1, size: [0.2, 0.3, 0.1], mass: 0.5}
parcels:
  - id: BOX1
    type: B1
    material: box
    inertia: [0.002, 0.003, 0.004]
    com: [0, 0, -0.03]
  - id: BOX2
    type: B1
    material: box
    shell: {mass: 0.1, thickness: 0.001}
    layers:
      - {material: wood, size: [0.19, 0.29, 0.01], z: -0.04}
containers:
  - name: tote
    pose: {frame: T}
    inner_size: [0.4, 0.6, 0.25]
    material: wood
bodies:
  - name: table
    kind: static
    material: wood
    size: [1, 1, 0.1]
    pose: {position: [-1, 0, -0.05]}
  - name: cube
    material: box
    size: [0.1, 0.1, 0.1]
    mass: 2
    pose: {position: [-1, 0, 0.05], yaw_deg: 30}
cup:
  stiffness: {lateral: 2500, axial: 6000, bend: 5, torsion: 3, coupling: 10}
sequences:
  - name: first
    items:
      - {parcel: BOX1, up: Z}
      - {parcel: BOX2, up: X, yaw_deg: 90}
)";

TEST(StrictLoading, AcceptsTheUnchangedText) {
  const Scenario scenario = parse_scenario(kText, "test.yaml");
  EXPECT_EQ(scenario.name, "small");
  EXPECT_EQ(scenario.source_text, kText);
  EXPECT_EQ(scenario.target, "tote");
  EXPECT_EQ(scenario, parse_scenario(kText, "test.yaml"));
}

TEST(StrictLoading, NamesTheNearestKeyWhenAKeyIsUnknown) {
  expect_complaint(replaced(kText, "time_step", "timestep"),
                   {"timestep:", "timestep", "unknown key", "'time_step' (nearest)"});
  expect_complaint(replaced(kText, "friction: 0.2", "fricton: 0.2"),
                   {"fricton", "contacts.pairs[0].fricton", "unknown key 'fricton'", "'friction'"});
  expect_complaint(replaced(kText, "tolerance:", "tolerence:"),
                   {"tolerence", "solver.tolerence", "unknown key", "'tolerance'"});
  expect_complaint(replaced(kText, "{enabled: true}", "{enabledd: true}"),
                   {"enabledd", "solver.sleep.enabledd", "unknown key", "'enabled'"});
  expect_complaint(replaced(kText, "pose: {frame: T}", "pose: {fraem: T}"),
                   {"fraem", "containers[0].pose.fraem", "unknown key", "'frame'"});
}

TEST(StrictLoading, RefusesAKeyGivenTwice) {
  expect_complaint(replaced(kText, "    type: B1\n    material: box\n    inertia",
                            "    type: B1\n    type: B1\n    material: box\n    inertia"),
                   {"    type: B1\n    material: box\n    inertia", "parcels[0].type", "a second time", "once"});
}

TEST(StrictLoading, NamesARequiredKeyThatIsMissing) {
  expect_complaint(replaced(kText, ", restitution: 0.05", ""),
                   {"friction: 0.2", "contacts.pairs[0].restitution", "nothing", "required"});
  expect_complaint(replaced(kText, "    inner_size: [0.4, 0.6, 0.25]\n", ""),
                   {"name: tote", "containers[0].inner_size", "nothing", "required"});
  expect_complaint(replaced(kText, "    mass: 2\n", ""), {"name: cube", "bodies[1].mass", "nothing", "required"});
}

TEST(StrictLoading, RefusesAWrongTypeOrUnit) {
  expect_complaint(replaced(kText, "time_step: 0.001", "time_step: 1 ms"),
                   {"time_step", "time_step", "'1 ms'", "without unit text"});
  expect_complaint(replaced(kText, "time_step: 0.001", "time_step: \"0.001\""),
                   {"time_step", "time_step", "'0.001'", "number"});
  expect_complaint(replaced(kText, "gravity: [0, 0, -9.81]", "gravity: -9.81"),
                   {"gravity", "gravity", "'-9.81'", "a list of 3 numbers"});
  expect_complaint(replaced(kText, "{enabled: true}", "{enabled: yes}"),
                   {"enabled: yes", "solver.sleep.enabled", "'yes'", "true or false"});
  expect_complaint(replaced(kText, "kind: static", "kind: statik"),
                   {"statik", "bodies[0].kind", "'statik'", "nearest is 'static'"});
  expect_complaint(replaced(kText, "up: X,", "up: W,"), {"up: W", "sequences[0].items[1].up", "'W'", "one of X Y Z"});
  expect_complaint(replaced(kText, "yaw_deg: 90", "yaw_deg: 45"),
                   {"yaw_deg: 45", "sequences[0].items[1].yaw_deg", "'45'", "90"});
}

TEST(StrictLoading, RefusesNumbersThatAreNotFinite) {
  for (const std::string word : {".nan", "nan", ".inf", "-inf", "1e999", "~"}) {
    SCOPED_TRACE(word);
    expect_complaint(replaced(kText, "mass: 2\n", "mass: " + word + "\n"),
                     {"mass: " + word, "bodies[1].mass", "", "number"});
    expect_complaint(replaced(kText, "com: [0, 0, -0.03]", "com: [0, 0, " + word + "]"),
                     {"com: [0", "parcels[0].com[2]", "", "number"});
  }
}

TEST(StrictLoading, RefusesNegativeAndAbsurdValues) {
  expect_complaint(replaced(kText, "mass: 2\n", "mass: -2\n"), {"mass: -2", "bodies[1].mass", "'-2'", "mass in kg"});
  expect_complaint(replaced(kText, "mass: 2\n", "mass: 0\n"), {"mass: 0\n", "bodies[1].mass", "'0'", "mass in kg"});
  expect_complaint(replaced(kText, "friction: 0.2", "friction: -0.2"),
                   {"-0.2", "contacts.pairs[0].friction", "'-0.2'", ">= 0"});
  expect_complaint(replaced(kText, "restitution: 0.05", "restitution: 1.5"),
                   {"1.5", "contacts.pairs[0].restitution", "'1.5'", "0 to 1"});
  expect_complaint(replaced(kText, "size: [0.2, 0.3, 0.1]", "size: [200, 300, 100]"),
                   {"[200", "parcel_types[0].size[0]", "'200'", "a size in metres"});
  expect_complaint(replaced(kText, "size: [0.1, 0.1, 0.1]", "size: [0.1, 0, 0.1]"),
                   {"[0.1, 0,", "bodies[1].size[1]", "'0'", "a size in metres"});
  expect_complaint(replaced(kText, "position: [1, 0, 0]", "position: [1, 0, 1e6]"),
                   {"1e6", "frames[0].pose.position[2]", "'1e6'", "metres"});
  expect_complaint(replaced(kText, "coupling: 10", "coupling: 120"),
                   {"lateral: 2500", "cup", "coupling 120", "coupling^2"});
}

TEST(StrictLoading, RefusesAnInertiaThatNoBodyHas) {
  expect_complaint(replaced(kText, "[0.002, 0.003, 0.004]", "[0.002, 0.003, 0.006]"),
                   {"0.006]", "parcels[0].inertia", "0.006", "triangle inequality"});
  expect_complaint(replaced(kText, "[0.002, 0.003, 0.004]", "[0.002, 0.003, 0.004, 0.0, 0.0035, 0.0]"),
                   {"0.0035", "parcels[0].inertia", "principal moments", "positive definite"});
  expect_complaint(replaced(kText, "[0.002, 0.003, 0.004]", "[0.002, -0.003, 0.004]"),
                   {"-0.003", "parcels[0].inertia[1]", "'-0.003'", "> 0"});
}

TEST(StrictLoading, AcceptsAFlatPlateWhoseInertiaMeetsTheTriangleInequalityWithEquality) {
  EXPECT_NO_THROW((void)parse_scenario(replaced(kText, "[0.002, 0.003, 0.004]", "[0.002, 0.003, 0.005]"), "test.yaml"));
}

TEST(StrictLoading, RefusesACentreOfMassOrALayerOutsideTheBox) {
  expect_complaint(replaced(kText, "com: [0, 0, -0.03]", "com: [0, 0, -0.06]"),
                   {"-0.06", "parcels[0].com", "", "inside the box"});
  expect_complaint(replaced(kText, "z: -0.04}", "z: -0.0451}"),
                   {"-0.0451", "parcels[1].layers[0]", "sticks out", "inside the box"});
}

TEST(StrictLoading, ReportsStaticBodiesThatOverlapWithNamesAndDepth) {
  const std::string shelf = R"(  - name: shelf
    kind: static
    material: wood
    size: [1, 1, 0.1]
    pose: {position: [-1, 0, -0.148]}
  - name: cube
)";
  const std::string text = replaced(kText, "  - name: cube\n", shelf);
  expect_complaint(text, {"name: shelf", "bodies[1]", "'shelf' overlaps 'table' by 2 mm", "touch at most"});
  EXPECT_NO_THROW((void)parse_scenario(replaced(text, "-0.148", "-0.15"), "test.yaml"));  // flush
  expect_complaint(replaced(kText, "pose: {position: [-1, 0, -0.05]}", "pose: {position: [0.299, 0, 0.10]}"),
                   {"name: table", "bodies[0]", "'table' overlaps 'tote' by 9 mm", "touch at most"});
}

TEST(StrictLoading, ReportsABodyThatStartsDeepInAnother) {
  // 2 mm: refused; 0.5 mm: left to the contact solver.
  expect_complaint(replaced(kText, "[-1, 0, 0.05], yaw", "[-1, 0, 0.048], yaw"),
                   {"name: cube", "bodies[1]", "'cube' overlaps 'table' by 2 mm", "no deeper than 1 mm"});
  EXPECT_NO_THROW((void)parse_scenario(replaced(kText, "[-1, 0, 0.05], yaw", "[-1, 0, 0.0495], yaw"), "test.yaml"));
}

TEST(StrictLoading, RefusesABoxThatFitsTheContainerInNoOrientation) {
  // Turned on its side 0.61 m exceeds the longest inner edge of 0.6 m; 0.59 m fits along it.
  const std::string text = replaced(kText, "    inertia: [0.002", "    size: [0.1, 0.1, 0.61]\n    inertia: [0.002");
  expect_complaint(text, {"id: BOX1", "parcels[0]", "'BOX1' of 100 x 100 x 610 mm", "'tote' of 400 x 600 x 250 mm"});
  EXPECT_NO_THROW((void)parse_scenario(replaced(text, "0.61", "0.59"), "test.yaml"));
}

TEST(StrictLoading, RefusesNamesUsedTwice) {
  expect_complaint(replaced(kText, "{name: wood, density", "{name: box, density"),
                   {"density", "materials[1].name", "'box' a second time", "no other material"});
  expect_complaint(replaced(kText, "  - id: BOX2\n    type", "  - type"),
                   {"  - type", "parcels[1].id", "nothing", "required"});
  expect_complaint(replaced(kText, "id: BOX2", "id: BOX1 # again"),
                   {"# again", "parcels[1].id", "'BOX1' a second time", "no other parcel"});
  expect_complaint(replaced(kText, "name: cube", "name: tote # again"),
                   {"# again", "bodies[1].name", "'tote' a second time", "no other body or container"});
  expect_complaint(replaced(kText, "between: [box, wood]", "between: [box, box]"),
                   {"friction: 0.15", "contacts.pairs[1].between", "a second time", "each pair once"});
  expect_complaint(replaced(kText, "{parcel: BOX2, up: X", "{parcel: BOX1, up: X"),
                   {"up: X", "sequences[0].items[1]", "'BOX1' a second time", "once in a sequence"});
}

TEST(StrictLoading, RefusesAnIdThatAProgramCouldNotHold) {
  expect_complaint(replaced(kText, "id: BOX2", "id: 'BOX,2'"), {"BOX,2", "parcels[1].id", "'BOX,2'", "without commas"});
}

TEST(StrictLoading, ReadsWhatOthersReachedStrictly) {
  const auto with = [](const std::string& rows) {
    return replaced(kText, "  - name: first\n", "  - name: first\n" + rows);
  };
  const Scenario scenario = parse_scenario(
      with("    reported:\n      - {agent: one, packed_count: 2}\n      - {agent: two, filling_percent: 70.5}\n"), "t");
  const std::vector<Reported>& reported = scenario.sequences[0].reported;
  ASSERT_EQ(reported.size(), 2U);
  EXPECT_EQ(reported[0], (Reported{"one", 2, std::nullopt}));
  EXPECT_EQ(reported[1], (Reported{"two", std::nullopt, 70.5}));
  EXPECT_EQ(first_parcels(scenario.sequences[0], 1), std::vector<std::string>{"BOX1"});
  // Files from before there was a list.
  const Scenario old = parse_scenario(with("    packed_count: 1\n    reported_filling_percent: 60\n"), "t");
  ASSERT_EQ(old.sequences[0].reported.size(), 1U);
  EXPECT_EQ(old.sequences[0].reported[0], (Reported{"the report", 1, 60.0}));

  const std::string at = "sequences[0].reported";
  expect_complaint(with("    reported: [{agent: one}]\n"), {"{agent: one}", at + "[0]", "neither", "at least one"});
  expect_complaint(with("    reported: [{packed_count: 2}]\n"),
                   {"{packed_count", at + "[0].agent", "nothing", "required"});
  expect_complaint(with("    reported: [{agent: one, packed_count: 3}]\n"),
                   {"packed_count", at + "[0].packed_count", "'3'", "0 to 2"});
  expect_complaint(with("    reported: [{agent: one, filling_percent: 101}]\n"),
                   {"filling_percent", at + "[0].filling_percent", "'101'", "a percentage"});
  expect_complaint(with("    reported: [{agent: one, boxes: 2}]\n"), {"boxes", at + "[0].boxes", "unknown key", ""});
  expect_complaint(with("    reported: [{agent: one, packed_count: 1}, {agent: one, packed_count: 2}]\n"),
                   {"reported:", at + "[1].agent", "a second time", ""});
  expect_complaint(with("    packed_count: 1\n    reported: [{agent: one, packed_count: 2}]\n"),
                   {"    packed_count: 1", "sequences[0].packed_count", "both", "one of the two"});
}

TEST(StrictLoading, RefusesNamesOfNothing) {
  expect_complaint(replaced(kText, "{parcel: BOX2, up: X", "{parcel: BOX3, up: X"),
                   {"BOX3", "sequences[0].items[1].parcel", "'BOX3'", "'BOX1' (nearest)"});
  expect_complaint(replaced(kText, "between: [box, wood]", "between: [box, woood]"),
                   {"woood", "contacts.pairs[1].between[1]", "'woood'", "'wood' (nearest)"});
  expect_complaint(replaced(kText, "{frame: T}", "{frame: U}"),
                   {"frame: U", "containers[0].pose.frame", "'U'", "defined are T"});
  expect_complaint(kText + "target: toat\n", {"toat", "target", "'toat'", "'tote' (nearest)"});
}

TEST(StrictLoading, RefusesAPairOfMaterialsThatCanMeetWithoutContactParameters) {
  const std::string pair = "    - {between: [box, wood], friction: 0.15, restitution: 0.1}\n";
  const std::string without = replaced(kText, pair, "");
  expect_complaint(without, {"  pairs:", "contacts", "'box' on 'wood'", "a pair between them, or a default"});
  const std::string covered = replaced(without, "  pairs:\n", "  default: {friction: 0.3, restitution: 0}\n  pairs:\n");
  const Scenario scenario = parse_scenario(covered, "test.yaml");
  EXPECT_EQ(find_contact(scenario, {1}, {0}).value().friction, 0.3);
  EXPECT_EQ(find_contact(scenario, {0}, {0}).value().friction, 0.2);
}

TEST(StrictLoading, RefusesContradictions) {
  expect_complaint(replaced(kText, "yaw_deg: 30}", "yaw_deg: 30, rpy_deg: [0, 0, 30]}"),
                   {"rpy_deg", "bodies[1].pose.rpy_deg", "both", "one of the two"});
  expect_complaint(replaced(kText, "yaw_deg: 30}", "quat_wxyz: [1, 1, 0, 0]}"),
                   {"quat_wxyz", "bodies[1].pose.quat_wxyz", "norm", "norm 1"});
  expect_complaint(replaced(kText, "    mass: 2\n", "    mass: 2\n    shapes: []\n"),
                   {"shapes: []", "bodies[1].shapes", "'size' and 'shapes'", "only one of"});
  expect_complaint(replaced(kText, "    kind: static\n", "    kind: static\n    mass: 3\n"),
                   {"mass: 3", "bodies[0].mass", "", "only dynamic bodies"});
  expect_complaint(replaced(kText, "    kind: static\n", "    kind: static\n    twist: {linear: [1, 0, 0]}\n"),
                   {"twist", "bodies[0].twist", "", "never moves"});
  expect_complaint(replaced(kText, "friction: 0.2,", "friction: 0.2, damping: 5,"),
                   {"damping: 5", "contacts.pairs[0].damping", "", "stiffness"});
  expect_complaint(replaced(kText, "{material: wood, size: [0.19", "{material: box, size: [0.19"),
                   {"[0.19", "parcels[1].layers[0].material", "'box'", "density"});
}

TEST(StrictLoading, ReadsHullsAndCapsulesAndRefusesFlatOnes) {
  const std::string text = replaced(kText, "    size: [0.1, 0.1, 0.1]\n",
                                    "    shapes:\n"
                                    "      - {hull: [[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]}\n"
                                    "      - {capsule: {length: 0.1, radius: 0.02}, pose: {position: [0, 0, 0.2]}}\n");
  const Scenario scenario = parse_scenario(text, "test.yaml");
  const Body& body = *find_body(scenario, "cube");
  ASSERT_EQ(body.shapes.size(), 2u);
  EXPECT_EQ(std::get<geometry::ConvexHull>(body.shapes[0].shape).faces.size(), 4u);
  EXPECT_EQ(std::get<geometry::Capsule>(body.shapes[1].shape), (geometry::Capsule{0.05, 0.02}));
  expect_complaint(replaced(text, "[0, 0, 0.1]]", "[0.1, 0.1, 0]]"),
                   {"hull:", "bodies[1].shapes[0].hull", "one plane", "span a volume"});
  expect_complaint(replaced(text, "radius: 0.02", "radius: 0"),
                   {"radius: 0", "bodies[1].shapes[1].capsule.radius", "'0'", "a size in metres"});
  expect_complaint(replaced(text, "{hull: [[0", "{box: [1, 1, 1], hull: [[0"),
                   {"hull:", "bodies[1].shapes[0].hull", "'box' and 'hull'", "only one of"});
}

TEST(StrictLoading, ReportsWhatIsNotYaml) {
  const auto error_of = [](const std::string& text) {
    try {
      (void)parse_scenario(text, "test.yaml");
    } catch (const InputError& error) {
      return error;
    }
    return InputError("no error", "", "", "");
  };
  EXPECT_EQ(error_of("name: a\nsolver: {tolerance: [1\n").where.substr(0, 10), "test.yaml:");
  EXPECT_EQ(error_of("name: a\n\tb: 1\n").where, "test.yaml:2");
  EXPECT_EQ(error_of("").where, "test.yaml:1");
  EXPECT_EQ(error_of("just words").expected, "a mapping");
  EXPECT_EQ(error_of("- 1\n- 2\n").got, "a list of 2");
  EXPECT_EQ(error_of("name: a\n---\nname: b\n").where, "test.yaml:2");
  EXPECT_EQ(error_of("name: a\n]\nseed: 1\n").where, "test.yaml:2");            // YAML::Load would drop the rest
  EXPECT_EQ(error_of(",ame: a\nseed: 1\n").where.substr(0, 10), "test.yaml:");  // YAML::LoadAll would not return
  EXPECT_EQ(error_of("? [a, b]\n: 1\n").expected, "a key in words");
}

TEST(StrictLoading, ReportsAFileThatIsNotThere) {
  EXPECT_THROW((void)load_scenario("/nowhere/at/all.yaml"), InputError);
  EXPECT_THROW((void)load_scenario(test::project_file("scenarios")), InputError);
}

TEST(StrictLoading, HoldsSkillsAndSettingsOfSessionsToTheirRanges) {
  const auto with = [](const std::string& text) { return "materials: [{name: floor}]\n" + text; };
  const Scenario scenario = parse_scenario(
      with("skills: {insertion: {overtravel: 0.004, tilted: {push: 0.002}}}\n"
           "packing: {planned_interference: 0.002, last_interference: 0.003}\nplace_limits: {force: 120, tilt_deg: 3}\n"
           "recovery: {skips: 0}\n"),
      "s.yaml");
  EXPECT_EQ(scenario.skills.insertion.overtravel, 0.004);
  EXPECT_EQ(scenario.skills.insertion.tilted.push, 0.002);
  EXPECT_EQ(scenario.skills.insertion.press, settings::InsertionParams().press) << "what is not said stays";
  EXPECT_EQ(scenario.packing.planned_interference, 0.002);
  EXPECT_EQ(scenario.place_limits.force, 120.0);
  EXPECT_NEAR(scenario.place_limits.tilt, 3.0 * std::numbers::pi / 180.0, 1e-15);
  EXPECT_EQ(scenario.recovery.skips, 0);
  for (const char* bad :
       {"skills: {insertion: {overtravel: 0.2}}", "skills: {insertion: {overtravels: 0.004}}",
        "skills: {pivot: {drag: 0.1, dragged: 0.2}}", "skills: {travel: {shortest_swing: 0.7}}",
        "packing: {planned_interference: 0.02}", "packing: {max_flips: 3}", "packing: {max_flips: 0.5}",
        "packing: {seed: 3}", "place_limits: {force: -1}", "place_limits: {tilt_deg: 91}",
        "rehearsal: {good_rate: 0.4}", "rehearsal: {max_attempts: 30}", "belief: {model_error: 0}",
        "recovery: {skips: -1}", "motion_guards: {needed_vacuum: 1.5}"}) {
    EXPECT_THROW((void)parse_scenario(with(bad), "s.yaml"), InputError) << bad;
  }
}

TEST(YamlLimits, LetTenThousandBoxesInAndRefuseShortValuesThatAreAsMany) {
  std::string boxes = "bodies:\n";
  for (int i = 0; i < 10'000; ++i) {
    boxes +=
        "- {name: o" + std::to_string(i) + ", size: [0.1234567890123456, 0.1234567890123456, 0.1234567890123456], ";
    boxes += "material: m, mass: 0.5123456789012345, pose: {position: [0.1234567890123456, 0.1234567890123456, ";
    boxes += "12.34567890123456], rpy_deg: [-12.34567890123456, 12.34567890123456, 1.234567890123456]}}\n";
  }
  EXPECT_NO_THROW(check_yaml(boxes, "boxes.yaml"));
  std::string letters;
  for (int i = 0; i < 240'000; ++i) letters += "- a\n";
  EXPECT_THROW(check_yaml(letters, "letters.yaml"), InputError);
}

}  // namespace
}  // namespace snug::model
