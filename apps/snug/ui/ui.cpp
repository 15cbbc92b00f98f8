// ui: a page to work in, served on this machine: scenarios, items and runs of a folder.
#include <filesystem>

#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/command_line/verbs.hpp"
#include "apps/snug/command_line/version.hpp"
#include "apps/snug/command_line/workspace_page.hpp"
#include "apps/snug/init/init.hpp"
#include "apps/snug/view/view.hpp"
#include "snug/commands/stop_signal.hpp"
#include "snug/serve/api_server.hpp"
#include "snug/workspace/service.hpp"

namespace snug::app {
namespace {

struct UiOptions {
  std::string folder = ".";
  int port = 0;           ///< 0: any that is free
  int runs = 1;           ///< at the same time
  bool is_quiet = false;  ///< opens no browser
};

/// Serves until the program is told to stop (Ctrl-C).
int run_ui(const UiOptions& options) {
  workspace::ServiceSettings settings;
  settings.folder = options.folder;
  settings.program = std::filesystem::read_symlink("/proc/self/exe");
  settings.version = version_text();
  settings.runs_at_once = options.runs;
  for (const InitKind& kind : init_kinds()) {
    const std::string name = kind.name;
    if (name == "scene") continue;  // nothing is packed there
    settings.templates.push_back({name, kind.description, shipped_folder() / "scenarios/init" / (name + ".yaml")});
  }
  settings.templates.push_back({"demonstrator",
                                "a tote cell with a UR10, beside a conveyor: what a robot reaches is shown",
                                shipped_folder() / "scenarios/box-demonstrator.yaml"});
  workspace::Service service(settings);
  serve::ApiServer server(options.port, workspace::kLargestMesh,
                          {{"/", "text/html; charset=utf-8", std::string(workspace_page())},
                           {"/workspace.js", "text/javascript; charset=utf-8", std::string(workspace_script())},
                           {"/workspace.css", "text/css; charset=utf-8", std::string(workspace_style())}},
                          [&](const serve::ApiRequest& request) { return service.answer(request); });
  const StopSignal signal([&] { server.stop(); });
  announce(server.address(), !options.is_quiet);
  server.run();
  return kSuccess;
}

constexpr const char* kUiExamples = R"(Examples:
  snug ui                                            # the folder that you are in
  snug ui . --no-open                                # prints the address only
The folder holds plain files that all other verbs read and write: scenarios (.yaml), orders (.csv), and for each run its
command with its output (.txt), its log (.jsonl), recording (.h5), program (.program.csv) and, while it runs,
frames (.live).
Ctrl-C ends the page and interrupts its runs. Only this machine can open the page, with the printed address and its
token. docs/ui-interface.md has the addresses for other programs.)";

}  // namespace

void add_ui(CLI::App& app, Action& action) {
  const Verb verb(app, action, "ui", "open a page in the browser: edit items and cells, run, compare", kUiExamples);
  UiOptions& options = verb.runs(run_ui);
  verb.option("folder", options.folder, "DIR", "folder of scenarios, items and runs");
  verb.option("--port", options.port, "N", "port to serve at; 0: any free one", whole(0, 65535));
  verb.option("--runs", options.runs, "N", "how many runs at the same time; others wait", whole(1, kMostThreads));
  verb.flag("--no-open", options.is_quiet, "do not open a browser, only print the address");
}

}  // namespace snug::app
