// The words with which several verbs change a scenario: more boxes, another container, a pallet, single keys.
#include "apps/snug/command_line/scenario_options.hpp"

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "snug/robot/load_arm.hpp"

namespace snug::app {

void add_scenario_changes(const Verb& verb, ScenarioChanges& changes) {
  verb.option("--items", changes.items, "FILE", "more boxes and sequences: orders (.csv, .json) or items (.yaml)");
  const OptionRow container = verb.option("--container", changes.container, "NAME|LxWxH",
                                          "container to pack: another one of the scenario, or an open box of these "
                                          "inner sizes in mm in place of the target");
  verb.option("--pallet", changes.pallet, "LxW[xH]",
              "pack a pallet of these sizes in mm, boxes up to H high (default: the depth of the target)")
      .excludes(container);
  verb.option("--set", changes.set, "KEY=VALUE",
              "set a key of the scenario to another value, such as cup.lip_radius=0.03 or "
              "contacts.pairs.box/container.friction=0.1; may be given several times")
      .one_each();
}

NamedFiles files_of(const std::string& file, const ScenarioChanges& changes, const model::Scenario& scenario) {
  NamedFiles files = {{"the scenario", find_scenario(file)}};
  for (const std::string& items : changes.items) files.push_back({"--items", find_shipped(items)});
  if (scenario.robot) files.push_back({"the robot's URDF", robot::urdf_path(scenario)});
  for (const std::filesystem::path& side : scenario.side_files) files.push_back({"a file of the scenario", side});
  return files;
}

model::Scenario load_changed(const std::string& file, const ScenarioChanges& changes) {
  model::Scenario scenario = model::load_changed(find_scenario(file), changes, find_shipped);
  print_warnings(scenario.warnings);
  return scenario;
}

}  // namespace snug::app
