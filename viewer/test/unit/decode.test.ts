// The decoder against an encoder written from docs/formats.md, and against broken and huge input.

import { describe, expect, it } from "vitest";
import { decodeBase64, decodeReplay } from "../../src/replay/decode";
import { ReplayError } from "../../src/replay/errors";
import { Replay } from "../../src/replay/replay";
import { encodeReplay, packReplay } from "../support/encode";
import { pose, smallHeader } from "../support/sample";

const channel = (rows: number[][], quantum: number, encoding: "delta" | "raw" = "delta") => ({
  name: "time", columns: rows[0]!.map((_, k) => `c${k}`), quantum, rows, encoding,
});

describe("decodeReplay", () => {
  it("gives back values within half a quantum, with both encodings and both signs", async () => {
    const rows = Array.from({ length: 500 }, (_, i) => [i * 0.008, Math.sin(i) * 1e4, -i * i]);
    for (const encoding of ["delta", "raw"] as const) {
      const decoded = await decodeReplay(encodeReplay({ format: "snug replay", version: 1, frames: 500 }, [channel(rows, 1e-4, encoding)]));
      const columns = decoded.channels.get("time")!.columns;
      rows.forEach((row, i) => row.forEach((v, c) => expect(Math.abs(columns[c]![i]! - v)).toBeLessThanOrEqual(0.5e-4 + Math.abs(v) * 1e-7)));
    }
  });

  it("keeps what is missing missing, and goes on from the value before", async () => {
    const rows = [[1], [NaN], [3], [NaN], [NaN], [2]];
    const decoded = await decodeReplay(encodeReplay({ format: "snug replay", version: 1, frames: 6 }, [channel(rows, 1)]));
    expect([...decoded.channels.get("time")!.columns[0]!]).toEqual([1, NaN, 3, NaN, NaN, 2]);
  });

  it("refuses what is no replay form, cut short, of a newer version, or too large, and says why", async () => {
    const good = encodeReplay({ format: "snug replay", version: 1, frames: 3 }, [channel([[0], [1], [2]], 1)]);
    const cases: [Uint8Array, RegExp][] = [
      [new Uint8Array(0), /./],
      [new TextEncoder().encode("hello, this is no recording"), /./],
      [good.subarray(0, good.length - 9), /broken|cut|incomplete/i],
      [encodeReplay({ format: "snug replay", version: 99, frames: 0 }, []), /version|newer/i],
      [packReplay({ format: "snug replay", version: 1, channels: [{ name: "time", columns: ["t"], unit: "", frame: "", quantum: 1, rows: 5, offset: 0, bytes: 999, encoding: "delta" }] }, new Uint8Array(3)), /broken|beyond|outside/i],
    ];
    for (const [bytes, why] of cases) {
      const error = await decodeReplay(bytes).catch((e: unknown) => e);
      expect(error).toBeInstanceOf(ReplayError);
      expect(String(error)).toMatch(why);
    }
    const huge = await decodeReplay(good, { inflated: 20, decoded: 20 }).catch((e: unknown) => e);
    expect(String(huge)).toMatch(/too large/);
  });

  it("reads base64 as Node writes it", () => {
    const bytes = Uint8Array.from({ length: 301 }, (_, i) => (i * 37) % 256);
    expect([...decodeBase64(Buffer.from(bytes).toString("base64"))]).toEqual([...bytes]);
  });
});

describe("Replay", () => {
  it("finds the frame of a time and the pose of a body, absent bodies included", async () => {
    const replay = new Replay(await decodeReplay(smallHeader(100)));
    expect(replay.frames).toBe(100);
    expect(replay.frameAt(-5)).toBe(0);
    expect(replay.frameAt(0.5)).toBe(50);
    expect(replay.frameAt(0.5049)).toBe(50);
    expect(replay.frameAt(1e9)).toBe(99);
    const out = new Float64Array(7);
    expect(replay.bodyPose(replay.bodyIndex("box"), 50, out)).toBe(true);
    pose(50).forEach((v, c) => expect(Math.abs(out[c]! - v)).toBeLessThan(2e-5));
    expect(replay.bodyPose(replay.bodyIndex("late"), 10, out)).toBe(false);
    expect(replay.bodyPose(replay.bodyIndex("late"), 90, out)).toBe(true);
    expect(replay.bodyIndex("nobody")).toBe(-1);
  });
});
