// Take away: what a run left, to open or to store, and the commands that make more of it.

import { api, isGoingOn } from "./api";
import { action, field, link, make, scrollable, setChoices } from "./dom";
import type { Shell } from "./shell";

const FILES: [ending: string, text: string][] = [
  [".h5", "Recording (HDF5)"],
  [".program.csv", "Program (waypoints, CSV)"],
  [".jsonl", "Log of events (JSON lines)"],
  [".operator", "What the operator said"],
  [".txt", "Command and what it printed"],
  [".png", "Picture of its end (PNG)"],
  [".glb", "The cell at its end in 3D (GLB)"],
  [".mcap", "Recording for Foxglove and others (MCAP)"],
  [".script", "Program for a UR robot (URScript)"],
  [".ros.yaml", "Trajectories for ROS (YAML)"],
];

/** What is made at a click: of which file of a run, and how it is spoken of. */
const MAKES: [what: string, button: string, words: string, source: string][] = [
  ["picture", "Make a picture", "The picture", ".h5"],
  ["film", "Make a film (frames)", "The film", ".h5"],
  ["glb", "Make a GLB", "The GLB", ".h5"],
  ["mcap", "Make an MCAP", "The MCAP", ".h5"],
  ["urscript", "Make URScript", "The URScript", ".program.csv"],
  ["ros", "Make ROS trajectories", "The trajectories", ".program.csv"],
];

export function makeTakeAway(shell: Shell): { element: HTMLElement; refresh(): void } {
  const which = make("select");
  const place = make("div");
  const said = make("p", "hint");
  said.setAttribute("role", "status");

  async function makeOf(what: string, words: string): Promise<void> {
    const run = which.value;
    const are = words.endsWith("s") ? "are" : "is";
    said.textContent = `${words} ${are} being made …`;
    const done = await shell.attempt(() => api.make(run, what));
    said.textContent = done ? `${words} of ${run} ${are} in the folder${what === "film" ? `, frames in ${run}-film` : ""}. As a command: ${done.command}` : "";
    await shell.refresh();
  }

  let known = "";
  /** Only what has changed: where the keys are stays. */
  function show(): void {
    const now = JSON.stringify([shell.folder.runs.find((one) => one.name === which.value), shell.folder.scenarios, shell.folder.items]);
    if (now === known) return;
    known = now;
    const run = shell.folder.runs.find((one) => one.name === which.value);
    if (!run) return place.replaceChildren(make("p", "", "There is no run yet."));
    const has = (ending: string): boolean => run.files.includes(run.name + ending);
    const links = make("ul", "links");
    if (has(".h5") && !isGoingOn(run)) links.append(make("li", "", link("Open the report", api.reportAddress(run.name)), " (made when it is first opened)"));
    if (has(".html")) links.append(make("li", "", link("Store the report", api.fileAddress(`${run.name}.html`), `${run.name}.html`)));
    for (const [ending, text] of FILES) {
      if (has(ending)) links.append(make("li", "", link(text, api.fileAddress(run.name + ending), run.name + ending)));
    }
    // As words of a shell: the files' names have no letters that would need quotes.
    const scenario = /^snug pack (\S+)/.exec(run.command)?.[1] ?? "cell.yaml";
    const items = / --items (\S+)/.exec(run.command)?.[1] ?? "";
    if (shell.folder.scenarios.some((one) => one.name === scenario)) links.append(make("li", "", link("Cell (YAML)", api.fileAddress(scenario), scenario)));
    if (shell.folder.items.some((one) => one.name === items)) links.append(make("li", "", link("Items (CSV)", api.fileAddress(items), items)));
    const more = [" --items", " --sequence"].map((option) => new RegExp(`${option} ('[^']*'|\\S+)`).exec(run.command)?.[0] ?? "").join("");
    const program = `${run.name}.program.csv --scenario ${scenario}${more}`;
    const commands = [
      `snug report ${run.name}.h5 -o ${run.name}.html`,
      `snug picture ${run.name}.h5 -o ${run.name}.png`,
      `snug picture ${run.name}.h5 --video ${run.name}-film --fps 10 --speed 4`,
      `snug export ${run.name}.h5 --format glb -o ${run.name}.glb`,
      `snug export ${run.name}.h5 --format mcap -o ${run.name}.mcap`,
      `snug export ${program} --format urscript -o ${run.name}.script`,
      `snug export ${program} --format ros-trajectory -o ${run.name}.ros.yaml`,
    ];
    const makes = make("div", "bar");
    for (const [what, button, words, source] of MAKES) if (has(source) && !isGoingOn(run)) makes.append(action(button, () => makeOf(what, words)));
    if (makes.childElementCount > 0) makes.append(said);
    place.replaceChildren(links, makes, make("h2", "", "Commands in the folder"), scrollable(make("pre", "command all", commands.join("\n"))),
      make("p", "hint", "URScript and ROS trajectories need a cell with a robot."));
  }

  which.addEventListener("change", () => {
    said.textContent = "";
    show();
  });
  const element = make("section", "page", make("div", "bar", field("Run", which)), place);
  return {
    element,
    refresh: () => {
      setChoices(which, shell.folder.runs.map((run): [string, string] => [run.name, `${run.name} (${run.state})`]));
      show();
    },
  };
}
