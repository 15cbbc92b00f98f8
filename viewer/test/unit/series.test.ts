// What is plotted and said of a box, against numbers known from how the recording was made.

import { describe, expect, it } from "vitest";
import { decodeReplay } from "../../src/replay/decode";
import { Replay } from "../../src/replay/replay";
import { linkFrames } from "../../src/scene/robot";
import { flatten } from "../../src/ui/about";
import { digits } from "../../src/ui/dom";
import { restOf } from "../../src/ui/events";
import { continuousTurns, figuresOf, thin } from "../../src/ui/series";
import { encodeReplay } from "../support/encode";
import { pose, smallHeader } from "../support/sample";

describe("thin", () => {
  it("keeps the peaks of every stretch and stays below the number of points asked for", async () => {
    const replay = new Replay(await decodeReplay(smallHeader(5000)));
    const spike = (frame: number): number => (frame === 3217 ? 100 : frame === 3218 ? -50 : Math.sin(frame));
    const [times, values] = thin(replay, spike, 200);
    expect(values.length).toBeLessThanOrEqual(210);
    expect(Math.max(...values.map(Number))).toBe(100);
    expect(Math.min(...values.map(Number))).toBe(-50);
    times.slice(1).forEach((t, i) => expect(t).toBeGreaterThanOrEqual(times[i]!));
  });

  it("gives every frame of a stretch that has few", async () => {
    const replay = new Replay(await decodeReplay(smallHeader(5000)));
    const [times] = thin(replay, (frame) => frame, 200, 1000, 1040);
    expect(times).toHaveLength(40);
    expect(times[0]).toBeCloseTo(10, 6);
  });
});

describe("figuresOf", () => {
  it("plots position and rotation vector of the chosen box, in metres and degrees", async () => {
    const replay = new Replay(await decodeReplay(smallHeader(200)));
    const [position, rotation] = figuresOf("box");
    expect([position!.unit, rotation!.unit]).toEqual(["m", "deg"]);
    const at = (figure: typeof position): number[] => figure!.values(replay)!.map((f) => f(150));
    at(position).forEach((v, k) => expect(Math.abs(v - pose(150)[k]!)).toBeLessThan(1e-5));
    // The box turns 0.8 rad/s about z; a quantum of 1e-5 of the quaternion is 2e-5 rad, about 1e-3 deg.
    expect(at(rotation)[2]).toBeCloseTo((0.8 * 1.5 * 180) / Math.PI, 2);
    expect(Math.abs(at(rotation)[0]!)).toBeLessThan(2e-3);
  });
});

describe("limits", () => {
  const USES = "Used of the nearest joint's limit, and of the hold";

  it("tell for each kind the joint that is nearest to its limit", async () => {
    const robot = { links: [], limits: { speed: [2, 1], acceleration: 4, torque: [100, null] } };
    const times = Array.from({ length: 200 }, (_, i) => 0.01 * i);
    const channels = [
      { name: "joints.velocity", columns: ["a", "b"], quantum: 1e-4, rows: times.map((t) => [0.5 * t, -0.75 * t]) },
      { name: "joints.torque", columns: ["a", "b"], quantum: 1e-2, rows: times.map(() => [-30, 1000]) },
    ];
    const replay = new Replay(await decodeReplay(smallHeader(200, { robot }, channels)));
    const [speed, acceleration, torque, hold] = figuresOf("").find((f) => f.title === USES)!.values(replay)!.map((f) => f(100));
    expect(speed).toBeCloseTo(75, 1); // of the second joint; the first is at 25 %
    expect(acceleration).toBeCloseTo((100 * 0.75) / 4, 1);
    expect(torque).toBeCloseTo(30, 1); // what nobody knows binds nothing
    expect(hold).toBeNaN();
  });

  it("are not there where neither joints nor hold are known", async () => {
    const replay = new Replay(await decodeReplay(smallHeader(20)));
    expect(figuresOf("").find((f) => f.title === USES)!.values(replay)).toBeNull();
  });
});

describe("restOf", () => {
  it("says when a box stopped, and nothing of one that moves to the end or never did", async () => {
    const replay = new Replay(await decodeReplay(smallHeader(200)));
    expect(restOf(replay, replay.bodyIndex("box"))).toBeNull();
    expect(restOf(replay, replay.bodyIndex("floor"))).toBeNull();
    expect(restOf(replay, -1)).toBeNull();
  });
});

describe("linkFrames", () => {
  it("has the stretched UR10 reach as far as its data sheet says", () => {
    const flange = linkFrames([0, 0, 0, 0, 0, 0])[5]!.elements;
    // Upper arm and forearm lie along -x; the wrist adds d4 + d6 along -y and -d5 + d1 along z.
    expect(flange[12]).toBeCloseTo(-0.612 - 0.5723, 6);
    expect(flange[13]).toBeCloseTo(-0.163941 - 0.0922, 6);
    expect(flange[14]).toBeCloseTo(0.1273 - 0.1157, 6);
  });
});

describe("continuousTurns", () => {
  it("goes on past half a turn instead of jumping to the other side", async () => {
    const turns = Array.from({ length: 400 }, (_, i) => 0.03 * i - 3); // about z, rad: more than a whole turn
    const channels = [
      { name: "time", columns: ["t"], quantum: 1e-6, rows: turns.map((_, i) => [0.01 * i]) },
      {
        name: "body.0.pose", columns: ["x", "y", "z", "qw", "qx", "qy", "qz"], quantum: 1e-5,
        rows: turns.map((a) => [0, 0, 0, Math.cos(a / 2), 0, 0, Math.sin(a / 2)]),
      },
    ];
    const body = { name: "box", type: "", kind: "dynamic", mass: 1, com: [0, 0, 0], shapes: [] };
    const bytes = encodeReplay({ format: "snug replay", version: 1, frames: 400, bodies: [body] }, channels);
    const found = continuousTurns(new Replay(await decodeReplay(bytes)).poseChannelOfBody(0)!);
    // Each quaternion is known to half a quantum of 1e-5: 2e-5 rad.
    turns.forEach((a, i) => expect(Math.abs(found[3 * i + 2]! - a)).toBeLessThan(3e-5));
  });
});

describe("digits", () => {
  it("writes four digits, and no more than can be read", () => {
    expect([NaN, 0, 0.123456, -12.3456, 4321.6, 1.5e-6, 2e6].map(digits)).toEqual(["–", "0", "0.1235", "-12.35", "4322", "1.50e-6", "2.00e+6"]);
  });
});

describe("flatten", () => {
  it("writes nested settings one a line", () => {
    expect(flatten({ cup: { model: "holding" }, list: [1, null] })).toEqual([["cup.model", "holding"], ["list.0", "1"], ["list.1", "null"]]);
  });
});
