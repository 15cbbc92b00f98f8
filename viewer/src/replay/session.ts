// Session: what somebody who pays for a packing cell asks of a run first, from the header of its recording.

import type { Header } from "./header";

export interface Refusal {
  id: string;
  /** What the box is; empty where the orders do not say. */
  article: string;
  reason: string;
}

export interface SessionSummary {
  filling: number | null;
  perHour: number | null;
  /** Boxes: packed; that came to the cell; of the order; that left the hand elsewhere. */
  packed: number;
  came: number;
  ordered: number;
  lost: number;
  ended: string;
  refused: Refusal[];
  /** What would help, in order of what it costs. */
  help: string[];
}

/** What a trouble that the session reports says about the cell. */
const ADVICE: Record<string, string> = {
  "no seal": "look at the cup's lip and at the surfaces that it takes boxes by",
  "vacuum lost": "look at the cup's lip and at the surfaces that it takes boxes by",
  "hold guard": "a lower tempo (--tempo) or a larger cup holds more",
  "force guard": "boxes are larger, or stand elsewhere, than the scenario says: measure them (snug identify, snug perceive)",
  "off its place": "boxes are larger, or stand elsewhere, than the scenario says: measure them (snug identify, snug perceive)",
  "neighbour moved": "boxes are larger, or stand elsewhere, than the scenario says: measure them (snug identify, snug perceive)",
  "protective stop": "the robot's limits end motions: a lower tempo (--tempo), or another place of the container",
  "view blocked": "something stands between camera and container",
  "bad picture": "the camera gives too few points",
};

const counted = (count: number, one: string, many: string): string => `${count} ${count === 1 ? one : many}`;

function articleOf(header: Header, id: string): string {
  return header.bodies.find((body) => body.name === id)?.type ?? "";
}

/** "B3 BOX025": what it is before which one it is. */
export const nameOf = (article: string, id: string): string => (article ? `${article} ${id}` : id);

/** Troubles that the session reported, and how often. */
function troublesOf(header: Header): Map<string, number> {
  const troubles = new Map<string, number>();
  for (const event of header.events) {
    if (event.kind !== "recovery") continue;
    const trouble = event.text.split(":")[0]!.trim();
    troubles.set(trouble, (troubles.get(trouble) ?? 0) + 1);
  }
  return troubles;
}

function helpOf(header: Header, refused: Refusal[], ordered: number): string[] {
  const help: string[] = [];
  if (refused.length > 0) {
    help.push(`${counted(refused.length, "box of", "boxes of")} ${ordered} had no place: a larger container, another order, or more boxes to choose from`);
  }
  const advice = new Map<string, string[]>();
  for (const [trouble, count] of [...troublesOf(header)].sort((a, b) => b[1] - a[1])) {
    const said = ADVICE[trouble];
    if (said) advice.set(said, [...(advice.get(said) ?? []), `${trouble} ${count}×`]);
  }
  for (const [said, troubles] of advice) help.push(`${troubles.join(", ")}: ${said}`);
  return help;
}

/** Null for what is no packing session: a program or a scene that was simulated. */
export function summarizeSession(header: Header): SessionSummary | null {
  const { result, settings, events } = header;
  if (typeof settings?.agent !== "string") return null;
  const refused = events
    .filter((event) => event.kind === "refused")
    .map((event): Refusal => ({ id: event.body, article: articleOf(header, event.body), reason: event.text }));
  const boxes = result?.boxes ?? [];
  const isRefused = new Set(refused.map(({ id }) => id));
  const came = boxes.filter((box) => isRefused.has(box.id) || (box.state !== null && box.state !== "waiting") || box.events.length > 0);
  const packed = boxes.filter((box) => box.state === "packed").length;
  const lost = boxes.filter((box) => box.state !== null && box.state !== "packed" && box.state !== "waiting").length;
  const seconds = header.speed?.duration_s ?? 0;
  const ended = result?.ended_by || (typeof settings.ended === "string" ? settings.ended : ""); // older recordings: in the settings
  return {
    filling: result?.filling_degree_percent ?? null,
    perHour: seconds > 0 ? (3600 * packed) / seconds : null,
    packed, came: came.length, ordered: boxes.length, lost,
    ended: result?.failure || ended || (header.interrupted ? "ended early by a viewer" : header.complete ? "in order" : "it did not finish"),
    refused, help: helpOf(header, refused, boxes.length),
  };
}
