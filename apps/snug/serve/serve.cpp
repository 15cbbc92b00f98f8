// serve: the cell as a CLICK simulator that controllers in other programs drive.
#include "apps/snug/serve/serve.hpp"
#include "apps/snug/command_line/verbs.hpp"

#include <unistd.h>

#include <cstdio>

#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/serve/served_runs.hpp"
#include "snug/commands/stop_signal.hpp"
#include "snug/core/input_error.hpp"
#include "snug/served_cell/step_lines.hpp"

namespace snug::app {
namespace {

/// What a run is ended by that its controller begins anew: the first one is not over with that.
constexpr const char* kResetByController = "reset by the controller";

control::DriveKind kind_of(const std::string& word) {
  return word == "position"   ? control::DriveKind::Position
         : word == "velocity" ? control::DriveKind::Speed
                              : control::DriveKind::Torque;
}

class Serving {
 public:
  explicit Serving(const ServeOptions& options) : options_(options), runs_(options) {
    if (options.runs_at_once && !options.server.is_async) {
      throw InputError("command line", "--run-at-once", "without --async",
                       "--async: else steps are those that a controller asks for");
    }
    served_cell::SimulatorSettings settings;
    settings.cell = options.cell;
    settings.cell.controls.clear();
    for (const std::string& word : options.controls) settings.cell.controls.push_back(kind_of(word));
    settings.cell.is_plant = options.plant_seed.has_value();
    settings.cell.rpy = *click::parse_rpy_order(options.rpy);
    settings.is_async = options.server.is_async;
    settings.runs_at_once = options.runs_at_once;
    settings.batch = options.batch;
    settings.begin_run = [this](int run) { return runs_.begin(run); };
    settings.end_run = [this](int run, const runs::RunResult& result) {
      runs_.end(run, result);
      has_run_ = true;
      if (options_.once && result.ended_by != kResetByController) server_->stop();
    };
    simulator_.emplace(runs_.simulation(), std::move(settings));
    served_cell::ServerSettings server = options.server;
    if (options.keys) server.keys = click::load_server_keys(*options.keys);
    server.log = [](const std::string& line) { std::fprintf(stderr, "snug: %s\n", line.c_str()); };
    server.controller_left = [this] {
      if (options_.once && has_run_) server_->stop();
    };
    server.steps_fd = STDIN_FILENO;
    server.read_steps = [this] { return lines_.read(STDIN_FILENO); };
    server_.emplace(*simulator_, std::move(server));
  }

  int run() {
    runs_.begin_page();
    const StopSignal signal([this] {
      runs_.release();
      server_->stop();
    });
    std::fprintf(stderr, "snug: serving %s at %s (Ctrl-C ends it)\n", runs_.simulation().scenario().source_name.c_str(),
                 server_->endpoint().c_str());
    server_->run();
    simulator_->end("the server was stopped");
    runs_.end_page();
    report();
    return options_.once && runs_.has_failed() ? kRunFailed : kSuccess;
  }

 private:
  void report() const {
    constexpr double kUs = 1e6;
    const served_cell::ServerTimes& times = server_->times();
    const served_cell::SimulatorCounts& counts = simulator_->counts();
    std::fprintf(
        stderr,
        "snug: %lld steps, %lld answers, %lld of them errors; median of an answer %.0f us, %.0f us without the cell\n",
        static_cast<long long>(counts.steps), static_cast<long long>(counts.replies),
        static_cast<long long>(counts.errors), kUs * times.service.quantile(0.5), kUs * times.own.quantile(0.5));
    print_lateness(server_->pacer());
  }

