// init: copies a shipped scenario to begin with and says what to do next.
#include "apps/snug/init/init.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/command_line/verbs.hpp"
#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/write_file.hpp"

namespace snug::app {
namespace {

namespace fs = std::filesystem;

constexpr std::array kKinds = {
    InitKind{"cell", "a packing cell: tote, aligner, tool with suction cup, boxes in a sequence",
             "snug pack cell.yaml --sequence first --program program.csv -o run.h5\n"
             "snug report run.h5 -o run.html\n"},
    InitKind{"pallet", "the same with a pallet in the place of the tote: boxes stand free, layer on layer",
             "snug pack pallet.yaml --sequence first --program program.csv -o run.h5\n"
             "snug report run.h5 -o run.html\n"},
    InitKind{"ur", "a UR5e and a small tote",
             "snug pack ur.yaml --sequence first --program program.csv -o run.h5\n"
             "snug report run.h5 -o run.html\n",
             "ur5e"},
    InitKind{"gantry", "a gantry over a pallet",
             "snug pack gantry.yaml --sequence first --program program.csv -o run.h5\n"
             "snug report run.h5 -o run.html\n",
             "gantry"},
    InitKind{"scene", "bodies, contacts and forces alone, without robot or packing",
             "snug simulate scene.yaml -o run.h5\n"
             "snug report run.h5 -o run.html\n"},
};

struct InitOptions {
  std::string kind;    ///< name of an InitKind
  std::string folder;  ///< to write into; made when it is not there
};

void require_free(const fs::path& file) {
  std::error_code error;
  if (fs::exists(fs::symlink_status(file, error)))
    throw InputError(file.string(), "", "an existing file, which is not overwritten", "another folder");
}

int run_init(const InitOptions& options) {
  const auto kind = std::ranges::find_if(kKinds, [&](const InitKind& known) { return options.kind == known.name; });
  SNUG_CHECK(kind != kKinds.end(), "a kind that the parser accepts");
  const std::string name = options.kind + ".yaml";
  std::string text = read_file(shipped_folder() / "scenarios/init" / name, "a scenario to begin with");
  const fs::path folder = options.folder;
  make_folder("folder", folder);
  const fs::path file = folder / name;
  require_free(file);
  if (*kind->arm != '\0') {
    const std::string arm = kind->arm + std::string(".urdf");
    require_free(folder / arm);
    write_file(OutputFile(folder / arm), read_file(shipped_folder() / "scenarios/robots" / arm, "an arm"));
    const std::string shipped = "../robots/" + arm;
    text.replace(text.find(shipped), shipped.size(), arm);
  }
  write_file(OutputFile(file), text);
  print(fmt::format("{} is written. Next:\n\ncd {}\n{}\nEvery key: docs/scenario.md\n", file.string(), folder.string(),
                    kind->next));
  return kSuccess;
}

constexpr const char* kInitExamples = R"(
Examples:
  snug init cell my-cell
  snug init pallet my-pallet
  snug init ur my-ur-cell
  snug init gantry my-gantry
  snug init scene my-scene)";

}  // namespace

std::span<const InitKind> init_kinds() { return kKinds; }

void add_init(CLI::App& app, Action& action) {
  std::vector<std::string> names;
  std::string footer = "Kinds:\n";
  for (const InitKind& kind : kKinds) {
    names.emplace_back(kind.name);
    footer += fmt::format("  {:<8} {}\n", kind.name, kind.description);
  }
  const Verb verb(app, action, "init", "write a small scenario with comments to begin with", footer + kInitExamples);
  InitOptions& options = verb.runs(run_init);
  verb.option("kind", options.kind, "KIND", "what to write, see below", one_of(names)).required();
  verb.option("folder", options.folder, "DIR", "where to write it; created if missing").required();
}

}  // namespace snug::app
