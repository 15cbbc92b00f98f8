// Reach: the map of what the robot reaches, in words and numbers beside the drawing.

import { api, type ReachMap } from "./api";
import { field, make, setChoices } from "./dom";
import type { Shell } from "./shell";
import { countLayer } from "./reach_count";
import { REACH_COLOURS } from "./stage";

const MOST_REASONS = 4;

export function makeReach(shell: Shell, draw: (map: ReachMap | null, layer: number) => void): {
  element: HTMLElement;
  load(name: string, text: string, isWanted: () => boolean): Promise<void>;
  clear(why: string): void;
  layer(): number;
} {
  const layers = make("select");
  const place = make("div", "reach");
  place.setAttribute("role", "status");
  const element = make("fieldset", "reached", make("legend", "", "What the robot reaches"), field("Height of the cup", layers), place);
  let map: ReachMap | null = null;

  function show(): void {
    const layer = Number(layers.value || 0);
    draw(map, layer);
    if (!map) return;
    const { verdicts, reasons } = countLayer(map, layer);
    const all = map.layers[layer]!.verdicts.length;
    const list = make("ul", "legend");
    verdicts.forEach((count, k) => {
      if (count === 0 && k > 0) return;
      const mark = make("span", "mark");
      mark.style.background = REACH_COLOURS[k]!;
      list.append(make("li", "", mark, `${map!.verdicts[k]}: ${count} of ${all}`));
    });
    const parts: Node[] = [list];
    if (reasons.length > 0) parts.push(make("p", "", "In the way: ", reasons.map(([text, count]) => `${text} (${count})`).join("; ")));
    const lost = map.picks.filter((pick) => pick.verdict > 0);
    const total = map.picks.length;
    if (total > 0 && lost.length === 0) parts.push(make("p", "", `All ${total} places of pick are reached.`));
    for (const pick of lost.slice(0, MOST_REASONS)) {
      const what = map.whats[pick.what]!;
      parts.push(make("p", "bad", `Pick of ${pick.item}${pick.count > 1 ? ` and ${pick.count - 1} more` : ""}: ${map.verdicts[pick.verdict]}${what ? `, ${what}` : ""}`));
    }
    place.replaceChildren(...parts);
  }

  layers.addEventListener("change", show);
  return {
    element,
    layer: () => Number(layers.value || 0),
    load: async (name, text, isWanted) => {
      place.classList.add("old");
      try {
        const found = await api.reach(name, text);
        if (!isWanted()) return;
        map = found;
        const before = layers.value;
        setChoices(layers, found.layers.map((one, k): [string, string] => [String(k), `${one.name} (${(1000 * one.height).toFixed(0)} mm)`]), before);
        show();
      } catch (error) {
        map = null;
        draw(null, 0);
        place.replaceChildren(make("p", "bad", shell.say(error)));
      }
      place.classList.remove("old");
    },
    clear: (why) => {
      map = null;
      draw(null, 0);
      setChoices(layers, []);
      place.replaceChildren(make("p", "", why));
    },
  };
}
