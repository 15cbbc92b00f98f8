// What the page of `snug ui` computes itself: edits of YAML, names, the CSV of a comparison.

import { readFileSync } from "node:fs";
import { join } from "node:path";
import { describe, expect, it } from "vitest";
import type { ReachMap, RunStatus } from "../../src/workspace/api";
import { csvOf } from "../../src/workspace/compare";
import { plainName } from "../../src/workspace/dom";
import { fieldsOf } from "../../src/workspace/items";
import { moved, namesIn, snapped } from "../../src/workspace/placing";
import { nextTime, Throttle } from "../../src/workspace/pace";
import { countLayer } from "../../src/workspace/reach_count";
import { canEditCup, canEditSize, setCupRadius, setInnerSize } from "../../src/workspace/yaml_edit";

const cell = readFileSync(join(__dirname, "../../../scenarios/init/cell.yaml"), "utf8");

/** Lines of `after` that are not in `before` at the same place. */
const changed = (before: string, after: string): string[] => after.split("\n").filter((line, k) => line !== before.split("\n")[k]);

describe("edits of a scenario's text", () => {
  it("change the one number and nothing else", () => {
    expect(canEditSize(cell, 1)).toBe(true);
    expect(changed(cell, setInnerSize(cell, 0, [600, 400, 220.5]))).toEqual([
      "  - {name: tote, pose: {position: [0.45, 0.0, 0.02]}, inner_size: [0.6, 0.4, 0.2205], material: tote}"]);
    expect(changed(cell, setCupRadius(cell, 20))).toEqual(["cup: {lip_radius: 0.02}"]);
    expect(setCupRadius(setCupRadius(cell, 20), 30)).toBe(setCupRadius(cell, 30));
  });
  it("find the cup in its forms", () => {
    for (const [before, after] of [
      ["cup: {mass: 1}", "cup: {lip_radius: 0.02, mass: 1}"],
      ["cup: {mass: 1, lip_radius: 3.5e-2} # lip_radius: 9", "cup: {mass: 1, lip_radius: 0.02} # lip_radius: 9"],
      ["cup:\n  mass: 1\nx: 2\n", "cup:\n  lip_radius: 0.02\n  mass: 1\nx: 2\n"],
      ["cup:\n  # lip_radius: 1\n  lip_radius: 0.035   # m\nx:\n", "cup:\n  # lip_radius: 1\n  lip_radius: 0.02   # m\nx:\n"],
    ]) expect(setCupRadius(before!, 20)).toBe(after);
    for (const other of ["", "# cup: {}\n", "tool: {cup: {}}", "cup: *other\n"]) expect([canEditCup(other), setCupRadius(other, 20)]).toEqual([false, other]);
  });
  it("keep off where it is not clear which number is meant", () => {
    expect(canEditSize("a: {inner_size: [1, 1, 1]}\n# inner_size: [2, 2, 2]\n", 1)).toBe(true);
    expect(canEditSize("a: 1", 1)).toBe(false);
    expect(canEditSize(cell, 2)).toBe(false);
    expect(setInnerSize(cell, 1, [1, 1, 1])).toBe(cell);
  });
});

describe("places of parts", () => {
  it("snap to whole steps without noise", () => {
    expect([snapped(123.4, 10), snapped(-4, 10), snapped(0.1 + 0.2, 0.1), snapped(75, 50)]).toEqual([120, 0, 0.3, 100]);
    expect(Object.is(snapped(-4, 10), 0)).toBe(true);
  });
  it("go to the next step by keys, from wherever they are", () => {
    const from = { position: [123, -20, 0] as [number, number, number], yaw: 178 };
    expect(moved(from, "ArrowRight", 10)!.position).toEqual([130, -20, 0]);
    expect(moved(from, "ArrowLeft", 10)!.position).toEqual([120, -20, 0]);
    expect(moved(from, "ArrowUp", 10)!.position).toEqual([123, -10, 0]);
    expect(moved(from, "ArrowDown", 10)!.position).toEqual([123, -30, 0]);
    expect(moved(from, "PageDown", 50)!.position).toEqual([123, -20, -50]);
    expect(moved(from, "]", 10)!.yaw).toBe(-175);
    expect(moved(from, "a", 10)).toBeNull();
  });
  it("are named in mistakes", () => {
    expect(namesIn("cell.yaml:3: bodies: 'bench' overlaps 'tote' by 3 mm")).toEqual(["bench", "tote"]);
  });
});

