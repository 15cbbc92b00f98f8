// cell: where the robot and the aligner of a cell can stand.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/command_line/verbs.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/write_file.hpp"
#include "snug/model/scenario.hpp"
#include "snug/runs/cell_place.hpp"
#include "snug/runs/cell_place_page.hpp"
#include "snug/workspace/arm_edit.hpp"

namespace snug::app {
namespace {

namespace fs = std::filesystem;

struct CellPlaceOptions {
  std::string scenario;
  std::optional<std::string> arm, tool_link;
  std::vector<std::string> keep, with;
  std::optional<std::string> output, page;
  bool json = false;
};

/// Of the file that is written: paths in a scenario go from its folder.
fs::path place_of(const CellPlaceOptions& options, const std::string& cell) {
  if (!options.output) return cell;
  const fs::path here = fs::absolute(cell).parent_path(), there = fs::absolute(*options.output).parent_path();
  if (fs::weakly_canonical(here) != fs::weakly_canonical(there))
    throw InputError("command line", "-o", *options.output,
                     "a file in the folder of " + cell + ", from which its paths go");
  return *options.output;
}

int run_cell_place(const CellPlaceOptions& options) {
  const std::string cell = find_shipped(options.scenario);
  NamedFiles inputs = {{"scenario", cell}};
  add_file(inputs, "--arm", options.arm);
  NamedFiles outputs;
  add_file(outputs, "-o", options.output);
  add_file(outputs, "--page", options.page);
  expect_distinct(inputs, outputs);
  if (options.tool_link && !options.arm)
    throw InputError("command line", "--tool-link", "without --arm", "the arm that has the link");
  const fs::path place = place_of(options, cell);
  std::string text = read_file(cell, "a scenario file");
  if (options.arm) {
    const fs::path folder = fs::absolute(place).parent_path();
    text = workspace::put_arm(text, cell, fs::proximate(fs::absolute(*options.arm), folder).string(),
                              options.tool_link.value_or(""), *options.arm);
  }
  const model::Scenario scenario = model::parse_scenario(text, place.string());
  print_robot_warnings(scenario);
  std::optional<OutputFile> output = reserve(options.output), page = reserve(options.page);

  runs::PlaceOptions how;
  how.threads = core_count();
  how.stand_with_robot = options.with;
  for (const std::string& kept : options.keep) {
    if (kept == "robot") how.moves_robot = false;
    if (kept == "height") how.moves_height = false;
    if (kept == "aligner") how.moves_aligner = false;
  }
  const runs::PlaceSearch search = runs::place_cell(scenario, how);
  const bool is_found = !search.places.empty() && search.places.front().missing.empty();
  if (output && !search.places.empty())
    write_file(std::move(*output), write_place(scenario, search.places.front(), how));
  if (page) write_file(std::move(*page), make_place_page(scenario, search, how));
  print(options.json ? format_json(search) : format_table(search));
  return is_found ? kSuccess : kRunFailed;
}

constexpr const char* kPlaceHelp =
    R"(place searches places of the robot's base and of the aligner from which the tool, pointing down, reaches what packing needs:
the container from its floor to above its rim, and the picks, also with the tool turned by a quarter. It finds places by the
reach of the arm alone, then tests the best, a dozen or more, pose by pose with everything that stands in the cell. -o writes the
best one: it changes base, aligner, start and posture, and keeps comments and everything else. Container and bodies stay,
except the bodies that --with names. Exit code 1: no place reaches everything.
Examples:
  snug cell place scenarios/init/ur.yaml --with plinth --page places.html
  snug cell place scenarios/init/ur.yaml --keep height --json
  snug cell place scenarios/init/cell.yaml --arm scenarios/robots/ur5e.urdf --tool-link E --page places.html
--arm first puts another robot into the cell: the URDF as its maker publishes it, with the gripper of the scenario on the link.)";

}  // namespace

void add_cell(CLI::App& app, Action& action) {
  const Verb verb(app, action, "cell", "find where robot and aligner of a cell can stand");
  const Verb part = verb.part("place", "find where robot and aligner can stand", kPlaceHelp);
  CellPlaceOptions& options = part.runs(run_cell_place);
  part.option("scenario", options.scenario, "SCENARIO.yaml", "scenario file, or name of one that comes with snug")
      .required();
  part.option("--arm", options.arm, "FILE.urdf", "arm to put into the cell, instead of the scenario's");
  part.option("--tool-link", options.tool_link, "NAME",
              "link of that arm that carries the gripper (default: tool0 or a similar name, else the last link)");
  part.option("--keep", options.keep, "NAME", "what does not move; may be given several times",
              one_of({"robot", "height", "aligner"}))
      .one_each();
  part.option("--with", options.with, "BODY", "a static body that moves with the base; may be given several times")
      .one_each();
  part.option("-o,--output", options.output, "FILE.yaml",
              "write the scenario with the best place, into the folder of the other");
  part.option("--page", options.page, "FILE.html", "write a page with the places and a map of the best");
  add_json(part, options.json);
}

}  // namespace snug::app
