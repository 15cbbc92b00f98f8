// About: all that is known of a run: where it comes from, how it was set, its scenario and program; and the container at the end.

import type { Replay } from "../replay/replay";
import type { View } from "../scene/view";
import { button, make, seconds } from "./dom";
import type { Player } from "./player";
import { fillBars, milliseconds } from "./summary";

type Cell = string | number | Node;

function table(head: string[], rows: Cell[][]): HTMLTableElement {
  const element = make("table");
  if (head.length) element.append(make("thead", "", make("tr", "", ...head.map((text) => make("th", "", text)))));
  element.append(make("tbody", "", ...rows.map((row) => make("tr", "", ...row.map((cell) => make("td", "", typeof cell === "number" ? String(cell) : cell))))));
  return element;
}

/** Settings as they nest, one line each. */
export function flatten(value: unknown, path = ""): [string, string][] {
  if (value === null || typeof value !== "object") return [[path, String(value)]];
  return Object.entries(value as Record<string, unknown>).flatMap(([key, inner]) => flatten(inner, path ? `${path}.${key}` : key));
}

/** Why a packing session ended; empty when nothing was packed by one. Older recordings have it in the settings. */
function endOfSession(replay: Replay): string {
  const ended = replay.header.result?.ended_by || replay.header.settings?.ended;
  return typeof ended === "string" ? ended : "";
}

function facts(replay: Replay): HTMLElement {
  const { header: h } = replay;
  const rows: Cell[][] = [
    ["recording", h.name],
    ["made by", `snug ${h.snug_version || "-"}`],
    ["scenario", h.scenario.name || "-"],
    ["sequence", h.sequence || "-"],
    ["program", h.program.name ? `${h.program.name}, ${h.program.names.length} waypoints` : "-"],
    ["seed", h.seed || "-"],
    ["time step", `${milliseconds(h.dt)} ms`],
    ["recorded", `every ${milliseconds(h.record_period)} ms, ${replay.frames} frames, ${(replay.size / 1e6).toFixed(2)} MB in this page`],
    ["simulated", seconds(h.speed?.duration_s ?? replay.end - replay.start)],
    ["computed in", h.speed && h.speed.wall_s > 0 ? `${seconds(h.speed.wall_s)}, ${h.speed.real_time_factor.toFixed(0)} times as fast as it happens` : "-"],
    ["ended", h.result?.failure || endOfSession(replay) || (h.complete ? "in order" : h.interrupted ? "early, by a viewer" : "not in order")],
  ];
  return make("section", "", make("h3", "", "What ran"), table([], rows));
}

function resultTable(replay: Replay): HTMLElement | null {
  const { result } = replay.header;
  if (!result?.boxes.length) return null;
  const number = (v: number | undefined): string => (v === undefined ? "" : (1000 * v).toFixed(1));
  const rows = result.boxes.map((box): Cell[] => [box.id, box.state ?? "", box.up ?? "", number(box.pose?.[0]), number(box.pose?.[1]), number(box.pose?.[2])]);
  const head = ["box", "state", "up", "x [mm]", "y [mm]", "z [mm]"];
  return make("section", "", make("h3", "", "Boxes at the end"), make("p", "", "Middle of each box in T, the container."), table(head, rows));
}

function bodyTable(replay: Replay): HTMLElement {
  const size = (k: number): string => {
    const shapes = replay.bodies[k]!.shapes;
    const [shape] = shapes;
    if (shapes.length !== 1 || shape?.kind !== "box") return `${shapes.length} shape${shapes.length === 1 ? "" : "s"}`;
    return shape.half.map((half) => (2000 * half).toFixed(1)).join(" × ");
  };
  const rows = replay.bodies.map((body, k): Cell[] => [body.name, body.type, body.kind, body.kind === "dynamic" ? body.mass.toFixed(3) : "", size(k)]);
  return make("section", "", make("h3", "", "Bodies"), table(["name", "type", "kind", "mass [kg]", "size [mm]"], rows));
}

function settings(replay: Replay): HTMLElement {
  const lines = flatten(replay.header.settings ?? {});
  if (!lines.length) return make("section", "", make("p", "", "The recording has no settings."));
  return make("section", "", make("h3", "", "Settings of the run"), table([], lines));
}

