// Contacts of boxes that sleep: kept while nothing of the pair has moved, gone when it has, hangs on the cup or is awake.

import { describe, expect, it } from "vitest";
import { decodeReplay } from "../../src/replay/decode";
import { Replay } from "../../src/replay/replay";
import { RestingContacts } from "../../src/replay/resting";
import { encodeReplay, type ChannelInput } from "../support/encode";

const POSE = ["x", "y", "z", "qw", "qx", "qy", "qz"];
const FRAMES = 10;

/** A box on the floor, touching it at frames 0 and 1 only; it moves from frame `moves` on; `held` from that frame on. */
async function make(moves: number, held = FRAMES, awakeAt = -1): Promise<Replay> {
  const rows = Array.from({ length: FRAMES }, (_, i) => i);
  const touches = (i: number): boolean => i < 2 || i === awakeAt;
  const one = (name: string, values: number[][], columns = ["value"], quantum = 1): ChannelInput => ({ name, columns, quantum, rows: values });
  const channels: ChannelInput[] = [
    one("time", rows.map((i) => [0.01 * i]), ["t"], 1e-6),
    one("body.0.pose", [[0, 0, 0, 1, 0, 0, 0]], POSE, 1e-5),
    one("body.1.pose", rows.map((i) => [i >= moves ? 1e-4 : 0, 0, 0.1, 1, 0, 0, 0]), POSE, 1e-5),
    one("cup.attached_body", rows.map((i) => [i >= held ? 1 : -1])),
    one("contacts.frame_first", rows.map(() => [0])),
    one("contacts.frame_count", rows.map((i) => [touches(i) ? 1 : 0])),
    one("contacts.frame_block", [[0]]),
    one("contacts.block_body", [[0, 1]], ["a", "b"]),
    one("contacts.block_first", [[0]]),
    one("contacts.block_count", [[2]]),
    one("contacts.point", [[0, 0, 0], [0.1, 0, 0]], ["x", "y", "z"], 1e-4),
    one("contacts.normal", [[0, 0, 1], [0, 0, 1]], ["x", "y", "z"], 1e-3),
    one("contacts.force", [[0, 0, 5], [0, 0, 5]], ["x", "y", "z"], 1e-2),
  ];
  const body = (kind: string): object => ({ name: kind, type: "", kind, mass: 1, com: [0, 0, 0], shapes: [] });
  return new Replay(await decodeReplay(encodeReplay({ format: "snug replay", version: 1, frames: FRAMES, bodies: [body("static"), body("dynamic")] }, channels)));
}

function pointsAt(resting: RestingContacts, frame: number): number {
  let points = 0;
  resting.forEach(frame, () => ++points);
  return points;
}

describe("RestingContacts", () => {
  it("keeps the contacts of a box that stays where it was when they were recorded last", async () => {
    const resting = new RestingContacts(await make(6));
    expect([0, 1, 2, 5].map((frame) => pointsAt(resting, frame))).toEqual([0, 0, 2, 2]); // 0 and 1: recorded, not repeated
    expect([6, 9].map((frame) => pointsAt(resting, frame))).toEqual([0, 0]); // it has moved by ten quanta
    expect(pointsAt(resting, 3)).toBe(2); // in any order
  });

  it("has none of a box that the cup holds, or that is awake", async () => {
    expect(pointsAt(new RestingContacts(await make(FRAMES, 4)), 3)).toBe(2);
    expect(pointsAt(new RestingContacts(await make(FRAMES, 4)), 4)).toBe(0);
    const wakes = new RestingContacts(await make(FRAMES, FRAMES, 7));
    expect([6, 7, 8].map((frame) => pointsAt(wakes, frame))).toEqual([2, 0, 2]);
  });

  it("has none in a recording without contacts", async () => {
    const bytes = encodeReplay({ format: "snug replay", version: 1, frames: 2 }, [{ name: "time", columns: ["t"], quantum: 1e-6, rows: [[0], [1]] }]);
    expect(pointsAt(new RestingContacts(new Replay(await decodeReplay(bytes))), 1)).toBe(0);
  });
});
