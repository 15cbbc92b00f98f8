// Typical orders: boxes drawn by a seed as parcels of the trade are, as a CSV to begin with; and how sizes and masses are spread.

import type { ItemLine } from "./api";

/** Uniform in [0, 1), the same on every machine (mulberry32). */
export function random(seed: number): () => number {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), state | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

/** Outer sizes of folding boxes that shops stock, mm; assumed, none is a standard. */
const SIZES: [number, number, number][] = [
  [120, 100, 60], [150, 100, 70], [160, 120, 80], [180, 130, 90], [200, 150, 90], [200, 150, 120], [220, 160, 100], [250, 175, 100], [250, 200, 120], [300, 200, 120],
];
const DENSITY: [number, number] = [120, 350]; // kg/m^3, of packed goods

export interface Wanted {
  orders: number;
  boxes: number; // of an order, on average
  seed: number;
}

/** Orders of `boxes` give or take a third; smaller boxes are more frequent. */
export function typicalOrders({ orders, boxes, seed }: Wanted): string {
  const draw = random(seed);
  const masses = SIZES.map(([l, w, h]) => Math.max(0.05, ((l * w * h) / 1e9) * (DENSITY[0] + (DENSITY[1] - DENSITY[0]) * draw())).toFixed(2)); // of an article one
  const lines = ["order,article,length_mm,width_mm,height_mm,mass_kg,count"];
  for (let k = 1; k <= orders; ++k) {
    const count = Math.max(1, Math.round(boxes * (2 / 3 + (2 / 3) * draw())));
    const kinds = new Map<number, number>();
    for (let i = 0; i < count; ++i) {
      const which = Math.min(SIZES.length - 1, Math.floor(SIZES.length * draw() ** 1.5));
      kinds.set(which, (kinds.get(which) ?? 0) + 1);
    }
    for (const which of [...kinds.keys()].sort((a, b) => a - b)) {
      const [l, w, h] = SIZES[which]!;
      lines.push(`order-${k},box-${l}x${w}x${h},${l},${w},${h},${masses[which]},${kinds.get(which)}`);
    }
  }
  return lines.join("\n") + "\n";
}

export interface Histogram {
  low: number;
  high: number;
  counts: number[];
}

/** Of values with how often each comes, in `bins` parts between the least and the largest. */
export function histogram(values: [value: number, count: number][], bins = 10): Histogram {
  const low = Math.min(...values.map(([value]) => value)), high = Math.max(...values.map(([value]) => value));
  const counts = new Array<number>(high > low ? bins : 1).fill(0);
  for (const [value, count] of values) counts[high > low ? Math.min(bins - 1, Math.floor((bins * (value - low)) / (high - low))) : 0]! += count;
  return { low, high, counts };
}

const SVG = "http://www.w3.org/2000/svg";

/** A row of bars with the ends of its range. */
export function drawHistogram(label: string, unit: string, values: [number, number][], digits: number): HTMLElement {
  const { low, high, counts } = histogram(values);
  const most = Math.max(...counts);
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 200 60");
  svg.setAttribute("width", "200");
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", `${label}: ${counts.reduce((sum, one) => sum + one, 0)} boxes from ${low.toFixed(digits)} to ${high.toFixed(digits)} ${unit}`);
  counts.forEach((count, k) => {
    const bar = document.createElementNS(SVG, "rect");
    const height = (58 * count) / most;
    bar.setAttribute("x", String((200 / counts.length) * k + 1));
    bar.setAttribute("y", String(60 - height));
    bar.setAttribute("width", String(200 / counts.length - 2));
    bar.setAttribute("height", String(height));
    svg.append(bar);
  });
  const figure = document.createElement("figure");
  figure.className = "histogram";
  const caption = document.createElement("figcaption");
  caption.textContent = `${label}: ${low.toFixed(digits)} to ${high.toFixed(digits)} ${unit}`;
  figure.append(svg, caption);
  return figure;
}

/** How edges, volumes and masses of the lines are spread. */
export function drawSpreads(lines: ItemLine[]): HTMLElement[] {
  if (lines.length === 0) return [];
  const of = (value: (line: ItemLine) => number): [number, number][] => lines.map((line) => [value(line), line.count]);
  return [
    drawHistogram("Longest edge", "mm", of((line) => Math.max(...line.size_mm)), 0),
    drawHistogram("Volume", "l", of((line) => line.size_mm.reduce((product, edge) => product * edge, 1) / 1e6), 1),
    drawHistogram("Mass", "kg", of((line) => line.mass_kg), 2),
  ];
}
