// Reach count: a layer of the map of what is reached, in numbers.

import type { ReachMap } from "./api";

const MOST_REASONS = 4;

/** How many points of a layer have which verdict, and what keeps the tool away from most of them. */
export function countLayer(map: ReachMap, layer: number): { verdicts: number[]; reasons: [string, number][] } {
  const shown = map.layers[layer]!;
  const verdicts = map.verdicts.map((_, k) => shown.verdicts.filter((one) => one === k).length);
  const reasons = new Map<string, number>();
  shown.verdicts.forEach((verdict, i) => {
    const what = map.whats[shown.whats[i]!]!;
    if (verdict === 0 || what === "") return;
    const text = `${map.verdicts[verdict]}: ${what}`;
    reasons.set(text, (reasons.get(text) ?? 0) + 1);
  });
  return { verdicts, reasons: [...reasons].sort((a, b) => b[1] - a[1]).slice(0, MOST_REASONS) };
}
