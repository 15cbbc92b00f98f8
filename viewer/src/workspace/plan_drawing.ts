// Plan drawing: the container from above and from the side, where boxes were planned beside where they are perceived.

import type { Decision } from "./api";
import { make } from "./dom";

const SVG = "http://www.w3.org/2000/svg";
const WIDE = 300; // units of the longest side

type Size = [number, number, number];
interface Box {
  item: string;
  planned: Size;
  perceived: Size | null;
  extent: Size;
}

/** What the decisions so far left in the container: of each item the last one, without those that are not in it. */
export function boxesOf(decisions: Decision[]): Box[] {
  const boxes = new Map<string, Box>();
  for (const { item, planned, happened, extent_mm: extent, end } of decisions) {
    boxes.delete(item);
    const isOut = end !== "" && !["placed", "accepted", "rejected"].includes(end);
    if (planned && extent && !isOut) boxes.set(item, { item, planned: planned.position_mm, perceived: happened?.position_mm ?? null, extent });
  }
  return [...boxes.values()];
}

function rectangle(className: string, centre: Size, extent: Size, [i, j]: [number, number], isUp: boolean, height: number): SVGRectElement {
  const element = document.createElementNS(SVG, "rect");
  const low = centre[j]! - extent[j]! / 2, high = centre[j]! + extent[j]! / 2;
  element.setAttribute("x", String(centre[i]! - extent[i]! / 2));
  element.setAttribute("y", String(isUp ? height - high : -high));
  element.setAttribute("width", String(extent[i]!));
  element.setAttribute("height", String(high - low));
  element.setAttribute("class", className);
  return element;
}

function view(label: string, boxes: Box[], size: Size, axes: [number, number]): HTMLElement {
  const [i, j] = axes;
  const isUp = j === 2;
  const svg = document.createElementNS(SVG, "svg");
  const scale = WIDE / Math.max(size[0], size[1]);
  const margin = 0.04 * Math.max(...size);
  svg.setAttribute("viewBox", `${-size[i]! / 2 - margin} ${isUp ? -margin : -size[j]! / 2 - margin} ${size[i]! + 2 * margin} ${size[j]! + 2 * margin}`);
  svg.setAttribute("width", String((size[i]! + 2 * margin) * scale));
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", `${label}: ${boxes.length} boxes, planned and perceived`);
  const wall = document.createElementNS(SVG, "rect");
  wall.setAttribute("x", String(-size[i]! / 2));
  wall.setAttribute("y", String(isUp ? 0 : -size[j]! / 2));
  wall.setAttribute("width", String(size[i]!));
  wall.setAttribute("height", String(size[j]!));
  wall.setAttribute("class", "wall");
  svg.append(wall);
  // Those that are nearer to the eye are drawn later.
  const depth = isUp ? 1 : 2;
  for (const box of [...boxes].sort((a, b) => (isUp ? b.planned[depth] - a.planned[depth] : a.planned[depth] - b.planned[depth]))) {
    if (box.perceived) svg.append(rectangle("perceived", box.perceived, box.extent, axes, isUp, size[2]));
    svg.append(rectangle("planned", box.planned, box.extent, axes, isUp, size[2]));
  }
  return make("figure", "", svg, make("figcaption", "", label));
}

export function drawPlan(decisions: Decision[], size: Size | null): HTMLElement {
  const boxes = boxesOf(decisions);
  if (!size) return make("div", "plan");
  return make("div", "plan", view("From above", boxes, size, [0, 1]), view("From the side", boxes, size, [0, 2]),
    make("p", "hint", make("span", "mark perceived"), "as perceived ", make("span", "mark planned"), "as planned"));
}
