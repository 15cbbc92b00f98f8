// view: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/report/report.hpp"
#include "apps/snug/view/view.hpp"
#include "snug/core/input_error.hpp"

namespace snug::app {
namespace {

constexpr const char* kViewExamples = R"(Examples:
  snug view run.h5
  snug view run.h5 again.h5                          # the second is laid over the first
  snug view --live scenarios/drop.yaml --speed 0.2 --paused
  snug view --live scenarios/box-demonstrator.yaml --program program.csv --sequence 1 -o run.h5
  snug serve scenarios/box-demonstrator.yaml --click tcp://127.0.0.1:5555
  snug view --live scenarios/box-demonstrator.yaml --click tcp://127.0.0.1:5555      # in another terminal: looks on
Ctrl-C ends it. The page is served to this machine only, unless --host names another of its addresses.
Who opens that has to know the whole address that is printed, with its token.)";

void check(const ViewOptions& options) {
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

}  // namespace

void add_view(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("view", "show a recording, or a simulation that goes on, in the browser");
  const auto options = std::make_shared<ViewOptions>();
  const auto is_quiet = std::make_shared<bool>(false);
  verb.add_option("recordings", options->recordings, "a recording, and another one to lay over it")
      ->type_name("FILE.h5");
  verb.add_option("--live", options->run.scenario, "run this scenario and show it while it runs")
      ->type_name("SCENARIO.yaml");
  verb.add_option(
          "--click", options->click,
          "with --live: show the cell that `snug serve SCENARIO.yaml --click ADDRESS` serves, while others drive "
          "it; with --sequence if there")
      ->type_name("ADDRESS");
  verb.add_option("--click-timeout", options->patience, "how long an answer from there may take")
      ->check(positive())
      ->type_name("SECONDS")
      ->capture_default_str();
  verb.add_option("--keys", options->keys,
                  "keys by which this program is known there, and knows whom it meets (`snug keys`): a folder, or "
                  "a file NAME.key_secret in it")
      ->type_name("DIR");
  add_program_options(verb, options->run);
  add_physics_options(verb, options->run);
  verb.add_option("-o,--record", options->run.record, "write a recording of the live run")->type_name("FILE.h5");
  verb.add_option("--speed", options->speed, "of the live run, simulated seconds a second; 0 as fast as it goes")
      ->type_name("FACTOR")
      ->capture_default_str();
  verb.add_flag("--paused", options->is_paused, "start the live run paused");
  verb.add_option("--host", options->server.host,
                  "address to serve at; if it is not loopback, who has the printed address with its token can look in")
      ->type_name("ADDRESS")
      ->capture_default_str();
  verb.add_option("--name", options->server.names,
                  "a name by which browsers ask for it, besides this machine's own: behind a proxy, in a container")
      ->type_name("NAME");
  verb.add_option("--port", options->server.port, "port to serve at; 0 any that is free")
      ->type_name("N")
      ->capture_default_str();
  verb.add_flag("--no-open", *is_quiet, "open no browser, only say the address");
  add_selection_options(verb, options->selection);
  verb.add_option("--urdf", options->urdf, "how the robot in it looks (default: the file that its scenario names)")
      ->type_name("FILE.urdf");
  verb.footer(kViewExamples);
  verb.callback([options, is_quiet, &action] {
    action = [options, is_quiet] {
      options->opens_browser = !*is_quiet;
      check(*options);
      return run_view(*options);
    };
  });
}

}  // namespace snug::app
