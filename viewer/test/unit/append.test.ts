// A run in parts is the run in one piece: poses, contacts, events.

import { describe, expect, it } from "vitest";
import { decodeReplay } from "../../src/replay/decode";
import { Replay } from "../../src/replay/replay";
import { encodeReplay, type ChannelInput } from "../support/encode";

/** Frame i has i % 4 points in one block of bodies 0 and 1; points are numbered through by their x. */
function form(first: number, last: number): Uint8Array {
  const frames = Array.from({ length: last - first }, (_, k) => first + k);
  const table: Record<string, number[][]> = { first: [], count: [], block: [], bodies: [], begin: [], points: [], x: [] };
  for (const i of frames) {
    table.first!.push([table.block!.length]);
    table.count!.push([i % 4 ? 1 : 0]);
    if (i % 4 === 0) continue;
    table.block!.push([table.bodies!.length]);
    table.bodies!.push([0, 1]);
    table.begin!.push([table.x!.length]);
    table.points!.push([i % 4]);
    for (let k = 0; k < i % 4; ++k) table.x!.push([0.1 * i + 0.001 * k, 0, 0]);
  }
  const channel = (name: string, columns: string[], quantum: number, rows: number[][]): ChannelInput => ({ name, columns, quantum, rows });
  const xyz = ["x", "y", "z"];
  return encodeReplay(
    {
      format: "snug replay", version: 1, frames: frames.length, events: [{ time: first, kind: "seal", body: "b", text: "", numbers: {} }],
      bodies: [{ name: "a", kind: "static", shapes: [] }, { name: "b", kind: "dynamic", shapes: [] }],
    },
    [
      channel("time", ["t"], 1e-6, frames.map((i) => [0.01 * i])),
      channel("body.0.pose", ["x", "y", "z", "qw", "qx", "qy", "qz"], 1e-5, [[1, 2, 3, 1, 0, 0, 0]]),
      channel("contacts.frame_first", ["v"], 1, table.first!),
      channel("contacts.frame_count", ["v"], 1, table.count!),
      channel("contacts.frame_block", ["v"], 1, table.block!),
      channel("contacts.block_body", ["a", "b"], 1, table.bodies!),
      channel("contacts.block_first", ["v"], 1, table.begin!),
      channel("contacts.block_count", ["v"], 1, table.points!),
      channel("contacts.point", xyz, 1e-4, table.x!),
      channel("contacts.normal", xyz, 1e-3, table.x!.map(() => [0, 0, 1])),
      channel("contacts.force", xyz, 1e-2, table.x!.map(() => [0, 0, 1])),
    ],
  );
}

function contactsOf(replay: Replay): number[][] {
  return Array.from({ length: replay.frames }, (_, frame) => {
    const xs: number[] = [];
    replay.forEachContact(frame, (point, a, b) => xs.push(Math.round(1e4 * replay.contacts!.point.at(0, point)), a, b));
    return xs;
  });
}

describe("a run in parts", () => {
  it("has the contacts, times and events of the run in one piece", async () => {
    const whole = new Replay(await decodeReplay(form(0, 700)));
    const parts = new Replay(await decodeReplay(form(0, 0)));
    let from = 0;
    for (const to of [1, 2, 5, 300, 301, 700]) {
      parts.append(await decodeReplay(form(from, to)));
      from = to;
    }
    expect(parts.frames).toBe(700);
    expect(contactsOf(parts)).toEqual(contactsOf(whole));
    for (const frame of [0, 1, 4, 299, 300, 699]) expect(parts.timeOf(frame)).toBe(whole.timeOf(frame));
    expect(parts.frameAt(6.995)).toBe(699);
    expect(parts.header.events.map((e) => e.time)).toEqual([0, 0, 1, 2, 5, 300, 301]);
    expect(parts.channel("body.0.pose")!.rows).toBe(1);
  });

  it("refuses a part with a channel that the beginning does not have", async () => {
    const start = await decodeReplay(form(0, 0));
    start.channels.delete("contacts.gap");
    const replay = new Replay(start);
    const part = await decodeReplay(form(0, 2));
    part.channels.set("news", part.channels.get("time")!);
    expect(() => replay.append(part)).toThrow(/news/);
  });
});
