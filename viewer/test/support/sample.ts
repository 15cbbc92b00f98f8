// A small recording made by hand: a floor, a box that flies along a curve while it turns, and one that comes late.

import { encodeReplay, type ChannelInput } from "./encode";

const POSE = ["x", "y", "z", "qw", "qx", "qy", "qz"];

/** X_WB of the box at a frame of 10 ms. */
export function pose(frame: number): number[] {
  const t = 0.01 * frame;
  return [0.3 * Math.cos(t), 0.3 * Math.sin(t), 0.2 + 0.1 * t, Math.cos(0.4 * t), 0, 0, Math.sin(0.4 * t)];
}

export function smallHeader(frames: number, extra: object = {}, more: ChannelInput[] = []): Uint8Array {
  const box = { kind: "box", pose: [0, 0, 0, 1, 0, 0, 0], half: [0.1, 0.08, 0.05] };
  const rows = Array.from({ length: frames }, (_, i) => i);
  const late = (i: number): number[] => (i < frames / 2 ? Array(7).fill(NaN) : [0, 0.5, 0.05, 1, 0, 0, 0]);
  const channels: ChannelInput[] = [
    { name: "time", columns: ["t"], quantum: 1e-6, rows: rows.map((i) => [0.01 * i]) },
    { name: "body.0.pose", columns: POSE, quantum: 1e-5, rows: [[0, 0, -0.05, 1, 0, 0, 0]] },
    { name: "body.1.pose", columns: POSE, quantum: 1e-5, rows: rows.map(pose) },
    { name: "body.1.present", columns: ["present"], quantum: 1, rows: rows.map(() => [1]) },
    { name: "body.2.pose", columns: POSE, quantum: 1e-5, rows: rows.map(late) },
    { name: "body.2.present", columns: ["present"], quantum: 1, rows: rows.map((i) => [i < frames / 2 ? 0 : 1]) },
    ...more,
  ];
  return encodeReplay(
    {
      format: "snug replay", version: 1, name: "by hand", frames, dt: 0.001, record_period: 0.01, complete: true, scenario: { name: "by hand", text: "" },
      bodies: [
        { name: "floor", type: "", kind: "static", mass: 0, com: [0, 0, 0], shapes: [{ ...box, half: [1, 1, 0.05] }] },
        { name: "box", type: "B1", kind: "dynamic", mass: 1, com: [0, 0, 0], shapes: [box] },
        { name: "late", type: "B2", kind: "dynamic", mass: 1, com: [0, 0, 0], shapes: [box] },
      ],
      events: [{ time: 0.3, kind: "seal", body: "box", text: "sealed", numbers: {} }],
      ...extra,
    },
    channels,
  );
}
