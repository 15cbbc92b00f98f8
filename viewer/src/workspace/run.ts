// Run: what is packed with what, as the command that does it; its progress while it goes on; all runs of the folder.

import { api, isGoingOn, type RunRequest, type RunStatus } from "./api";
import { action, field, later, make, numberInput, scrollable, setChoices, table, textInput } from "./dom";
import type { Shell } from "./shell";
import { DecisionView } from "./decisions";
import { Watch } from "./watch";

const MOST_SHOWN = 300; // runs in the list
const MOST_PREVIEWED = 5; // orders whose commands are shown
const ALL = "\u0000"; // all orders: no order has this name

/** In a few words: how far, or how it ended. */
export function describe(run: RunStatus): string {
  const counts = run.items > 0 ? `${run.packed} of ${run.items} packed, ${run.percent.toFixed(1)} % full` : "";
  if (run.state === "ended early") return `${counts}; it was killed, and can be resumed`;
  if (run.state === "being read") return "its log is being read";
  if (run.state === "not started") return "the program that would have started it has ended";
  return [counts, run.lost > 0 ? `${run.lost} lost` : "", run.state === "running" ? "" : run.message || run.stopped].filter(Boolean).join("; ");
}

export function makeRun(shell: Shell): { element: HTMLElement; refresh(): void } {
  const scenario = make("select");
  const items = make("select");
  const sequence = make("select");
  const plants = numberInput(1, 1, 100, 1);
  const seed = numberInput(1, 0, 1e9, 1);
  const tempo = make("select");
  setChoices(tempo, [["", "1 (full speed)"], ["0.9", "0.9"], ["0.8", "0.8"], ["0.7", "0.7"], ["0.6", "0.6"], ["0.5", "0.5"]]);
  const name = textInput("run-1");
  // A cell that another program serves, or a robot.
  const where = make("select");
  setChoices(where, [["", "simulated here"], ["click", "served: CLICK"], ["ur", "robot: UR"]]);
  const address = textInput("click://127.0.0.1:5555");
  const observe = textInput();
  observe.placeholder = "tcp://127.0.0.1:5555";
  const perception = make("select");
  setChoices(perception, [["", "exact"], ["noisy", "noisy"], ["camera", "camera"], ["dead-reckoning", "dead reckoning"]]);
  const moves = make("input");
  moves.type = "checkbox";
  let orders: string[] = []; // that can be chosen
  const holds = make("input");
  holds.type = "checkbox";
  const isServed = (): boolean => where.value !== "";
  const command = scrollable(make("pre", "command"));
  const said = make("div");
  said.setAttribute("role", "status");
  let shown = ""; // the run that is told of
  // It stays where it is while all around it changes: who wants to stop a run has to hit it.
  const decisions = new DecisionView(shell);
  const stopNow = action("Stop at once", async () => void (await shell.attempt(() => api.stopNow(shown))), "danger");
  stopNow.title = "The program ends at once; a robot that it moves stands still within 0.2 s";
  const stop = action("Stop", async () => void (await shell.attempt(() => api.stop(shown))));
  const elsewhere = make("span", "", "Another program started this run: it can be stopped there.");
  const shownCommand = scrollable(make("pre", "command"));
  const live = make("div", "live", said, make("div", "bar", stop, stopNow, elsewhere), decisions.operator, shownCommand);
  live.hidden = true;
  const list = scrollable(make("div", "scroll"));
  const scene = new Watch();
  let watched: EventSource | null = null;
  let stays = false; // what is shown was chosen when it was over: the next run of the queue does not take its place
  let isNameTyped = false;

  const request = (): RunRequest => ({
    name: name.value.trim(), scenario: scenario.value, items: items.value, sequence: sequence.value,
    plants: isServed() ? 1 : plants.valueAsNumber, plant_seed: seed.valueAsNumber, tempo: tempo.value ? Number(tempo.value) : null, resumes: "", holds: holds.checked,
    ...(isServed() ? { plant: address.value.trim(), observe: observe.value.trim(), perception: perception.value, moves_a_robot: moves.checked } : {}),
  });

  /** One for each order that is chosen. */
  function requests(): RunRequest[] {
    const one = request();
    if (sequence.value !== ALL) return [one];
    return orders.map((order, k) => ({ ...one, sequence: order, name: `${one.name}-${k + 1}` }));
  }

  function freeName(): string {
    const taken = (stem: string): boolean => shell.folder.runs.some((run) => run.name === stem || run.name.startsWith(`${stem}-`));
    let k = 1;
    while (taken(`run-${k}`)) ++k;
    return `run-${k}`;
  }

  let asked = 0, previewed = 0;

  async function preview(): Promise<void> {
    const mine = ++previewed;
    if (!scenario.value) return void (command.textContent = "Save a cell first.");
    try {
      const lines: string[] = [];
      for (const one of requests().slice(0, MOST_PREVIEWED)) lines.push(...(await api.commands(one)).runs.map((run) => run.command));
      if (mine !== previewed) return;
      const more = requests().length - MOST_PREVIEWED;
      command.textContent = lines.join("\n") + (more > 0 ? `\n# and so on, ${more} more orders` : "");
    } catch (error) {
      if (mine === previewed) command.textContent = shell.say(error);
    }
  }

  async function loadSequences(): Promise<void> {
    const from = items.value || scenario.value;
    const mine = ++asked; // an answer that comes late is of what was chosen before
    const checked = from ? await shell.attempt(() => api.facts(from)) : undefined;
    if (mine !== asked) return;
    orders = checked?.facts?.sequences ?? [];
    setChoices(sequence, [...orders.map((one): [string, string] => [one, one]), ...(orders.length > 1 ? [[ALL, `all ${orders.length} orders`] as [string, string]] : [])]);
    await preview();
  }

  function showLive(run: RunStatus): void {
    if (run.state === "running") scene.begin(run.name);
    else if (scene.name !== run.name || run.state === "waiting") scene.end();
    const bar = make("progress");
    bar.max = Math.max(1, run.items);
    bar.value = run.done;
    bar.setAttribute("aria-label", "Boxes done");
    const boxes = scrollable(make("ol", "box-list", ...(run.boxes ?? []).map((box) =>
      make("li", box.packed ? "" : "bad", make("b", "", box.id), ` ${box.end}${box.reason ? `: ${box.reason}` : ""}`))));
    shown = run.name;
    live.hidden = false;
    stop.hidden = !isGoingOn(run) || !run.can_be_stopped;
    stopNow.hidden = stop.hidden || run.state === "waiting";
    elsewhere.hidden = !isGoingOn(run) || run.can_be_stopped;
    shownCommand.textContent = run.command;
    shownCommand.hidden = run.command === "";
    void decisions.follow(run);
    said.replaceChildren(make("h2", "", `${run.name}: ${run.state}`), make("p", "", describe(run)), bar, boxes);
  }

  function watch(which: string, isOver = false): void {
    stays = isOver;
    watched?.close();
    const source = api.events(which);
    watched = source;
    source.addEventListener("status", (event) => {
      const run = JSON.parse((event as MessageEvent<string>).data) as RunStatus;
      showLive(run);
      if (isGoingOn(run)) return;
      source.close(); // it would ask again and again
      void shell.refresh();
    });
  }

  async function start(wanted: RunRequest[]): Promise<void> {
    const names: string[] = [];
    for (const one of wanted) {
      const started = await shell.attempt(() => api.start(one));
      if (!started) break;
      names.push(...started.runs.map((run) => run.name));
    }
    if (names.length === 0) return;
    shell.tell(`${names.slice(0, 3).join(", ")}${names.length > 3 ? ` and ${names.length - 3} more` : ""} started.`);
    isNameTyped = false;
    watch(names[0]!);
    await shell.refresh();
  }

  /** The words of the command that was killed, with its log to go on from. */
  async function resume(run: RunStatus): Promise<void> {
    const word = (option: string): string => new RegExp(`${option} (?:'([^']*)'|(\\S+))`).exec(run.command)?.slice(1).find(Boolean) ?? "";
    const of = /^snug pack (\S+)/.exec(run.command)?.[1] ?? "";
    await start([{ name: `${run.name}-resumed`, scenario: of, items: word("--items"), sequence: word("--sequence"), plants: 1,
      plant_seed: Number(word("--plant-seed")), plant: word("--plant"), observe: word("--observe"), perception: word("--perception"),
      moves_a_robot: run.command.includes(" --yes-this-moves-a-robot "), tempo: word("--tempo") ? Number(word("--tempo")) : null, resumes: run.name }]);
  }

  let listed = "";
  /** Keeps where the keys are: it is shown anew while runs go on. */
  function showList(): void {
    const runs = shell.folder.runs;
    const now = JSON.stringify([runs.length, ...runs.slice(0, MOST_SHOWN).map((run) => [run.name, run.state, describe(run), run.can_be_stopped, run.files])]);
    if (now === listed) return;
    listed = now;
    const focused = list.contains(document.activeElement) ? document.activeElement! : null;
    const rowOf = (element: Element): string => element.closest("tr")?.firstElementChild?.textContent ?? "";
    const before = focused && [rowOf(focused), focused.textContent];
    const rows = runs.slice(0, MOST_SHOWN).map((run) => {
      const buttons = make("span", "buttons", action("Show", () => watch(run.name, !isGoingOn(run))));
      if (isGoingOn(run)) {
        if (run.can_be_stopped) buttons.append(action("Stop", async () => void (await shell.attempt(() => api.stop(run.name)))));
      } else {
        if (run.state === "ended early" && run.command) buttons.append(action("Resume", () => resume(run)));
        buttons.append(action("Remove", async () => {
          if (!window.confirm(`Remove ${run.files.join(", ")}?`)) return;
          if (await shell.attempt(() => api.removeRun(run.name))) await shell.refresh();
        }));
      }
      return [run.name, run.state, describe(run), buttons];
    });
    list.replaceChildren(runs.length === 0 ? make("p", "", "There are no runs yet.") : table(["Run", "State", "Boxes", "Actions"], rows, "runs"));
    const going = runs.filter((run) => isGoingOn(run) && run.can_be_stopped);
    if (going.length > 1) {
      const waiting = going.filter((run) => run.state === "waiting");
      // Those that wait first: else each that ends would let another one begin.
      list.prepend(make("div", "bar", make("span", "", `${going.length - waiting.length} running, ${waiting.length} waiting`), action("Stop all", async () => {
        for (const run of [...waiting, ...going.filter((one) => one.state !== "waiting")]) if (!(await shell.attempt(() => api.stop(run.name)))) break;
        await shell.refresh();
      })));
    }
    if (runs.length > MOST_SHOWN) list.append(make("p", "", `${runs.length - MOST_SHOWN} more runs are not shown.`));
    if (before) [...list.querySelectorAll("button")].find((one) => rowOf(one) === before[0] && one.textContent === before[1])?.focus();
  }

  for (const select of [scenario, items]) select.addEventListener("change", () => void loadSequences());
  const changed = later(200, () => void preview());
  for (const input of [plants, seed, name]) input.addEventListener("input", changed);
  for (const select of [sequence, tempo]) select.addEventListener("change", changed);
  name.addEventListener("input", () => (isNameTyped = true));
  const ofPlants = [field("Plants", plants), field("First plant seed", seed)];
  const ofServed = [field("Address", address), field("Perception", perception)];
  const ofRobot = [field("Source of the box poses", observe), make("label", "check", moves, "A robot elsewhere moves")];
  function showPlant(): void {
    for (const one of ofPlants) one.hidden = isServed();
    for (const one of ofServed) one.hidden = !isServed();
    for (const one of ofRobot) one.hidden = where.value !== "ur";
    if (where.value !== "ur") [observe.value, moves.checked] = ["", false];
    const scheme = where.value === "ur" ? "ur://" : "click://";
    if (isServed() && !address.value.startsWith(where.value)) address.value = `${scheme}127.0.0.1${where.value === "ur" ? "" : ":5555"}`;
    void preview();
  }
  where.addEventListener("change", showPlant);
  for (const input of [address, observe, perception, moves]) input.addEventListener("input", changed);

  showPlant();

  let known = "";
  const element = make("section", "page",
    make("div", "bar", field("Cell", scenario), field("Items", items), field("Order", sequence)),
    make("div", "bar", field("What is packed", where), ...ofPlants, ...ofServed, ...ofRobot, field("Tempo", tempo), field("Name of the run", name), make("label", "check", holds, "Hold the first box"),
      action("Start", () => start(requests()), "main")),
    make("p", "hint", "What Start does, as a command in the folder:"), command, make("div", "going", live, scene.element), decisions.element, make("h2", "", "Runs of the folder"), list);
  return {
    element,
    refresh: () => {
      setChoices(scenario, shell.folder.scenarios.map((one): [string, string] => [one.name, one.name]), shell.chosen.scenario);
      setChoices(items, [["", "those of the cell"], ...shell.folder.items.map((one): [string, string] => [one.name, one.name])], shell.chosen.items);
      shell.chosen = {};
      if (!isNameTyped) name.value = freeName();
      showList();
      const now = [scenario.value, items.value, name.value].join("\n");
      if (now !== known) void loadSequences();
      known = now;
      const going = shell.folder.runs.find(isGoingOn);
      if (going && !stays && (!watched || watched.readyState === EventSource.CLOSED)) watch(going.name);
    },
  };
}
