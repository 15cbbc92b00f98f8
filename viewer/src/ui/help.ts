// Help: what the keys do and what the drawing means.

import type { Palette } from "../scene/palette";
import { make } from "./dom";

const KEYS: [string, string][] = [
  ["space", "play, pause"],
  ["← →", "one frame; with shift one second"],
  ["[ ]", "event before, next event"],
  ["- +", "slower, faster"],
  ["1 2 3 4", "cell, top, side, tool camera"],
  ["home end", "start, end"],
  ["d", "light or dark"],
  ["?", "this help"],
];

export function helpOverlay(palette: () => Palette): HTMLElement {
  const overlay = make("div", "help");
  overlay.hidden = true;
  const fill = (): void => {
    const p = palette();
    const keys = make("dl");
    for (const [key, what] of KEYS) keys.append(make("dt", "", key), make("dd", "", what));
    const legend = make("ul", "legend");
    for (const [colour, what] of [
      [p.sticking, "contact that sticks, and its force"],
      [p.sliding, "contact that slides, and its force"],
      [p.open, "contact that is open"],
      [p.cupWrench, "force of the cup on the box"],
      [p.flangeWrench, "force on the flange"],
      [p.ghost, "where the command has the tool and the held box"],
      [p.trace, "trace: shift-click a corner of a box"],
    ] as const) {
      const swatch = make("i", "swatch");
      swatch.style.background = colour;
      legend.append(make("li", "", swatch, what));
    }
    overlay.replaceChildren(make("div", "card", make("h2", "", "Keys"), keys, make("h2", "", "Colours"), legend,
      make("p", "", "Drag to turn, right drag to move, wheel to zoom. Click a box to select it and plot its pose. In a plot: click sets the time, drag zooms, double click shows all. W world, T container, E gripper end, S cup lip, P held or selected box.")));
  };
  overlay.addEventListener("click", () => (overlay.hidden = true));
  overlay.addEventListener("snug:show", () => {
    fill();
    overlay.hidden = !overlay.hidden;
  });
  return overlay;
}
