// ui: a page to work in, served on this machine: scenarios, items and runs of a folder.
#include "apps/snug/ui/ui.hpp"

#include <filesystem>

#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/command_line/stop_signal.hpp"
#include "apps/snug/command_line/version.hpp"
#include "apps/snug/command_line/workspace_page.hpp"
#include "apps/snug/init/init.hpp"
#include "apps/snug/view/view.hpp"
#include "snug/serve/api_server.hpp"
#include "snug/workspace/service.hpp"

namespace snug::app {

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
  announce(server.address(), options.opens_browser);
  server.run();
  return kSuccess;
}

}  // namespace snug::app
