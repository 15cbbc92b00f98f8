// What is said first of a packing session.

import { describe, expect, it } from "vitest";
import { completeHeader, type Header, type ResultBox } from "../../src/replay/header";
import { nameOf, summarizeSession } from "../../src/replay/session";

const box = (id: string, state: string, events = 1): ResultBox => ({
  id, state, up: "Z", pose: null, events: Array.from({ length: events }, () => ({ kind: "seal", time: 1, text: "" })),
});
const body = (name: string, type: string): Header["bodies"][number] => ({ name, type, kind: "dynamic", mass: 1, com: [0, 0, 0], shapes: [] });

function header(more: Partial<Header> = {}): Header {
  return completeHeader({
    format: "snug replay", version: 1, settings: { agent: "contact-aware", ended: "all items came" },
    speed: { duration_s: 720, wall_s: 1, real_time_factor: 720 },
    bodies: [body("BOX001", "B3"), body("BOX004", "B1")],
    events: [
      { time: 9, kind: "refused", body: "BOX004", text: "no place: too high", numbers: {} },
      { time: 3, kind: "recovery", body: "BOX001", text: "no seal: pick again (2 mm beside)", numbers: {} },
      { time: 4, kind: "recovery", body: "BOX001", text: "no seal: pick again", numbers: {} },
      { time: 5, kind: "recovery", body: "BOX002", text: "off its place: push", numbers: {} },
    ],
    result: {
      boxes: [box("BOX001", "packed"), box("BOX002", "packed"), box("BOX003", "outside"), box("BOX004", "waiting", 0), box("BOX005", "waiting", 0)],
      filling_degree_percent: 61.25, packed: 2, failure: "", report_table7: null,
    },
    ...more,
  });
}

describe("summarizeSession", () => {
  it("counts what was packed of what came of what was ordered", () => {
    const summary = summarizeSession(header())!;
    expect([summary.packed, summary.came, summary.ordered, summary.lost]).toEqual([2, 4, 5, 1]);
    expect(summary.perHour).toBeCloseTo(10, 9);
    expect(summary.filling).toBe(61.25);
    expect(summary.ended).toBe("all items came");
  });

  it("names refusals by their article and says why", () => {
    expect(summarizeSession(header())!.refused).toEqual([{ id: "BOX004", article: "B1", reason: "no place: too high" }]);
    expect(nameOf("B1", "BOX004")).toBe("B1 BOX004");
    expect(nameOf("", "BOX004")).toBe("BOX004");
  });

  it("says what would help, places first, then the most frequent trouble", () => {
    const { help } = summarizeSession(header())!;
    expect(help[0]).toMatch(/^1 box of 5 had no place/);
    expect(help[1]).toMatch(/^no seal 2×: /);
    expect(help[2]).toMatch(/^off its place 1×: /);
    expect(summarizeSession(header({ events: [] }))!.help).toEqual([]);
  });

  it("is nothing for a program, and unknown numbers stay unknown", () => {
    expect(summarizeSession(header({ settings: { controller: "fast" } }))).toBeNull();
    const killed = summarizeSession(header({ result: null, speed: null, complete: false, settings: { agent: "margin" } }))!;
    expect([killed.filling, killed.perHour, killed.packed, killed.ordered]).toEqual([null, null, 0, 0]);
    expect(killed.ended).toBe("it did not finish");
    expect(summarizeSession(header({ result: { ...header().result!, failure: "protective stop" } }))!.ended).toBe("protective stop");
  });
});
