// ui: what may be said after the verb.
#include "apps/snug/ui/ui.hpp"

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"

namespace snug::app {
namespace {

constexpr const char* kUiExamples = R"(Examples:
  snug ui                                            # the folder that you are in
  snug ui . --no-open                                # prints the address only
The folder holds plain files that all other verbs read and write: scenarios (.yaml), orders (.csv), and of each run its
command with what it printed (.txt), its log (.jsonl), recording (.h5), program (.program.csv) and, while it goes on,
frames (.live).
Ctrl-C ends the page and interrupts its runs. The page is served to this machine only, and to who knows the printed
address with its token. Addresses for other programs: docs/ui.md.)";

}  // namespace

void add_ui(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("ui", "a page to work in: items, cell, runs of a folder, in the browser");
  const auto options = std::make_shared<UiOptions>();
  const auto is_quiet = std::make_shared<bool>(false);
  verb.add_option("folder", options->folder, "where scenarios, items and runs are")
      ->type_name("DIR")
      ->capture_default_str();
  verb.add_option("--port", options->port, "port to serve at; 0 any that is free")
      ->check(whole(0, 65535))
      ->type_name("N")
      ->capture_default_str();
  verb.add_option("--runs", options->runs, "runs at the same time; the others wait")
      ->check(whole(1, kMostThreads))
      ->type_name("N")
      ->capture_default_str();
  verb.add_flag("--no-open", *is_quiet, "open no browser, only say the address");
  verb.footer(kUiExamples);
  verb.callback([options, is_quiet, &action] {
    action = [options, is_quiet] {
      options->opens_browser = !*is_quiet;
      return run_ui(*options);
    };
  });
}

}  // namespace snug::app
