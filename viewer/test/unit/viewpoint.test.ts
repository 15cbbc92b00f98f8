// From where the cell is seen: over what stands before the container, and as usual where nothing does.

import { describe, expect, it } from "vitest";
import { decodeReplay } from "../../src/replay/decode";
import { Replay } from "../../src/replay/replay";
import { chooseDirection } from "../../src/scene/viewpoint";
import { encodeReplay, type ChannelInput } from "../support/encode";

const POSE = ["x", "y", "z", "qw", "qx", "qy", "qz"];
const AT_ORIGIN = [0, 0, 0, 1, 0, 0, 0];

/** A container sunk into the ground, a box in it, and a wall at a place. */
async function cell(wall: number[] | null): Promise<Replay> {
  const rows = [0, 1];
  const box = (half: number[]): object => ({ kind: "box", pose: AT_ORIGIN, half });
  const bodies = [
    { name: "item", type: "", kind: "dynamic", mass: 1, com: [0, 0, 0], shapes: [box([0.05, 0.05, 0.05])] },
    ...(wall ? [{ name: "wall", type: "", kind: "static", mass: 0, com: [0, 0, 0], shapes: [box([0.8, 0.02, 0.6])] }] : []),
  ];
  const channels: ChannelInput[] = [
    { name: "time", columns: ["t"], quantum: 1e-6, rows: rows.map((k) => [0.1 * k]) },
    { name: "body.0.pose", columns: POSE, quantum: 1e-5, rows: rows.map(() => [0, 0, 0.1, 1, 0, 0, 0]) },
    ...(wall ? [{ name: "body.1.pose", columns: POSE, quantum: 1e-5, rows: [[...wall, 1, 0, 0, 0]] }] : []),
  ];
  const container = { name: "tote", pose: [AT_ORIGIN, AT_ORIGIN], inner_size: [0.4, 0.3, 0.2] };
  return new Replay(await decodeReplay(encodeReplay({ format: "snug replay", version: 1, frames: 2, bodies, container }, channels)));
}

describe("chooseDirection", () => {
  it("is the usual one where nothing is in the way", async () => {
    const direction = chooseDirection(await cell(null));
    expect(direction.length()).toBeCloseTo(1, 9);
    expect(direction.y).toBeLessThan(-0.5);
    expect(direction.z).toBeGreaterThan(0.5);
  });

  it("goes round a wall that stands before the container", async () => {
    const replay = await cell([0, -0.35, 0.3]);
    const direction = chooseDirection(replay);
    // Over its top, 0.9 m up and 0.35 m before the middle, one would have to look down by more than is tried.
    expect(direction.y).toBeGreaterThan(-0.3);
  });
});
