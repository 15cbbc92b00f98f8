// view: the page of the report, served on this machine: for recordings, or for a simulation that goes on.
#include "apps/snug/view/view.hpp"
#include "apps/snug/command_line/verbs.hpp"

#include <cstdio>
#include <filesystem>
#include <thread>

#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/version.hpp"
#include "apps/snug/command_line/viewer_page.hpp"
#include "apps/snug/common/recordings.hpp"
#include "snug/commands/stop_signal.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/remote_runs/watched_run.hpp"
#include "snug/runs/run_table.hpp"
#include "snug/serve/live_simulation.hpp"

namespace snug::app {
namespace {

int view_recordings(const ViewOptions& options) {
  serve::Content content;
  content.page = viewer_page();
  content.recordings = encode_recordings(options.recordings, options.selection, options.urdf);
  serve::Server server(options.server, std::move(content));
  const StopSignal signal([&] { server.stop(); });
  announce(server.address(), !options.is_quiet);
  server.run();
  return kSuccess;
}

int view_live(const ViewOptions& options) {
  serve::LiveRun live(std::filesystem::path(options.run.scenario).stem().string(), options.speed);
  if (options.is_paused) live.pause();
  model::Scenario scenario = load_with_overrides(options.run);
  runs::RunOptions run = make_run_options(options.run, scenario);
  if (options.run.record) expect_distinct(files_of(options.run, scenario), {{"-o", *options.run.record}});
  std::optional<OutputFile> record = reserve_recording(options.run.record);
  if (record) run.record_file = &*record;
  serve::LiveSimulation simulation(std::move(scenario), std::move(run), live);
  serve::Server server(options.server, {std::string(viewer_page()), {}, &live});
  const StopSignal signal([&] {
    live.stop();
    server.stop();
  });
  simulation.start([&] { server.stop(); });
  while (!live.wait_for(0, std::chrono::milliseconds(200)) && !live.is_over()) continue;  // bad input shows here
  if (!live.is_over() || live.whole_form()) announce(server.address(), !options.is_quiet);
  server.run();
  const runs::RunResult& result = simulation.result();
  print(format_table(result));
  if (!result.failure) return kSuccess;
  std::fprintf(stderr, "snug: failed: %s\n", result.failure.text.c_str());
  return kRunFailed;
}

/// Serves a cell of another program while it is driven, until this one is told to stop (Ctrl-C).
int view_served(const ViewOptions& options) {
  const model::Scenario scenario = load_with_overrides(options.run);
  if (scenario.sequences.empty()) throw InputError(scenario.source_name, "sequences", "", "a sequence of boxes");
  remote_plant::WatchedCell cell(scenario, options.run.sequence.value_or(scenario.sequences.front().name),
                                 *options.click, options.client.patience, click::find_client_keys(options.client.keys));
  serve::LiveRun live(std::filesystem::path(options.run.scenario).stem().string(), 0.0);
  serve::Server server(options.server, {std::string(viewer_page()), {}, &live, true});
  remote_runs::WatchedRun watch(cell, live, version_text(), [&](const std::string& why) { live.finish("", why); });
  const StopSignal signal([&] {
    watch.stop();
    live.stop();
    server.stop();
  });
  std::string trouble;
  std::thread looking([&] {
    trouble = watch.run();
    if (!trouble.empty())
      std::fprintf(stderr, "snug: the cell is seen no more: %s\n", printable(trouble, kLongestMessage).c_str());
  });
  announce(server.address(), !options.is_quiet);
  server.run();
  looking.join();
  return trouble.empty() ? kSuccess : kRunFailed;
}

void check_view_words(const ViewOptions& options) {
  const bool is_live = !options.run.scenario.empty();
  if (is_live != options.recordings.empty() || options.recordings.size() > 2) {
    throw InputError("command line", "view", is_live ? "a recording and --live" : "",
                     "one or two recordings, or --live");
  }
  if (!is_live && (options.run.program || options.run.sequence || options.run.record || options.run.changes.any())) {
    throw InputError("command line", "--program, --sequence, --items, --container, --pallet, -o", "with a recording",
                     "--live SCENARIO.yaml");
  }
  if (options.click && (!is_live || options.run.program || options.run.record || options.is_paused)) {
    throw InputError("command line", "--click", is_live ? "with --program, -o or --paused" : "without --live",
                     "--live SCENARIO.yaml, and a recording by the server (snug serve -o)");
  }
  if (!(options.speed >= 0.0 && options.speed <= 1e6)) {
    throw InputError("command line", "--speed", std::to_string(options.speed), "0 to 1000000");
  }
  if (options.server.port < 0 || options.server.port > 65535) {
    throw InputError("command line", "--port", std::to_string(options.server.port), "0 to 65535");
  }
}

int run_view(const ViewOptions& options) {
  check_view_words(options);
  if (options.run.scenario.empty()) return view_recordings(options);
  return options.click ? view_served(options) : view_live(options);
}

constexpr const char* kViewExamples = R"(Examples:
  snug view run.h5
  snug view run.h5 again.h5                          # the second is laid over the first
  snug view --live scenarios/drop.yaml --speed 0.2 --paused
  snug view --live scenarios/box-demonstrator.yaml --program program.csv --sequence 1 -o run.h5
  snug serve scenarios/box-demonstrator.yaml --click tcp://127.0.0.1:5555
  snug view --live scenarios/box-demonstrator.yaml --click tcp://127.0.0.1:5555      # in another terminal: looks on
Ctrl-C ends view. Only this machine can open the page, unless --host names another of its addresses.
Readers on other machines need the whole printed address, with its token.)";

}  // namespace

void announce(const std::string& address, bool opens_browser) {
  std::fprintf(stderr, "snug: showing at %s (Ctrl-C ends it)\n", address.c_str());
  if (opens_browser) serve::open_browser(address);
}

void add_view(CLI::App& app, Action& action) {
  const Verb verb(app, action, "view", "show a recording or a running simulation in the browser", kViewExamples);
  ViewOptions& options = verb.runs(run_view);
  verb.option("recordings", options.recordings, "FILE.h5", "a recording, and optionally another to overlay");
  verb.option("--live", options.run.scenario, "SCENARIO.yaml", "run this scenario and show it live");
  verb.option("--click", options.click, "ADDRESS",
              "with --live: show the cell that `snug serve SCENARIO.yaml --click ADDRESS` serves while others drive "
              "it; give --sequence if the server has it");
  add_client(verb, options.client, "--click-timeout");
  add_program_options(verb, options.run);
  add_physics_options(verb, options.run);
  verb.option("-o,--record", options.run.record, "FILE.h5", "write a recording of the live run");
  verb.option("--speed", options.speed, "FACTOR", "simulated seconds per second; 0: as fast as possible");
  verb.flag("--paused", options.is_paused, "start the live run paused");
  verb.option(
      "--host", options.server.host, "ADDRESS",
      "address to serve at; if it is not loopback, everybody who has the printed address with its token can watch");
  verb.option("--name", options.server.names, "NAME",
              "an additional host name that browsers use, behind a proxy or in a container");
  verb.option("--port", options.server.port, "N", "port to serve at; 0: any free one");
  verb.flag("--no-open", options.is_quiet, "do not open a browser, only print the address");
  add_selection(verb, options.selection);
  add_urdf(verb, options.urdf);
}

}  // namespace snug::app
