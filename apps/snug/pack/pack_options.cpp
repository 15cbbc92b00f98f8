// pack: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/pack/pack.hpp"
#include "snug/packing/agent.hpp"

namespace snug::app {
namespace {

constexpr const char* kPackExamples = R"(Examples:
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --plant-seed 7
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --robot none --json
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --plant-seed 2 --tempo 0.8
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --fault drop@3,noseal@5,displace@7,stop@9 -o run.h5
  snug pack scenarios/box-demonstrator.yaml --sequence 3 --agent margin --perception noisy
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --plant-set contacts.pairs.box/container.friction=0.15
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --agent examples.python.03_agent:Lowest
  snug pack scenarios/box-demonstrator.yaml --sequence random-1 --random-seed 7
  snug pack scenarios/box-demonstrator.yaml --items scenarios/orders-example.csv --sequence kitchen
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --plant click://127.0.0.1:5555
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --plant ur://127.0.0.1 --observe tcp://127.0.0.1:5555
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --plant click://127.0.0.1:5555 --perception frames --frames "snug camera scenarios/box-demonstrator.yaml --click tcp://127.0.0.1:5555 --sequence 1 --shot {look} -o {frame}.h5"
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --container 400x300x200
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --pallet 600x400x300 --program out.csv
  snug pack scenarios/box-demonstrator.yaml --sequence 2 --program out.csv --plan out.json --monte-carlo 10
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --save-belief beliefs --log session.jsonl
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --resume session.jsonl --log whole.jsonl
  printf 'next hold\nnext elsewhere\nnext go\n' | snug pack scenarios/box-demonstrator.yaml --sequence 1 --operator -
  snug simulate scenarios/box-demonstrator.yaml --program program.csv --sequence 1
Programs of such a run need the same --items, --container and --pallet in simulate, check and export; recordings hold them.)";

}  // namespace

void add_packing_options(CLI::App& verb, PackOptions& options) {
  add_scenario_changes(verb, options.changes);
  verb.add_option("--seed", options.seed, "seed of the planner: roll-outs and sampled worlds (default: the scenario's)")
      ->check(whole(0))
      ->type_name("N");
  verb.add_option(
          "--plant-seed", options.plant_seed,
          "seed of the simulated plant: the cell that is packed, drawn from the scenario's `uncertainty`; 0: the "
          "cell is exactly what the scenario says. A served plant has its own: snug serve --plant-seed")
      ->check(whole(0))
      ->type_name("N")
      ->capture_default_str();
  verb.add_option("--plant-set", options.plant_set,
                  "a key of the plant's scenario with another value than the planner has, such as "
                  "contacts.pairs.box/container.friction=0.15; may be given several times")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  verb.add_option("--perception", options.perception,
                  "what is seen of boxes: exact poses and sizes, noisy ones (2 mm, 20 mrad), none (dead-reckoning), or "
                  "what the "
                  "scenario's camera over the container tells, or frames of a camera that exists: --frames "
                  "(docs/camera.md)")
      ->check(one_of({"exact", "noisy", "dead-reckoning", "camera", "frames"}))
      ->type_name("HOW")
      ->capture_default_str();
  verb.add_option(
          "--robot", options.robot,
          "the scenario's robot, such as ur10, whose joints move the tool in the plant, or none: the tool moves "
          "by itself (default: the scenario's robot)")
      ->type_name("NAME");
  verb.add_option(
          "--controller", options.controller,
          "fast: exactly on paths of bounded jerk, blended where nothing is switched, waypoints in contact and waits "
          "for the vacuum end by what is felt; lagged: with the demonstrator's timing and lag")
      ->check(one_of({"fast", "lagged"}))
      ->type_name("KIND")
      ->capture_default_str();
  verb.add_option("--tempo", options.tempo, "fraction of the speeds, with fast (default: 1)")
      ->check(within(0.5, 1.0))
      ->type_name("FRACTION");
  verb.add_option("--fault", options.fault,
                  "what goes wrong in the plant: noseal@N, drop@N, stop@N, displace@N, push@N of the N-th item, "
                  "object@N (a foreign "
                  "box is put into the container after it), clear@N (and taken out), "
                  "separated by commas")
      ->type_name("FAULTS");
  verb.add_option("--decision-time", options.decision_time, "for deciding where an item goes, on one core")
      ->check(within(0.0, 3600.0))
      ->type_name("SECONDS")
      ->capture_default_str();
  verb.add_option("--threads", options.threads, "threads; the result does not depend on it (default: all cores)")
      ->check(whole(1, kMostThreads))
      ->type_name("N");
  verb.add_option("--samples", options.samples,
                  "sampled worlds in which every motion is rehearsed beside the nominal one, at most 64; 0: none")
      ->check(whole(0, 64))
      ->type_name("N")
      ->capture_default_str();
  verb.add_option("--skips", options.skips,
                  "items without a place that are skipped before the session ends (default: the scenario's "
                  "recovery.skips)")
      ->check(whole(0, 1000))
      ->type_name("N");
  verb.add_option("--future", options.future,
                  "what an item is expected to be followed by: the other boxes of its order, in any order (order), any "
                  "boxes of the scenario and of --items, again and again (catalogue), or nothing that is known (none)")
      ->check(one_of({"order", "catalogue", "none"}))
      ->type_name("WHICH")
      ->capture_default_str();
}

