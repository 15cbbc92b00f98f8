// serve: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/serve/serve.hpp"

namespace snug::app {
namespace {

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
One Control is one step, unless --async. Ctrl-C ends it. docs/click.md describes the protocol as it is served.)";

void add_served_cell(CLI::App& verb, ServeOptions& options) {
  add_scenario_changes(verb, options.changes);
  verb.add_option("--sequence", options.sequence, "item sequence whose boxes come to the aligner; absent: the first")
      ->type_name("NAME");
  verb.add_option("--plant-seed", options.plant_seed,
                  "serve the plant that `snug pack --plant-seed N` packs: drawn from the scenario's `uncertainty` (0: "
                  "exactly what the scenario says), cup with phases, more sensors, protective stops that can be "
                  "acknowledged")
      ->check(whole(0))
      ->type_name("N");
  verb.add_option("--robot", options.robot, "robot of the scenario that is driven; absent: the one there is")
      ->type_name("NAME");
  verb.add_option(
          "--cup", options.cup,
          "phases: pressure builds up and decays, holds can fail; holding: attached and released at once (default: "
          "phases)")
      ->check(one_of({"holding", "phases"}))
      ->type_name("MODEL");
  verb.add_option("--dt", options.dt, "time step of the physics, instead of the scenario's")
      ->check(within(1e-6, 0.1))
      ->type_name("SECONDS");
  verb.add_option("--seed", options.seed, "seed of everything random, instead of the scenario's")
      ->check(whole(0))
      ->type_name("N");
}

void add_served_names(CLI::App& verb, ServeOptions& options) {
  verb.add_option("--control", options.controls,
                  "what joints are commanded by: one for all, or one for each, with commas between")
      ->delimiter(',')
      ->check(one_of({"position", "velocity", "torque"}))
      ->type_name("KINDS")
      ->capture_default_str();
  verb.add_option("--robot-object", options.cell.robot_object, "name of the robot's object; absent: the robot's")
      ->type_name("NAME");
  verb.add_option("--force-sensor", options.cell.force_sensor, "name of the force/torque sensor")
      ->type_name("NAME")
      ->capture_default_str();
  verb.add_option("--vacuum-event", options.cell.vacuum_event, "name of the event that switches the vacuum")
      ->type_name("NAME")
      ->capture_default_str();
  verb.add_option("--blow-off-event", options.cell.blow_off_event, "name of the event that switches the blow-off")
      ->type_name("NAME")
      ->capture_default_str();
  verb.add_option("--rpy", options.rpy, "fixed axes about which roll, pitch and yaw turn, first to last; xyz as URDF")
      ->check(one_of({"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"}))
      ->type_name("ORDER")
      ->capture_default_str();
  verb.add_flag("--box-velocities", options.cell.velocities, "boxes tell their velocities, too");
  verb.add_flag("--joint-forces", options.cell.joint_forces, "joints tell the forces in them, too");
}

void add_served_time(CLI::App& verb, ServeOptions& options) {
  verb.add_flag("--async", options.server.is_async, "run freely in real time; Controls act from the next step on");
  verb.add_option("--speed", options.server.speed,
                  "simulated seconds a second: of --async (default 1), or the most that Controls make")
      ->check(within(1e-3, 1e3))
      ->type_name("FACTOR");
  verb.add_option("--batch", options.batch, "reset the simulator each time so much simulated time is over")
      ->check(positive())
      ->type_name("SECONDS");
  verb.add_flag("--step-by-step", options.server.step_by_step,
                "steps wait for lines on stdin: an empty one allows one, a number so many, c all, r resets");
  verb.add_flag("--run-at-once", options.runs_at_once,
                "with --async: the cell runs before there is a controller, the robot at rest");
  verb.add_option("--stop-after", options.server.stop_after, "end when so much simulated time is over")
      ->check(positive())
      ->type_name("SECONDS");
  verb.add_flag("--once", options.once,
                "end when the first controller has left, or its run has failed; a Reset begins a run anew");
  verb.add_option("-o,--record", options.record, "write a recording; those of further runs have a number: run-2.h5")
      ->type_name("FILE.h5");
  verb.add_option("--record-period", options.record_period, "time between frames, instead of the scenario's or 0.008")
      ->check(positive())
      ->type_name("SECONDS");
  verb.add_flag("--json", options.json, "print the result of each run as a line of JSON");
}

void add_served_ur(CLI::App& verb, UrOptions& ur) {
  CLI::Option* host = verb.add_option("--ur", ur.host,
                                      "be a controller of Universal Robots at this address instead: RTDE 30004, "
                                      "dashboard 29999, primary 30001, secondary 30002, real-time 30003 (docs/ur.md)");
  host->type_name("ADDRESS")->excludes("--click", "--keys", "--async", "--batch", "--step-by-step", "--run-at-once",
                                       "--stop-after");
  verb.add_option("--model", ur.model, "of that controller: ur10 runs at 125 Hz, ur10e and ur5e at 500 Hz")
      ->check(one_of({"ur10", "ur10e", "ur5e"}))
      ->needs(host)
      ->type_name("MODEL")
      ->capture_default_str();
  verb.add_option("--ur-port-offset", ur.port_offset, "added to each of its five ports")
      ->check(whole(0, 35531))
      ->needs(host)
      ->type_name("N")
      ->capture_default_str();
  verb.add_option("--ur-clients", ur.clients,
                  "addresses of other machines that may move the robot, with commas between, or `any`; an address that "
                  "other machines can reach needs it: clients of a UR show no keys")
      ->delimiter(',')
      ->needs(host)
      ->type_name("ADDRESSES");
  verb.add_option("--observers", ur.observers,
                  "let observers on this machine see where the boxes are, over CLICK: tcp://127.0.0.1:PORT or "
                  "ipc://PATH; RTDE tells nothing of boxes (`snug pack --observe`)")
      ->needs(host)
      ->type_name("ADDRESS");
}

}  // namespace

