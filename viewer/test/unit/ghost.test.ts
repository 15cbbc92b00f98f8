// Planned places: from the command at the release, the grasp and the undeformed cup; against poses worked out by hand.

import { describe, expect, it } from "vitest";
import { decodeReplay } from "../../src/replay/decode";
import { Replay } from "../../src/replay/replay";
import { Plans } from "../../src/scene/ghost";
import { encodeReplay, type ChannelInput } from "../support/encode";

const POSE = ["x", "y", "z", "qw", "qx", "qy", "qz"];
/** The tool points down: half a turn about x takes z of E to -z of W. */
const DOWN = [0, 1, 0, 0];

/** A tool 3 mm behind its command along x, a cup 10 mm shorter than at rest, a box 0.1 m below the lip; let go at 0.05 s.
 * With `off`, the vacuum is off from that row on, and the command rises from there although the lip still holds. */
async function make(off?: number): Promise<Replay> {
  const rows = Array.from({ length: 10 }, (_, i) => i);
  const channel = (name: string, values: number[][], columns = POSE, quantum = 1e-5): ChannelInput => ({ name, columns, quantum, rows: values });
  const x = (i: number): number => 0.01 * i;
  const channels = [
    channel("time", rows.map((i) => [0.01 * i]), ["t"], 1e-6),
    channel("tool.pose", rows.map((i) => [x(i), 0, 0.5, ...DOWN])),
    channel("tool.pose_command", rows.map((i) => [x(i) + 0.003, 0, 0.5 + 0.05 * Math.max(0, i - (off ?? i)), ...DOWN])),
    channel("cup.pose", rows.map(() => [0, 0, 0.04, 1, 0, 0, 0])),
    channel("cup.attached_body", rows.map((i) => [i < 5 ? 0 : -1]), ["body"], 1),
    ...(off === undefined ? [] : [channel("cup.command", rows.map((i) => [i < off ? 1 : 0, 0]), ["vacuum", "blow_off"], 1)]),
    channel("body.0.pose", rows.map((i) => [x(Math.min(i, 4)), 0, 0.5 - 0.04 - 0.1, ...DOWN])),
  ];
  const header = {
    format: "snug replay", version: 1, frames: 10, cup: { lip_radius: 0.03, free_length: 0.06, hold_length: 0.05 },
    bodies: [{ name: "box", type: "", kind: "dynamic", mass: 1, com: [0, 0, 0], shapes: [] }],
    events: [{ time: 0.05, kind: "release", body: "box", text: "", numbers: {} }],
  };
  return new Replay(await decodeReplay(encodeReplay(header, channels)));
}

describe("Plans", () => {
  it("knows where the command has the held box, and nothing of one that is not held", async () => {
    const plans = new Plans(await make());
    const e = plans.commanded(0, 2)!.elements;
    // The cup at its length under vacuum is 10 mm longer: the box hangs that much lower than it does.
    [0.023, 0, 0.5 - 0.05 - 0.1].forEach((v, k) => expect(e[12 + k]).toBeCloseTo(v, 5));
    expect(plans.commanded(0, 7)).toBeNull();
    expect(plans.commanded(-1, 2)).toBeNull();
  });

  it("is where the command was when the vacuum was switched off, not where it had risen to when the lip let go", async () => {
    const place = new Plans(await make(3)).placeAt(0, 0.0)!;
    expect(place.time).toBeCloseTo(0.05, 9);
    expect(place.X_WP.elements[14]).toBeCloseTo(0.5 - 0.05 - 0.1, 5);
    expect(place.X_WP.elements[12]).toBeCloseTo(0.023, 5);
  });

  it("is where the command was when a box was lost under vacuum, or held without it at all", async () => {
    for (const off of [9, 0]) expect(new Plans(await make(off)).placeAt(0, 0.0)!.X_WP.elements[12]).toBeCloseTo(0.043, 5);
  });

  it("tells how far a box lies from where it should have been put", async () => {
    const plans = new Plans(await make());
    const place = plans.placeAt(0, 0.0)!;
    expect(place.time).toBeCloseTo(0.05, 9);
    expect(plans.placeAt(0, 0.09)).toBe(place);
    const offset = plans.offsetAt(0, 9, place)!;
    [-3, 0, 10].forEach((v, k) => expect(offset.millimetres[k]).toBeCloseTo(v, 1)); // quanta of 0.01 mm, five of them
    expect(offset.degrees).toBeLessThan(0.01);
  });
});

describe("what is said of a planned place", () => {
  it("is no error while the box is carried, and where it lies afterwards", async () => {
    const plans = new Plans(await make());
    expect(plans.textAt(0, "7", 2)).toBe("planned place of 7");
    expect(plans.textAt(0, "7", 9)).toBe("7: 10.4 mm, 0.0° from its planned place");
    expect(plans.textAt(0, "7", 9, true)).toBe("7 lies x -3.0, y 0.0, z 10.0 mm (in W), 0.0° from its planned place");
  });
});
