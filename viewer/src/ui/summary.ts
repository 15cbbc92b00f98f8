// Summary: what ran, how fast, and how full the container got beside what the report states.

import type { Replay } from "../replay/replay";
import type { View } from "../scene/view";
import { make } from "./dom";

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
    const beside = table?.same_boxes_percent ?? null;
    add(
      "filling degree",
      `${result.filling_degree_percent.toFixed(2)} %`,
      table
        ? `The report's Table 7 states ${table.filling_percent} % for ${table.boxes} boxes` +
            (beside === null ? "." : `; by sizes and container those boxes fill ${beside.toFixed(2)} %.`)
        : "Volume of the packed boxes over that of the container (report eq. 1)",
    );
    if (table) add("report", `${(beside ?? table.filling_percent).toFixed(2)} %`, `Table 7 states ${table.filling_percent} %`);
  }
  add("simulated", `${(speed?.duration_s ?? replay.end - replay.start).toFixed(1)} s`);
  if (speed) add("speed", `${speed.real_time_factor.toFixed(0)}× real time`, `${speed.wall_s.toFixed(2)} s of computing`);
  add("step", `${(1000 * h.dt).toFixed(0)} ms`, `recorded every ${(1000 * h.record_period).toFixed(0)} ms, ${replay.frames} frames`);
  add("seed", h.seed || "-");
  add("version", h.snug_version || "-", `${h.name}, scenario ${h.scenario.name}`);
  if (result?.failure) bar.append(make("span", "warning", result.failure));
  for (const warning of replay.warnings) bar.append(make("span", "warning", warning));
  return bar;
}

/** The container at the end, from above and from the side, as in the report's Figure 20. */
export function endPanel(replay: Replay, view: View): HTMLElement | null {
  if (!replay.header.container) return null;
  const panel = make("section", "end", make("h2", "", "Container at the end"));
  const { top, side } = { top: make("canvas"), side: make("canvas") };
  top.width = side.width = 232;
  top.height = 165;
  side.height = 110;
  panel.append(make("figure", "", top, make("figcaption", "", "from above")), make("figure", "", side, make("figcaption", "", "from the side")));
  const draw = (): void => {
    view.drawContainer(top, "top", replay.frames - 1);
    view.drawContainer(side, "side", replay.frames - 1);
  };
  panel.addEventListener("snug:draw", draw);
  return panel;
}