describe("what is reached", () => {
  it("is counted by verdict, with what is mostly in the way", () => {
    const map = {
      robot: "r", container: "c", pose: [0, 0, 0, 1, 0, 0, 0], inner_size: [1, 1, 1], columns: 2, rows: 2, counts: {}, picks: [],
      verdicts: ["reached", "out of reach", "joint limit"], whats: ["", "elbow", "wrist"],
      layers: [{ name: "low", height: 0, verdicts: [0, 1, 2, 2], whats: [0, 0, 2, 1] }],
    } as unknown as ReachMap;
    expect(countLayer(map, 0)).toEqual({ verdicts: [1, 1, 2], reasons: [["joint limit: wrist", 1], ["joint limit: elbow", 1]] });
  });
});

describe("the clock of a run that is watched", () => {
  it("goes on with the run, catches up with bursts, and never passes the newest frame", () => {
    expect(nextTime(1, 10, 0.033)).toBeGreaterThan(1.033); // nine seconds behind: faster than the clock
    expect(nextTime(1, 1.003, 0.033)).toBe(1.003);
    expect(nextTime(2, 1, 0.033)).toBe(1);
    let shown = 0;
    for (let k = 0; k < 180; ++k) shown = nextTime(shown, 10, 1 / 30);
    expect(shown).toBeGreaterThan(8.9); // in six seconds
  });
  it("shows something new in each picture of a burst and of the pause behind it", () => {
    // 14 s of motion are computed in 2 s, in messages of half a second; then 6 s of planning.
    let shown = 0, still = 0;
    for (let k = 1; k <= 8 * 30; ++k) {
      const next = nextTime(shown, 0.5 * Math.min(28, Math.floor((14 * k) / 30)), 1 / 30);
      expect(next - shown).toBeLessThan(0.25); // no leaps either: at most seven times as fast
      if (k > 3 && next === shown) ++still;
      shown = next;
    }
    expect(still).toBe(0);
    expect(shown).toBeGreaterThan(13);
  });
  it("ends with a run that is over, at the run's own pace", () => {
    let shown = 0;
    for (let k = 0; k < 16; ++k) shown = nextTime(shown, 0.5, 1 / 30, false);
    expect(shown).toBe(0.5);
  });
  it("takes no more pictures than it may, evenly, and each that it can where it may", () => {
    const drawn = (most: number): number => {
      const throttle = new Throttle(most);
      let count = 0;
      for (let k = 0; k < 600; ++k) count += Number(throttle.may((1000 * k) / 60));
      return count / 10;
    };
    expect(drawn(Infinity)).toBe(60);
    expect(drawn(40)).toBeCloseTo(40, 0);
    expect(drawn(100)).toBe(60);
  });
});

describe("names and tables", () => {
  it("make a plain name of any file's", () => {
    expect(["My orders (1).csv", "../../etc/passwd", ".hidden.csv", "äö.csv", "--o.csv", "", "日本.csv"].map((name) => plainName(name, "items")))
      .toEqual(["My-orders-1-", "etc-passwd", "hidden", "ao", "o", "items", "items"]);
  });
  it("keep a spreadsheet from computing what others wrote", () => {
    const run = { name: "=1+1", state: "done", sequence: '@a,"b"', plant: "-x", items: 2, packed: 2, lost: 0, percent: 20, time: 10 } as RunStatus;
    const csv = csvOf([run]);
    expect(csv.split("\r\n")[0]).toBe(",'=1+1");
    expect(csv).toContain(`Order,"'@a,""b"""\r\nPlant,'-x`);
    expect(csv).toContain("Boxes an hour,720");
  });
});

describe("lines of items", () => {
  it("are taken apart at commas outside of quotes", () => {
    expect(fieldsOf(',a,"b, ""c""", d ,')).toEqual(["", "a", 'b, "c"', "d", ""]);
    expect(fieldsOf("")).toEqual([""]);
  });
});
