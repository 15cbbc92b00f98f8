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
  const add = (label: string, value: string, hint = ""): void => {
    const item = make("span", "fact", make("small", "", label), value);
    item.title = hint;
    bar.append(item);
  };
  const { result, speed } = h;
  if (result?.packed !== null && result?.packed !== undefined) add("packed", `${result.packed} of ${result.boxes.length}`);
  if (result?.filling_degree_percent !== null && result?.filling_degree_percent !== undefined) {
    const table = result.report_table7;
    add("filling degree", `${result.filling_degree_percent.toFixed(2)} %`, "Volume of the packed boxes over that of the container (report eq. 1)");
    const beside = table?.same_boxes_percent ?? table?.filling_percent ?? null;
    if (table && beside !== null) {
      const counted = table.same_boxes_percent === null ? "." : `; counted as here, by sizes and container, its boxes fill ${beside.toFixed(2)} %.`;
      add("report", `${beside.toFixed(2)} %`, `Reported: ${table.filling_percent} %${counted}`);
    }
  }
  add("simulated", `${(speed?.duration_s ?? replay.end - replay.start).toFixed(1)} s`);
  if (speed) add("speed", `${speed.real_time_factor.toFixed(0)}× real time`, `${speed.wall_s.toFixed(2)} s of computing`);
  add("step", `${milliseconds(h.dt)} ms`, `recorded every ${milliseconds(h.record_period)} ms, ${replay.frames} frames`);
  add("seed", h.seed || "-");
  add("version", h.snug_version || "-", `${h.name}, scenario ${h.scenario.name}`);
  if (result?.failure) bar.append(make("span", "warning", result.failure));
  for (const warning of result?.warnings ?? []) bar.append(make("span", "warning", warning));
  for (const warning of replay.warnings) bar.append(make("span", "warning", warning));
  return bar;
}

/** Filling degree of this run beside those that others reported, as bars; null when there is neither. */
export function fillBars(replay: Replay, second: Replay | null, isLarge = false): HTMLElement | null {
  const { result } = replay.header;
  const ours = result?.filling_degree_percent ?? null;
  const table = result?.report_table7 ?? null;
  if (ours === null && !table) return null;
  const rows: [string, number, string, string][] = [];
  if (ours !== null) {
    const boxes = result?.packed === null || result?.packed === undefined ? "" : `, ${result.packed} boxes`;
    rows.push(["this run", ours, "ours", `Volume of the packed boxes over that of the container (report eq. 1)${boxes}`]);
  }
  const theirs = second?.header.result?.filling_degree_percent ?? null;
  if (theirs !== null) rows.push(["laid over it", theirs, "ours", `The same of ${second!.header.name}`]);
  if (table) {
    const boxes = table.boxes === null ? "" : `: ${table.boxes} boxes`;
    const own = table.agent ?? "the report";
    const agents = table.agents?.length ? table.agents : [{ agent: own, filling_percent: table.filling_percent }];
    for (const { agent, filling_percent } of agents) {
      const isSame = agent === own;
      rows.push([agent, filling_percent, "", `As reported${isSame ? boxes : ""}`]);
      if (!isSame || table.same_boxes_percent === null) continue;
      rows.push([`${agent}, as here`, table.same_boxes_percent, "", "What those boxes fill by their sizes and the container of the scenario, counted as this run is"]);
    }
  }
  const bars = make("div", isLarge ? "fill large" : "fill");
  for (const [name, percent, kind, hint] of rows) {
    const bar = make("i", kind);
    bar.style.width = `${Math.min(100, percent)}%`;
    const row = make("div", "fill-row", make("span", "name", name), make("span", "gauge", bar), make("span", "value", `${percent.toFixed(2)} %`));
    row.title = hint;
    bars.append(row);
  }
  if (isLarge && table) {
    bars.append(make("p", "note", "Rows of others are as they were reported." + (table.same_boxes_percent === null ? "" : " As here: the same boxes counted as those of this run, by their sizes over the inner size of the container.")));
  }
  return bars;
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
  panel.append(make("h2", "", replay.header.complete ? "Container at the end" : "Container so far"), pictures);
  panel.addEventListener("snug:draw", () => {
    view.drawContainer(top, "top", replay.frames - 1);
    view.drawContainer(side, "side", replay.frames - 1);
  });
  return panel;
}