void add_pack(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand(
      "pack", "pack a simulated plant: decide where each box goes, rehearse, send, perceive, recover");
  const auto options = std::make_shared<PackOptions>();
  verb.add_option("scenario", options->scenario,
                  "scenario file, or name of one that comes with snug (drop, box-demonstrator)")
      ->required()
      ->type_name("SCENARIO.yaml");
  verb.add_option("--sequence", options->sequence, "item sequence of the scenario")->required()->type_name("NAME");
  verb.add_option("--random-seed", options->random_seed,
                  "the sequence is every box of the scenario in an order drawn by this seed and the name: random-1, "
                  "random-2, ... are those of compare --random")
      ->check(whole(0))
      ->type_name("N");
  verb.add_option("--agent", options->agent,
                  "who decides: a built-in agent, or a class written in Python (docs/python.md)")
      ->check(one_of(packing::agent_names(), "module:Class"))
      ->type_name("NAME|MODULE:CLASS")
      ->capture_default_str();
  verb.add_option("--agent-timeout", options->agent_patience,
                  "how long an agent in Python may take to start, and for each answer")
      ->check(within(0.01, 1e6))
      ->type_name("SECONDS")
      ->capture_default_str();
  verb.add_option(
          "--plant", options->plant,
          "what is packed: simulated, in this program, or a cell that `snug serve` serves in another one, here or "
          "elsewhere: click://HOST:PORT, click+ipc://PATH (docs/click.md), or through a robot of Universal Robots: "
          "ur://HOST, or ur://HOST:N with N added to its ports (docs/ur.md)")
      ->type_name("simulated|ADDRESS")
      ->capture_default_str();
  verb.add_option("--observe", options->observe,
                  "of ur://HOST: where boxes are told, tcp://HOST:PORT or ipc://PATH as `snug serve --ur --observers` "
                  "has it; the perceptions exact, noisy and camera need it")
      ->type_name("ADDRESS");
  verb.add_flag("--dry-run", options->is_dry,
                "of ur://HOST: a simulated plant is packed, and the robot makes each motion first, 20 mm higher, at a "
                "quarter of the speed, without vacuum");
  verb.add_flag("--lockstep", options->is_in_lockstep,
                "of ur://HOST: a served cell makes a period when this program says so, as fast as both go, and waits "
                "else: the same run each time");
  verb.add_flag("--yes-this-moves-a-robot", options->may_move,
                "of ur://HOST: demanded for every address but this machine's own");
  verb.add_option("--part-timeout", options->part_patience,
                  "of ur://HOST: how long a box may take to come to the aligner")
      ->check(within(0.1, 1e6))
      ->type_name("SECONDS")
      ->capture_default_str();
  verb.add_option("--keys", options->keys,
                  "keys by which this program is known there, and knows whom it meets (`snug keys`): a folder, or "
                  "a file NAME.key_secret in it")
      ->type_name("DIR");
  verb.add_option("--plant-timeout", options->patience, "how long to wait for an answer of a served plant")
      ->check(within(0.01, 1e5))
      ->type_name("SECONDS")
      ->capture_default_str();
  add_packing_options(verb, *options);
  verb.add_option(
          "--frames", options->frames,
          "of --perception frames: a folder in which a frame appears at each look, or a command that leaves one: "
          "{frame} is its path without ending, {look} its number; no shell runs it (docs/camera.md)")
      ->type_name("DIR|COMMAND");
  verb.add_option("--frames-timeout", options->frames_patience, "how long a frame may take")
      ->check(within(0.01, 1e5))
      ->type_name("SECONDS")
      ->capture_default_str();
  verb.add_option("--frames-camera", options->frames_camera,
                  "optics, unit, axes and pose of the camera that takes them, whatever the frames say: JSON or YAML")
      ->type_name("FILE");
  verb.add_option("--frames-unit", options->frames_unit, "metres of a step of grey, or of a coordinate")
      ->check(within(1e-7, 1.0))
      ->type_name("M");
  verb.add_option("--monte-carlo", options->monte_carlo,
                  "repeat the finished program N times, open loop, in cells drawn from the scenario's `uncertainty`")
      ->check(whole(1, kMostRuns))
      ->type_name("N");
  verb.add_option("--program", options->program, "write the waypoint program")->type_name("FILE.csv");
  verb.add_option("--plan", options->plan, "write the placements as JSON")->type_name("FILE.json");
  CLI::Option* record =
      verb.add_option("-o,--record", options->record, "write a recording of what happened in the plant")
          ->type_name("FILE.h5");
  verb.add_option("--live", options->live,
                  "write 31 frames a second of the recording while it goes on, for who watches it: snug ui does")
      ->needs(record)
      ->type_name("FILE.live");
  verb.add_option("--log", options->log, "write the events of the session, a line of JSON each, when they happen")
      ->type_name("FILE.jsonl");
  verb.add_option("--resume", options->resume,
                  "go on with a session that was killed or interrupted, by its log: items that were done with stay, "
                  "that which was under way comes anew; all else has to be said as it was")
      ->type_name("FILE.jsonl");
  verb.add_option("--operator", options->operator_file,
                  "what a person wants otherwise, line by line, from a file that may grow or from standard input (-): "
                  "AT hold, go, skip, elsewhere, place NUMBER or take-out ITEM, with AT an item or next "
                  "(docs/session.md)")
      ->type_name("FILE|-");
  verb.add_option("--save-belief", options->save_beliefs,
                  "write what is believed before each decision into this folder: `snug plan` repeats the decision")
      ->type_name("DIR");
  verb.add_flag("--json", options->json, "print the result as JSON");
  verb.footer(kPackExamples);
  verb.callback([options, &action] { action = [options] { return run_pack(*options); }; });
}

}  // namespace snug::app
