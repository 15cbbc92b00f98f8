// Summary: what ran, how fast, and how full the container got beside what the report states.

import type { Replay } from "../replay/replay";
import type { View } from "../scene/view";
import { make } from "./dom";

/** A period in ms with the digits that it has: 1, 0.5, 8. */
export const milliseconds = (period: number): string => String(Number((1000 * period).toPrecision(6)));

export function headline(replay: Replay): HTMLElement {
  const { header: h } = replay;
  const title = h.sequence ? `sequence ${h.sequence}` : h.scenario.name || h.name;
  const bar = make("div", "headline", make("b", "", "snug"), make("span", "title", title));
  const add = (label: string, value: string, hint = "", kind = ""): void => {
    const item = make("span", `fact ${kind}`.trim(), make("small", "", label), value);
    item.title = hint;
    bar.append(item);
  };
  const { result, speed } = h;
  if (result?.packed !== null && result?.packed !== undefined && result.boxes.length > 0) add("packed", `${result.packed} of ${result.boxes.length}`);
  if (result?.filling_degree_percent !== null && result?.filling_degree_percent !== undefined && result.boxes.length > 0) {
    const table = result.report_table7;
    add("filling degree", `${result.filling_degree_percent.toFixed(2)} %`, "Volume of the packed boxes over that of the container (report eq. 1)");
    const beside = table?.same_boxes_percent ?? table?.filling_percent ?? null;
    if (table && beside !== null) {
      const counted = table.same_boxes_percent === null ? "." : `; counted as here, by sizes and container, its boxes fill ${beside.toFixed(2)} %.`;
      const who = agentsOf(table)[0]!;
      add("reported", `${beside.toFixed(2)} %`, `${who.agent}${who.about ? `, ${who.about}` : ""}: ${table.filling_percent} % as printed${counted}`);
    }
  }
  add("simulated", `${(speed?.duration_s ?? replay.end - replay.start).toFixed(1)} s`, "", "middle");
  if (speed && speed.wall_s > 0) add("speed", `${speed.real_time_factor.toFixed(0)}× real time`, `${speed.wall_s.toFixed(2)} s of computing`, "minor");
  add("step", `${milliseconds(h.dt)} ms`, `recorded every ${milliseconds(h.record_period)} ms, ${replay.frames} frames`, "minor");
  add("seed", h.seed || "-", "of everything random", "minor");
  add("version", h.snug_version || "-", `snug ${h.snug_version}: ${h.name}, scenario ${h.scenario.name}`, "minor version");
  return bar;
}

/** What went wrong and what to beware of. */
export function warningsOf(replay: Replay): string[] {
  const { result } = replay.header;
  return [...(result?.failure ? [result.failure] : []), ...(result?.warnings ?? []), ...replay.warnings];
}

/** The warnings as one line below the headline; null when there is nothing to say. */
export function warningLine(replay: Replay, onOpen: () => void): HTMLElement | null {
  const warnings = warningsOf(replay);
  if (warnings.length === 0) return null;
  const more = warnings.length > 1 ? ` (and ${warnings.length - 1} more)` : "";
  const line = make("button", "warnings warning", `${warnings[0]!}${more}`);
  line.type = "button";
  line.title = warnings.join("\n");
  line.addEventListener("click", onOpen);
  return line;
}

type Table7 = NonNullable<NonNullable<Replay["header"]["result"]>["report_table7"]>;

/** Who reached what with the sequence before, the one that runs are compared with first. */
function agentsOf(table: Table7): { agent: string; about?: string; filling_percent: number }[] {
  if (table.agents?.length) return table.agents;
  return [{ agent: table.agent ?? "the report", filling_percent: table.filling_percent }];
}

/** Filling degree of this run beside those that others reported, as bars; null when there is neither. */
export function fillBars(replay: Replay, second: Replay | null, isLarge = false): HTMLElement | null {
  const { result } = replay.header;
  const ours = result?.boxes.length ? (result.filling_degree_percent ?? null) : null;
  const table = result?.report_table7 ?? null;
  if (ours === null && !table) return null;
  const rows: FillRow[] = [];
  if (ours !== null) {
    const boxes = result?.packed === null || result?.packed === undefined ? "" : `${result.packed} box${result.packed === 1 ? "" : "es"}`;
    rows.push({ name: "this run", about: boxes, percent: ours, isOurs: true, hint: "Volume of the packed boxes over that of the container (report eq. 1)" });
  }
  const theirs = second?.header.result?.filling_degree_percent ?? null;
  if (theirs !== null) rows.push({ name: "laid over it", about: second!.header.name, percent: theirs, isOurs: true, hint: "Counted as this run" });
  agentsOf(table ?? { filling_percent: 0, boxes: null, same_boxes_percent: null }).forEach(({ agent, about, filling_percent }, k) => {
    if (!table) return;
    rows.push({ name: agent, about: about || "as its source states it", percent: filling_percent, isOurs: false, hint: `Reported of ${agent}${about ? ` (${about})` : ""}, as its source states it` });
    if (k > 0 || table.same_boxes_percent === null) return;
    const boxes = table.boxes === null ? "the same boxes" : `the same ${table.boxes} boxes`;
    rows.push({ name: "", about: `${boxes}, counted as this run`, percent: table.same_boxes_percent, isOurs: false, hint: `What the boxes of ${agent} fill by the sizes and the container of the scenario` });
  });
  const bars = make("div", isLarge ? "fill large" : "fill");
  for (const { name, about, percent, isOurs, hint } of rows) {
    const bar = make("i", isOurs ? "ours" : "");
    bar.style.width = `${Math.min(100, percent)}%`;
    const words = make("span", "name", ...(name ? [make("b", "", name), " "] : []), make("small", "", about));
    const row = make("div", "fill-row", words, make("span", "gauge", bar), make("span", "value", `${percent.toFixed(2)} %`));
    row.title = hint;
    bars.append(row);
  }
  if (isLarge && table) bars.append(make("p", "note", "Rows of others show what their source states. \"Counted as this run\" means sizes of the boxes over the inner size of the container."));
  return bars;
}

interface FillRow {
  name: string;
  about: string;
  percent: number;
  isOurs: boolean;
  hint: string;
}

/** How full the container got, and how it looks at the end from above and from the side, as in the report's Figure 20. */
export function endPanel(replay: Replay, second: Replay | null, view: View, onOpen: () => void): HTMLElement | null {
  const bars = fillBars(replay, second);
  if (!replay.header.container && !bars) return null;
  const panel = make("section", "end");
  if (bars) panel.append(make("h2", "", "Filling degree"), bars);
  if (!replay.header.container) return panel;
  const [top, side] = [make("canvas"), make("canvas")];
  [top.width, top.height, side.width, side.height] = [226, 160, 226, 160];
  const pictures = make("button", "pictures", make("figure", "", top, make("figcaption", "", "from above")), make("figure", "", side, make("figcaption", "", "from the side")));
  pictures.type = "button";
  pictures.title = "Container at the end: larger (c)";
  pictures.addEventListener("click", onOpen);
  panel.append(make("h2", "pictures-title", replay.header.complete ? "Container at the end" : "Container so far"), pictures);
  panel.addEventListener("snug:draw", () => {
    view.drawContainer(top, "top", replay.frames - 1);
    view.drawContainer(side, "side", replay.frames - 1);
  });
  return panel;
}
