// serve --ur: the cell as a controller of Universal Robots that any of its clients drives.
#include "apps/snug/serve/serve.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "apps/snug/serve/served_runs.hpp"
#include "snug/commands/stop_signal.hpp"
#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/served_ur/server.hpp"

namespace snug::app {
namespace {

class ServingUr {
 public:
  explicit ServingUr(const ServeOptions& options)
      : options_(options),
        model_(ur::facts_of(ur_model_of(options.ur.model))),
        runs_(options, served_ur::Controller::period_of(model_.model)) {
    served_ur::ControllerSettings settings;
    settings.model = model_.model;
    settings.programs = options.ur.programs;
    if (!settings.programs.empty() && !std::filesystem::is_directory(settings.programs))
      throw InputError("command line", "--ur-programs", settings.programs, "a folder");
    settings.feeds_on_request = options.plant_seed.has_value();  // as plants that are packed
    settings.begin_run = [this](int run) { return runs_.begin(run); };
    settings.end_run = [this](int run, const runs::RunResult& result) {
      runs_.end(run, result);
      if (options_.once) server_->stop();
    };
    controller_.emplace(runs_.simulation(), std::move(settings));
    served_ur::ServerSettings server;
    server.host = *options.ur.host;
    server.port_offset = options.ur.port_offset;
    server.clients = options.ur.clients;
    server.speed = options.server.speed.value_or(1.0);
    server.observers = options.ur.observers;
    server.log = [](const std::string& line) { std::fprintf(stderr, "snug: %s\n", line.c_str()); };
    server_.emplace(*controller_, std::move(server));
  }

  int run() {
    runs_.begin_page();
    const StopSignal signal([this] {
      runs_.release();
      server_->stop();
    });
    const int offset = options_.ur.port_offset;
    const std::string address = *options_.ur.host + (offset != 0 ? ":" + std::to_string(offset) : "");
    std::fprintf(
        stderr,
        "snug: serving %s as a %s at ur://%s, %d Hz: dashboard %d, primary %d, secondary %d, real-time %d, RTDE %d "
        "(Ctrl-C ends it)\n",
        runs_.simulation().scenario().source_name.c_str(), model_.name, address.c_str(), model_.rate, 29999 + offset,
        30001 + offset, 30002 + offset, 30003 + offset, 30004 + offset);
    if (const std::string observers = server_->observers(); !observers.empty())
      std::fprintf(stderr, "snug: observers of the boxes at %s\n", observers.c_str());
    server_->run();
    controller_->end("the server was stopped");
    runs_.end_page();
    print_lateness(server_->pacer());
    return options_.once && runs_.has_failed() ? kRunFailed : kSuccess;
  }

 private:
  const ServeOptions& options_;
  const ur::ModelFacts& model_;
  ServedRuns runs_;
  std::optional<served_ur::Controller> controller_;
  std::optional<served_ur::Server> server_;
};

}  // namespace

ur::Model ur_model_of(const std::string& name) {
  const auto found =
      std::ranges::find(ur::all_models(), name, [](const ur::ModelFacts& one) { return std::string(one.name); });
  SNUG_CHECK(found != ur::all_models().end(), "a model that the options know");
  return found->model;
}

int run_serve_ur(const ServeOptions& options) { return ServingUr(options).run(); }

}  // namespace snug::app