  const ServeOptions& options_;
  ServedRuns runs_;
  served_cell::StepLines lines_{[](const std::string& text) { std::fprintf(stderr, "snug: %s\n", text.c_str()); }};
  bool has_run_ = false;
  std::optional<served_cell::Simulator> simulator_;
  std::optional<served_cell::Server> server_;
};

int run_serve(const ServeOptions& options) {
  if (options.ur.host) return run_serve_ur(options);
  return Serving(options).run();
}

constexpr const char* kServeExamples = R"(Examples:
  snug serve scenarios/box-demonstrator.yaml --click tcp://127.0.0.1:5555
  snug serve scenarios/box-demonstrator.yaml --click ipc://cell --sequence 2 --record run.h5 --once
  snug serve scenarios/box-demonstrator.yaml --click tcp://127.0.0.1:5555 --sequence 1 --plant-seed 7 --once
  snug serve scenarios/box-demonstrator.yaml --click tcp://127.0.0.1:5555 --async --view
  snug serve scenarios/box-demonstrator.yaml --click tcp://127.0.0.1:5555 --robot-object ur10_FTSensor_sr_gripper
  snug serve scenarios/box-demonstrator.yaml --ur 127.0.0.1 --sequence 1 --record run.h5
  snug serve scenarios/box-demonstrator.yaml --ur 127.0.0.1 --sequence 1 --plant-seed 1 --observers tcp://127.0.0.1:5555
  snug keys keys
  snug serve scenarios/box-demonstrator.yaml --click tcp://0.0.0.0:5555 --keys keys   # for other machines
Each Control advances one step, unless --async is given. Ctrl-C ends the server. docs/click.md describes the protocol.)";

OptionRow add_served_cell(const Verb& verb, ServeOptions& options) {
  const OptionRow model = add_cell(verb, options);
  verb.option("--robot", options.robot, "NAME", "robot of the scenario to drive (default: its only one)");
  add_physics(verb, options.physics);
  return model;
}

void add_served_names(const Verb& verb, ServeOptions& options) {
  verb.option("--control", options.controls, "KINDS",
              "command of the joints: one for all, or one for each, separated by commas",
              one_of({"position", "velocity", "torque"}))
      .delimiter(',');
  verb.option("--robot-object", options.cell.robot_object, "NAME", "name of the robot's object (default: the robot's)");
  verb.option("--force-sensor", options.cell.force_sensor, "NAME", "name of the force/torque sensor");
  verb.option("--vacuum-event", options.cell.vacuum_event, "NAME", "name of the event that switches the vacuum");
  verb.option("--blow-off-event", options.cell.blow_off_event, "NAME", "name of the event that switches the blow-off");
  verb.option("--rpy", options.rpy, "ORDER", "fixed axes of roll, pitch and yaw, first to last; xyz as in URDF",
              one_of({"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"}));
  verb.flag("--box-velocities", options.cell.velocities, "boxes report their velocities as well");
  verb.flag("--joint-forces", options.cell.joint_forces, "joints report their forces as well");
}

void add_served_time(const Verb& verb, ServeOptions& options) {
  verb.flag("--async", options.server.is_async,
            "run in real time without waiting for the controller; Controls act from the next step on");
  verb.option("--speed", options.server.speed, "FACTOR",
              "simulated seconds per second: with --async (default 1), otherwise the limit for Controls",
              within(1e-3, 1e3));
  verb.option("--batch", options.batch, "SECONDS", "reset the simulator after each such period of simulated time",
              positive());
  verb.flag("--step-by-step", options.server.step_by_step,
            "wait for lines on stdin before steps: an empty line allows one, a number that many, c all, r resets");
  verb.flag("--run-at-once", options.runs_at_once,
            "with --async: run the cell before a controller connects, the robot at rest");
  verb.option("--stop-after", options.server.stop_after, "SECONDS", "end after this simulated time", positive());
  verb.flag("--once", options.once,
            "end when the first controller has left or its run has failed; a Reset starts a new run");
}

void add_served_ur(const Verb& verb, UrOptions& ur, const OptionRow& model) {
  const OptionRow host =
      verb.option("--ur", ur.host, "ADDRESS",
                  "act as a controller of Universal Robots at this address instead: RTDE 30004, "
                  "dashboard 29999, primary 30001, secondary 30002, real-time 30003 (docs/ur-served.md)");
  host.excludes({"--click", "--keys", "--async", "--batch", "--step-by-step", "--run-at-once", "--stop-after"});
  model.needs(host);
  verb.option("--ur-port-offset", ur.port_offset, "N", "number added to its five ports", whole(0, 35531)).needs(host);
  verb.option("--ur-clients", ur.clients, "ADDRESSES",
              "addresses of other machines that may move the robot, separated by commas, or `any`; required for an "
              "address that other machines can reach, since clients of a UR have no keys")
      .delimiter(',')
      .needs(host);
  verb.option("--ur-programs", ur.programs, "FOLDER",
              "folder of programs that the dashboard may load: clients see NAME.script as NAME.urp")
      .needs(host);
  verb.option("--observers", ur.observers, "ADDRESS",
              "show observers on this machine where the boxes are, over CLICK: tcp://127.0.0.1:PORT or ipc://PATH; "
              "RTDE does not report boxes (`snug pack --observe`)")
      .needs(host);
}

}  // namespace

OptionRow add_cell(const Verb& verb, ServeOptions& options) {
  add_robot_scenario(verb, options.scenario);
  add_scenario_changes(verb, options.changes);
  verb.option("--sequence", options.sequence, "NAME",
              "item sequence whose boxes come to the aligner (default: the first)");
  verb.option("--plant-seed", options.plant_seed, "N",
              "use the plant that `snug pack --plant-seed N` packs: drawn from the scenario's `uncertainty` (0: "
              "exactly the scenario), a cup with phases, more sensors, protective stops that can be acknowledged",
              whole(0));
  verb.option("-o,--record", options.record, "FILE.h5",
              "write a recording; those of further runs get a number: run-2.h5");
  add_json(verb, options.json);
  return verb.option(
      "--model", options.ur.model, "MODEL",
      "model of the UR controller: ur10 runs at 125 Hz; ur3e, ur5e, ur10e, ur16e, ur20 and ur30 at 500 Hz",
      one_of({"ur10", "ur3e", "ur5e", "ur10e", "ur16e", "ur20", "ur30"}));
}

void add_serve(CLI::App& app, Action& action) {
  const Verb verb(app, action, "serve",
                  "serve the simulated cell to controllers in other programs, over CLICK or as a UR", kServeExamples);
  ServeOptions& options = verb.runs(run_serve);
  verb.option("--click", options.server.endpoint, "ADDRESS", "address to serve at: tcp://HOST:PORT or ipc://PATH");
  verb.option("--keys", options.keys, "DIR",
              "admit only clients with a key of this folder (`snug keys DIR` makes it), and encrypt; required for an "
              "address that other machines can reach");
  verb.option("--lease", options.server.lease, "SECONDS",
              "a controller that is silent for longer loses its place to the next one that commands", within(0.1, 1e6));
  const OptionRow model = add_served_cell(verb, options);
  add_served_names(verb, options);
  add_served_time(verb, options);
  add_served_ur(verb, options.ur, model);
  verb.flag("--view", options.shows, "show the present run in the browser");
  verb.option("--port", options.page.port, "N", "port of the page on this machine; 0: any free one", whole(0, 65535));
  verb.flag("--no-open", options.is_quiet, "do not open a browser, only print the address of the page");
}

}  // namespace snug::app
