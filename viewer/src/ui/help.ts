// Help: what the keys do and what the drawing means.

import type { Palette } from "../scene/palette";
import { make } from "./dom";

const KEYS: [string, string][] = [
  ["space", "play, pause"],
  ["← →", "one frame; with shift one second"],
  ["[ ]", "event before, next event"],
  ["- +", "slower, faster"],
  ["home end", "start, end"],
  ["g", "go to a time"],
  ["1 2 3 4", "cell, top, side, tool camera"],
  ["f", "frames with their letters"],
  ["r x", "the robot; see-through boxes"],
  ["i", "about this run: settings, program, scenario"],
  ["c", "container at the end, from above and the side"],
  ["w", "wide plots, or the usual column"],
  ["m", "measure: the distance between two points that are clicked"],
  ["s", "section: cut the container open along x, y, z, or not"],
  ["d", "light or dark"],
  ["p n", "live: pause or resume the run; one frame of it"],
  ["? esc", "this help; close"],
];

const MOUSE: [string, string][] = [
  ["drag", "turn; with the right button move; wheel zooms"],
  ["click a box", "select it: its plots, its events, its planned place"],
  ["shift-click", "trace of the corner of the box"],
  ["plot", "hover reads numbers, click sets the time, drag zooms, ↩ goes back, double click shows the whole run; the list chooses a window that follows the time"],
  ["drop a file", "a recording (.h5) or a report (.html): opens it, or lays it over this run"],
];

export function helpOverlay(palette: () => Palette): HTMLElement {
  const overlay = make("div", "overlay help");
  overlay.hidden = true;
  const fill = (): void => {
    const p = palette();
    const listOf = (rows: [string, string][]): HTMLElement => make("dl", "", ...rows.flatMap(([key, what]) => [make("dt", "", key), make("dd", "", what)]));
    const legend = make("ul", "legend");
    for (const [colour, what] of [
      [p.sticking, "contact that sticks, and its force"],
      [p.sliding, "contact that slides, and its force"],
      [p.open, "contact that separates"],
      [p.cupWrench, "force of the cup on the box"],
      [p.flangeWrench, "force on the flange"],
      [p.ghost, "dashed: where the command has the tool and the held box"],
      [p.select, "dashed, a ghost while the box is carried: its planned place, where the command would have put it when the vacuum was switched off, the cup undeformed"],
      [p.trace, "trace: shift-click a corner of a box"],
    ] as const) {
      const swatch = make("i", "swatch");
      swatch.style.background = colour;
      legend.append(make("li", "", swatch, what));
    }
    const left = make("div", "", make("h2", "", "Keys"), listOf(KEYS));
    const right = make("div", "", make("h2", "", "Mouse"), listOf(MOUSE), make("h2", "", "Colours"), legend,
      make("p", "hint", "Contacts of boxes that sleep stand as they were last; recordings of older versions do not have them: they are drawn fainter. An arrow at a contact is the force on the box."),
      make("h2", "", "Frames"), make("p", "", "W world, T container, A aligner, C conveyor, E end of the gripper, S lip of the cup, P held or selected box."));
    overlay.replaceChildren(make("div", "card wide", make("div", "columns", left, right)));
  };
  overlay.addEventListener("click", () => (overlay.hidden = true));
  overlay.addEventListener("snug:show", () => {
    fill();
    overlay.hidden = !overlay.hidden;
  });
  return overlay;
}
