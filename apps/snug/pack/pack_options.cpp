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
Give simulate, check and export the same --items, --container and --pallet as the run that made the program.)";

/// Of --perception frames.
void add_frame_options(const Verb& verb, PackOptions& options) {
  verb.option("--frames", options.plant.frames, "DIR|COMMAND",
              "with --perception frames: a folder in which a frame appears at each look, or a command that writes one: "
              "{frame} is its path without ending, {look} its number; no shell runs it (docs/camera-frames.md)");
  verb.option("--frames-timeout", options.plant.frames_patience, "SECONDS", "how long a frame may take",
              within(0.01, 1e5));
  verb.option("--frames-camera", options.plant.frames_camera, "FILE",
              "optics, unit, axes and pose of that camera, in JSON or YAML; overrides what the frames say");
  verb.option("--frames-unit", options.plant.frames_unit, "M",
              "metres in one step of grey, or in one unit of a coordinate", within(1e-7, 1.0));
}

}  // namespace

void add_packing_options(const Verb& verb, PackOptions& options) {
  add_scenario_changes(verb, options.changes);
  verb.option("--seed", options.seed, "N", "seed of the planner: rollouts and sampled worlds (default: the scenario's)",
              whole(0));
  verb.option("--plant-seed", options.plant.seed, "N",
              "seed that draws the simulated plant from the scenario's `uncertainty`; 0: exactly the cell of the "
              "scenario. A served plant has its own: snug serve --plant-seed",
              whole(0));
  verb.option("--plant-set", options.plant_set, "KEY=VALUE",
              "set a key of the plant's scenario to another value than the planner has, such as "
              "contacts.pairs.box/container.friction=0.15; may be given several times")
      .one_each();
  verb.option(
      "--perception", options.plant.perception, "HOW",
      "how boxes are seen: exact: their true poses and sizes; noisy: within 2 mm and 20 mrad; dead-reckoning: not at "
      "all; camera: by the scenario's depth camera; frames: by your own camera, see --frames (docs/camera-frames.md)",
      one_of({"exact", "noisy", "dead-reckoning", "camera", "frames"}));
  verb.option("--robot", options.robot, "NAME",
              "robot whose joints move the tool in the plant, such as ur10; none: the tool moves by itself (default: "
              "the scenario's robot)");
  verb.option("--controller", options.controller, "KIND",
              "fast: paths of bounded jerk, followed exactly, blended where nothing is switched; sensors end pushes "
              "and waits for the vacuum; lagged: the demonstrator's timing and lag",
              one_of({"fast", "lagged"}));
  verb.option("--tempo", options.tempo, "FRACTION", "fraction of the full speed, with fast (default: 1)",
              within(0.5, 1.0));
  verb.option("--fault", options.fault, "FAULTS",
              "faults of the plant, separated by commas: noseal@N, drop@N, stop@N, displace@N, push@N at the N-th "
              "item; object@N puts a foreign box into the container after it, clear@N takes it out");
  verb.option("--decision-time", options.session.decision.time, "SECONDS",
              "time to decide where an item goes, on one core", within(0.0, 3600.0));
  add_threads(verb, options.threads);
  verb.option("--samples", options.session.samples, "N",
              "sampled worlds in which every motion is rehearsed besides the nominal one, at most 64", whole(0, 64));
  verb.option(
      "--skips", options.session.skips, "N",
      "how many items without a place may be skipped before the session ends (default: the scenario's recovery.skips)",
      whole(0, 1000));
  verb.option("--future", options.future, "WHICH",
              "what the planner knows of later boxes: order: which boxes the order has, but not when they come; "
              "catalogue: only which boxes the scenario and --items have; none: nothing",
              one_of({"order", "catalogue", "none"}));
}

void add_pack(CLI::App& app, Action& action) {
  const Verb verb(app, action, "pack",
                  "pack boxes one by one: choose a place, rehearse the motion, execute it, recover from failures",
                  kPackExamples);
  PackOptions& options = verb.runs(run_pack);
  add_scenario(verb, options.scenario);
  verb.option("--sequence", options.sequence, "NAME", "item sequence of the scenario").required();
  verb.option("--random-seed", options.random_seed, "N",
              "pack every box of the scenario in a random order, drawn by this seed and the sequence's name; random-1, "
              "random-2, ... are those of compare --random",
              whole(0));
  verb.option("--agent", options.session.agent, "NAME|MODULE:CLASS",
              "agent that decides: a built-in one, or a class written in Python (docs/python.md)",
              one_of(packing::agent_names(), "module:Class"));
  verb.option("--agent-timeout", options.agent_patience, "SECONDS",
              "how long an agent in Python may take to start, and for each answer", within(0.01, 1e6));
  verb.option("--plant", options.plant.address, "simulated|ADDRESS",
              "plant to pack: simulated in this program; a cell that `snug serve` serves: click://HOST:PORT, "
              "click+ipc://PATH (docs/click.md); or a robot of Universal Robots: ur://HOST, or ur://HOST:N with N "
              "added to its ports (docs/ur.md)");
  verb.option("--observe", options.plant.observe, "ADDRESS",
              "with ur://HOST: address that reports the boxes, tcp://HOST:PORT or ipc://PATH, as given to `snug serve "
              "--ur --observers`; the perceptions exact, noisy and camera need it");
  verb.flag("--dry-run", options.plant.is_dry,
            "with ur://HOST: pack a simulated plant; before each motion the robot makes it 20 mm higher, at a quarter "
            "of the speed, without vacuum");
  verb.flag(
      "--lockstep", options.plant.is_in_lockstep,
      "with ur://HOST: a served cell advances one period whenever this program asks, so the run is the same each time");
  verb.flag("--yes-this-moves-a-robot", options.plant.may_move,
            "with ur://HOST: required for every address except this machine's own");
  verb.option("--part-timeout", options.plant.part_patience, "SECONDS",
              "with ur://HOST: how long a box may take to reach the aligner", within(0.1, 1e6));
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
              "write 31 frames a second of the running recording for viewers such as snug ui")
      .needs(record);
  verb.option("--log", options.log, "FILE.jsonl", "write each event of the session as a line of JSON when it happens");
  verb.option("--resume", options.resume, "FILE.jsonl",
              "continue a session that was killed or interrupted, from its log: finished items stay, the unfinished "
              "one comes again; give all other options as before");
  verb.option("--operator", options.operator_file, "FILE|-",
              "orders of a person, one a line, from a file that may grow or from standard input (-): AT hold, go, "
              "skip, elsewhere, place NUMBER or take-out ITEM, where AT is an item or next (docs/session.md)");
  verb.option("--save-belief", options.save_beliefs, "DIR",
              "write the belief before each decision into this folder; `snug plan` repeats the decision");
  add_json(verb, options.json);
}

}  // namespace snug::app
