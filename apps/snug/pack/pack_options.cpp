// pack: what may be said after the verb.
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/verbs.hpp"
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

/// Of --perception frames.
void add_frame_options(const Verb& verb, PackOptions& options) {
  verb.option("--frames", options.plant.frames, "DIR|COMMAND",
              "of --perception frames: a folder in which a frame appears at each look, or a command that leaves one: "
              "{frame} is its path without ending, {look} its number; no shell runs it (docs/camera.md)");
  verb.option("--frames-timeout", options.plant.frames_patience, "SECONDS", "how long a frame may take",
              within(0.01, 1e5));
  verb.option("--frames-camera", options.plant.frames_camera, "FILE",
              "optics, unit, axes and pose of the camera that takes them, whatever the frames say: JSON or YAML");
  verb.option("--frames-unit", options.plant.frames_unit, "M", "metres of a step of grey, or of a coordinate",
              within(1e-7, 1.0));
}

}  // namespace

void add_packing_options(const Verb& verb, PackOptions& options) {
  add_scenario_changes(verb, options.changes);
  verb.option("--seed", options.seed, "N",
              "seed of the planner: roll-outs and sampled worlds (default: the scenario's)", whole(0));
  verb.option("--plant-seed", options.plant.seed, "N",
              "seed of the simulated plant: the cell that is packed, drawn from the scenario's `uncertainty`; 0: the "
              "cell is exactly what the scenario says. A served plant has its own: snug serve --plant-seed",
              whole(0));
  verb.option("--plant-set", options.plant_set, "KEY=VALUE",
              "a key of the plant's scenario with another value than the planner has, such as "
              "contacts.pairs.box/container.friction=0.15; may be given several times")
      .one_each();
  verb.option(
      "--perception", options.plant.perception, "HOW",
      "what is seen of boxes: exact poses and sizes, noisy ones (2 mm, 20 mrad), none (dead-reckoning), or what the "
      "scenario's camera over the container tells, or frames of a camera that exists: --frames (docs/camera.md)",
      one_of({"exact", "noisy", "dead-reckoning", "camera", "frames"}));
  verb.option("--robot", options.robot, "NAME",
              "the scenario's robot, such as ur10, whose joints move the tool in the plant, or none: the tool moves by "
              "itself (default: the scenario's robot)");
  verb.option("--controller", options.controller, "KIND",
              "fast: exactly on paths of bounded jerk, blended where nothing is switched, waypoints in contact and "
              "waits for the vacuum end by what is felt; lagged: with the demonstrator's timing and lag",
              one_of({"fast", "lagged"}));
  verb.option("--tempo", options.tempo, "FRACTION", "fraction of the speeds, with fast (default: 1)", within(0.5, 1.0));
  verb.option("--fault", options.fault, "FAULTS",
              "what goes wrong in the plant: noseal@N, drop@N, stop@N, displace@N, push@N of the N-th item, object@N "
              "(a foreign box is put into the container after it), clear@N (and taken out), separated by commas");
  verb.option("--decision-time", options.decision_time, "SECONDS", "for deciding where an item goes, on one core",
              within(0.0, 3600.0));
  add_threads(verb, options.threads);
  verb.option("--samples", options.samples, "N",
              "sampled worlds in which every motion is rehearsed beside the nominal one, at most 64; 0: none",
              whole(0, 64));
  verb.option("--skips", options.skips, "N",
              "items without a place that are skipped before the session ends (default: the scenario's recovery.skips)",
              whole(0, 1000));
  verb.option("--future", options.future, "WHICH",
              "what an item is expected to be followed by: the other boxes of its order, in any order (order), any "
              "boxes of the scenario and of --items, again and again (catalogue), or nothing that is known (none)",
              one_of({"order", "catalogue", "none"}));
}

void add_pack(CLI::App& app, Action& action) {
  const Verb verb(app, action, "pack",
                  "pack a simulated plant: decide where each box goes, rehearse, send, perceive, recover",
                  kPackExamples);
  PackOptions& options = verb.runs(run_pack);
  add_scenario(verb, options.scenario);
  verb.option("--sequence", options.sequence, "NAME", "item sequence of the scenario").required();
  verb.option("--random-seed", options.random_seed, "N",
              "the sequence is every box of the scenario in an order drawn by this seed and the name: random-1, "
              "random-2, ... are those of compare --random",
              whole(0));
  verb.option("--agent", options.agent, "NAME|MODULE:CLASS",
              "who decides: a built-in agent, or a class written in Python (docs/python.md)",
              one_of(packing::agent_names(), "module:Class"));
  verb.option("--agent-timeout", options.agent_patience, "SECONDS",
              "how long an agent in Python may take to start, and for each answer", within(0.01, 1e6));
  verb.option("--plant", options.plant.address, "simulated|ADDRESS",
              "what is packed: simulated, in this program, or a cell that `snug serve` serves in another one, here or "
              "elsewhere: click://HOST:PORT, click+ipc://PATH (docs/click.md), or through a robot of Universal Robots: "
              "ur://HOST, or ur://HOST:N with N added to its ports (docs/ur.md)");
  verb.option("--observe", options.plant.observe, "ADDRESS",
              "of ur://HOST: where boxes are told, tcp://HOST:PORT or ipc://PATH as `snug serve --ur --observers` has "
              "it; the perceptions exact, noisy and camera need it");
  verb.flag("--dry-run", options.plant.is_dry,
            "of ur://HOST: a simulated plant is packed, and the robot makes each motion first, 20 mm higher, at a "
            "quarter of the speed, without vacuum");
  verb.flag("--lockstep", options.plant.is_in_lockstep,
            "of ur://HOST: a served cell makes a period when this program says so, as fast as both go, and waits else: "
            "the same run each time");
  verb.flag("--yes-this-moves-a-robot", options.plant.may_move,
            "of ur://HOST: demanded for every address but this machine's own");
  verb.option("--part-timeout", options.plant.part_patience, "SECONDS",
              "of ur://HOST: how long a box may take to come to the aligner", within(0.1, 1e6));
  add_client(verb, options.plant.keys, options.plant.patience, "--plant-timeout");
  add_packing_options(verb, options);
  add_frame_options(verb, options);
  verb.option("--monte-carlo", options.monte_carlo, "N",
              "repeat the finished program N times, open loop, in cells drawn from the scenario's `uncertainty`",
              whole(1, kMostRuns));
  verb.option("--program", options.program, "FILE.csv", "write the waypoint program");
  verb.option("--plan", options.plan, "FILE.json", "write the placements as JSON");
  const OptionRow record =
      verb.option("-o,--record", options.record, "FILE.h5", "write a recording of what happened in the plant");
  verb.option("--live", options.live, "FILE.live",
              "write 31 frames a second of the recording while it goes on, for who watches it: snug ui does")
      .needs(record);
  verb.option("--log", options.log, "FILE.jsonl",
              "write the events of the session, a line of JSON each, when they happen");
  verb.option("--resume", options.resume, "FILE.jsonl",
              "go on with a session that was killed or interrupted, by its log: items that were done with stay, that "
              "which was under way comes anew; all else has to be said as it was");
  verb.option("--operator", options.operator_file, "FILE|-",
              "what a person wants otherwise, line by line, from a file that may grow or from standard input (-): AT "
              "hold, go, skip, elsewhere, place NUMBER or take-out ITEM, with AT an item or next (docs/session.md)");
  verb.option("--save-belief", options.save_beliefs, "DIR",
              "write what is believed before each decision into this folder: `snug plan` repeats the decision");
  add_json(verb, options.json);
}

}  // namespace snug::app