function scenario(replay: Replay): HTMLElement {
  const { name, text } = replay.header.scenario;
  if (!text) return make("section", "", make("p", "", "The recording has no scenario."));
  const copy = button("copy", "Copy the scenario", () => void navigator.clipboard?.writeText(text).catch(() => {}));
  return make("section", "", make("h3", "", `${name} `, copy), make("pre", "", text));
}

/** When each row of the program was first approached, s; NaN when it never was. */
export function timesOfRows(replay: Replay): number[] {
  const times: number[] = replay.header.program.names.map(() => NaN);
  const rows = replay.channel("program_row");
  if (!rows) return times;
  let last = -1;
  rows.column(0).forEach((row, frame) => {
    if (row !== last && row >= 0 && Number.isNaN(times[row]!)) times[row] = replay.timeOf(frame);
    last = row;
  });
  return times;
}

function program(replay: Replay, player: Player, close: () => void): HTMLElement {
  const { name, names } = replay.header.program;
  if (!names.length) return make("section", "", make("p", "", "The recording has no program."));
  const times = timesOfRows(replay);
  const rows = names.map((row, k): Cell[] => {
    const time = times[k]!;
    const go = (): void => {
      player.pause();
      player.setTime(time);
      close();
    };
    return [k + 1, row, Number.isNaN(time) ? "not reached" : button(seconds(time), "Go there", go)];
  });
  return make("section", "", make("h3", "", name), table(["row", "waypoint", "approached from"], rows));
}

/** The container at the end from above and the side, large, beside what the report states. */
function container(replay: Replay, second: Replay | null, view: View): HTMLElement | null {
  if (!replay.header.container) return null;
  const [top, side] = [make("canvas"), make("canvas")];
  [top.width, top.height, side.width, side.height] = [560, 380, 560, 280];
  view.drawContainer(top, "top", replay.frames - 1);
  view.drawContainer(side, "side", replay.frames - 1);
  const pictures = make("div", "pictures", make("figure", "", top, make("figcaption", "", "from above")), make("figure", "", side, make("figcaption", "", "from the side")));
  const bars = fillBars(replay, second, true);
  return make("section", "", make("h3", "", "Container at the end"), ...(bars ? [bars] : []), pictures);
}

export class About {
  readonly element = make("div", "overlay about");
  private tab_ = "run";

  constructor(
    private readonly replays: Replay[],
    private readonly view: View,
    private readonly player: Player,
  ) {
    this.element.hidden = true;
    this.element.setAttribute("role", "dialog");
    this.element.setAttribute("aria-label", "About this run");
    this.element.addEventListener("click", (e) => {
      if (e.target === this.element) this.hide();
    });
  }

  show(tab = this.tab_): void {
    this.tab_ = tab;
    this.element.hidden = false;
    this.fill();
  }

  toggle(tab = this.tab_): void {
    if (this.element.hidden) this.show(tab);
    else this.hide();
  }

  hide(): void {
    this.element.hidden = true;
    this.element.replaceChildren();
  }

  private fill(): void {
    const tabs: [string, string][] = [["run", "Run"], ["container", "Container"], ["settings", "Settings"], ["program", "Program"], ["scenario", "Scenario"]];
    const bar = make("nav", "tabs");
    for (const [key, text] of tabs) {
      if (key === "container" && !this.replays[0]!.header.container) continue;
      const choose = button(text, text, () => this.show(key));
      choose.classList.toggle("on", key === this.tab_);
      bar.append(choose);
    }
    bar.append(button("✕", "Close (escape)", () => this.hide(), "close"));
    const columns = make("div", "columns");
    this.replays.forEach((replay, k) => {
      if (k > 0 && this.tab_ === "container") return;
      const parts = this.parts(replay).filter((part) => part !== null);
      const title = this.replays.length > 1 ? [make("h2", "", k === 0 ? `First: ${replay.header.name}` : `Overlaid: ${replay.header.name}`)] : [];
      columns.append(make("div", this.tab_ === "run" ? "flow" : "", ...title, ...parts));
    });
    this.element.replaceChildren(make("div", "card wide", bar, columns));
  }

  private parts(replay: Replay): (HTMLElement | null)[] {
    switch (this.tab_) {
      case "container":
        return [container(replay, this.replays[1] ?? null, this.view)];
      case "settings":
        return [settings(replay)];
      case "program":
        return [program(replay, this.player, () => this.hide())];
      case "scenario":
        return [scenario(replay)];
      default:
        return [facts(replay), resultTable(replay), bodyTable(replay)];
    }
  }
}
