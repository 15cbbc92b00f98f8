// init: what may be said after the verb.
#include "apps/snug/init/init.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"

namespace snug::app {
namespace {

constexpr const char* kInitExamples = R"(
Examples:
  snug init cell my-cell
  snug init pallet my-pallet
  snug init scene my-scene)";

}  // namespace

void add_init(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("init", "write a small scenario with comments to begin with");
  const auto options = std::make_shared<InitOptions>();
  std::vector<std::string> names;
  std::string footer = "Kinds:\n";
  for (const InitKind& kind : init_kinds()) {
    names.emplace_back(kind.name);
    footer += fmt::format("  {:<8} {}\n", kind.name, kind.description);
  }
  verb.add_option("kind", options->kind, "what to begin with, see below")
      ->required()
      ->check(one_of(names))
      ->type_name("KIND");
  verb.add_option("folder", options->folder, "where to write it; made when it is not there")
      ->required()
      ->type_name("DIR");
  verb.footer(footer + kInitExamples);
  verb.callback([options, &action] { action = [options] { return run_init(*options); }; });
}

}  // namespace snug::app
