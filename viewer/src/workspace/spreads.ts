// Spreads: how sizes and masses of boxes are distributed.

import type { ItemLine } from "./api";

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