void add_serve(CLI::App& app, Action& action) {
  CLI::App& verb =
      *app.add_subcommand("serve", "let a controller in another program drive the cell (CLICK), or be a UR");
  const auto options = std::make_shared<ServeOptions>();
  const auto is_quiet = std::make_shared<bool>(false);
  verb.add_option("scenario", options->scenario, "scenario file with a robot, or name of one that comes with snug")
      ->required()
      ->type_name("SCENARIO.yaml");
  verb.add_option("--click", options->server.endpoint, "address to serve at: tcp://HOST:PORT or ipc://PATH")
      ->type_name("ADDRESS")
      ->capture_default_str();
  verb.add_option("--keys", options->keys,
                  "let in only who has a key of this folder (`snug keys DIR` makes it), and encrypt what is said; an "
                  "address that other machines can reach needs it")
      ->type_name("DIR");
  verb.add_option("--lease", options->server.lease,
                  "a controller that says nothing for longer gives its place to the next one that commands")
      ->check(within(0.1, 1e6))
      ->type_name("SECONDS")
      ->capture_default_str();
  add_served_cell(verb, *options);
  add_served_names(verb, *options);
  add_served_time(verb, *options);
  add_served_ur(verb, options->ur);
  verb.add_flag("--view", options->shows, "show the run that goes on in the browser, one after the other");
  verb.add_option("--port", options->page.port, "port of the page on this machine; 0 any that is free")
      ->check(whole(0, 65535))
      ->type_name("N")
      ->capture_default_str();
  verb.add_flag("--no-open", *is_quiet, "open no browser, only say the page's address");
  verb.footer(kServeExamples);
  verb.callback([options, is_quiet, &action] {
    action = [options, is_quiet] {
      options->opens_browser = !*is_quiet;
      return run_serve(*options);
    };
  });
}

}  // namespace snug::app
