// Between two frames: where a thing is at a time that was not recorded.

import { describe, expect, it } from "vitest";
import { decodeReplay } from "../../src/replay/decode";
import { Replay } from "../../src/replay/replay";
import { encodeReplay } from "../support/encode";

const POSE = ["x", "y", "z", "qw", "qx", "qy", "qz"];
/** One body: at x turned about z by so many degrees in each frame of 0.1 s; NaN: it is not there. */
async function replayOf(rows: number[][]): Promise<Replay> {
  const missing = (row: number[]): boolean => row.some(Number.isNaN);
  return new Replay(await decodeReplay(encodeReplay(
    { format: "snug replay", version: 1, frames: rows.length, events: [], bodies: [{ name: "b", kind: "dynamic", shapes: [] }] },
    [
      { name: "time", columns: ["t"], quantum: 1e-6, rows: rows.map((_, k) => [0.1 * k]) },
      { name: "body.0.pose", columns: POSE, quantum: 1e-6, rows },
      { name: "body.0.present", columns: ["present"], quantum: 1, rows: rows.map((row) => [missing(row) ? 0 : 1]) },
    ])));
}
/** At x, turned about z; with the one or the other quaternion of that turn. */
const at = (x: number, degrees: number, sign = 1): number[] => {
  const half = (degrees * Math.PI) / 360;
  return [x, 0, 0, sign * Math.cos(half), 0, 0, sign * Math.sin(half)];
};
const nowhere = Array<number>(7).fill(NaN);
const poseAt = (replay: Replay, time: number): number[] | null => {
  const out = new Float64Array(7);
  return replay.bodyPose(0, replay.frameBetween(time), out) ? [...out] : null;
};
const degreesOf = (pose: number[]): number => (Math.atan2(pose[6]!, pose[3]!) * 360) / Math.PI;

describe("between two frames", () => {
  it("positions are linear and turns go at a constant rate the shorter way, whatever the quaternions' signs", async () => {
    for (const sign of [1, -1]) {
      const replay = await replayOf([at(0, 0), at(0.1, 90, sign), at(0.1, 90, sign)]);
      for (const part of [0, 0.1, 0.25, 0.5, 0.9]) {
        const pose = poseAt(replay, 0.1 * part)!;
        expect(pose[0]).toBeCloseTo(0.1 * part, 6);
        expect(degreesOf(pose)).toBeCloseTo(90 * part, 3);
        expect(Math.hypot(...pose.slice(3))).toBeCloseTo(1, 12);
      }
    }
  });
  it("frames are as recorded, and what is beyond them stays", async () => {
    const replay = await replayOf([at(0, 0), at(0.1, 10), at(0.25, 20)]);
    for (const [time, x] of [[0, 0], [0.1, 0.1], [0.2, 0.25], [5, 0.25], [-1, 0]] as const) expect(poseAt(replay, time)![0]).toBeCloseTo(x, 6);
    expect(replay.frameBetween(0.2)).toBe(2);
    expect(replay.frameBetween(0.1)).toBe(1);
  });
  it("nothing flies to where it is put, comes early or leaves late", async () => {
    const replay = await replayOf([at(0, 0), at(2, 0), nowhere, at(3, 0)]);
    expect(poseAt(replay, 0.05)![0]).toBeCloseTo(0, 6); // two metres in a tenth of a second
    expect(poseAt(replay, 0.15)![0]).toBeCloseTo(2, 6); // then it is gone
    expect(poseAt(replay, 0.25)).toBeNull();
    expect(poseAt(replay, 0.3)![0]).toBeCloseTo(3, 6);
  });
  it("counts and states are those of the frame before", async () => {
    const replay = await replayOf([at(0, 0), nowhere]);
    expect(replay.channel("body.0.present")!.at(0, 0.9)).toBe(1);
    expect(replay.channel("body.0.present")!.at(0, 1)).toBe(0);
    expect(replay.channel("body.0.present")!.at(0, 2)).toBeNaN();
  });
});
