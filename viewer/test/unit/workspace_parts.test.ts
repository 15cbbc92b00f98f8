// What the page of `snug ui` computes itself: costs, workbooks, spreads, orders of who operates, dropped files.

import { describe, expect, it } from "vitest";
import type { CellPart, Decision, Decisions, RunStatus } from "../../src/workspace/api";
import { costOfABox, csvOf, describeSpread, isFair, NO_COSTS, pageOf, rowsOf, spreadsOf, stripsOf, variantsOf, worstOf } from "../../src/workspace/compare";
import { outcomeRows, quoted } from "../../src/workspace/decisions";
import { splitDropped } from "../../src/workspace/parts";
import { boxesOf } from "../../src/workspace/plan_drawing";
import { boxesInWorld, inWorld } from "../../src/workspace/plan_stage";
import { crc32, workbook, zip } from "../../src/workspace/spreadsheet";
import { histogram } from "../../src/workspace/spreads";

const run = (name: string, more: Partial<RunStatus> = {}): RunStatus => ({
  name, state: "done", can_be_stopped: false, command: `snug pack ${name}.yaml`, message: "", sequence: "mine", plant: "p", items: 10, done: 10, packed: 8, lost: 1,
  percent: 60, time: 3600, stopped: "", now: "", held: "", files: [], ...more });

describe("costs of runs", () => {
  it("are those of the cell's time, of what is lost and of what is left", () => {
    expect(costOfABox([run("a")], { hour: 40, lost: 16, left: 2 })).toBe((40 + 16 + 2) / 8);
    expect(costOfABox([run("a")], NO_COSTS)).toBeNull();
    expect(costOfABox([run("a", { packed: 0 })], { hour: 40, lost: 0, left: 0 })).toBeNull();
    expect(csvOf([run("a")], { hour: 40, lost: 16, left: 2 })).toContain("Cost of a packed box,7.250\r\n");
  });
  it("are those of all runs of a variant together", () => {
    expect(costOfABox([run("a"), run("b", { packed: 2, lost: 0, done: 2, time: 1800 })], { hour: 40, lost: 16, left: 2 })).toBe((60 + 16 + 2) / 10);
  });
  it("leave the worst cases first and the spread beside them", () => {
    const runs = [run("a", { percent: 70 }), run("b", { lost: 3 }), run("c", { percent: 50 }), run("d", { state: "running", lost: 9 })];
    expect(worstOf(runs).map(({ name }) => name)).toEqual(["b", "c", "a"]);
    expect(describeSpread(spreadsOf(runs)[0]!)).toBe("mean 60.0 %, 50.0 to 70.0 % (3 runs)");
  });
  it("make a page of their own in which no name is a script", () => {
    const page = pageOf([run("<script>alert(1)</script>", { sequence: "\"><img src=x onerror=y>" })], { hour: 1, lost: 0, left: 0 }, "<b>");
    expect(page).not.toMatch(/<script|<img|<b>/);
    expect(page).toContain("default-src 'none'");
  });
});

describe("variants", () => {
  const packed = (cell: string, plant: number, more: Partial<RunStatus> = {}, options = ""): RunStatus =>
    run(`${cell}-${plant}${options}`, { command: `snug pack ${cell}.yaml --items 'my items.csv' --sequence mine --plant-seed ${plant}${options} --log x.jsonl`, plant: `seed ${plant}`, ...more });
  const runs = [
    packed("cup40", 1, { percent: 50, packed: 4, time: 1800 }), packed("cup70", 1), packed("cup40", 2, { percent: 60, packed: 6, time: 1800, lost: 0 }), packed("cup70", 2),
    packed("cup70", 1, {}, " --tempo 0.8"), packed("cup70", 3, { state: "running" }), packed("cup70", 4, { state: "ended early" }),
  ];
  it("are runs of the same cell, items and tempo, whatever their order and plant", () => {
    expect(variantsOf(runs).map(({ name, runs: of }) => [name, of.length])).toEqual([
      ["cup40.yaml, my items.csv", 2], ["cup70.yaml, my items.csv", 2], ["cup70.yaml, my items.csv, tempo 0.8", 1]]);
    const rows = new Map(rowsOf(runs, { hour: 10, lost: 0, left: 0 }, true).map(([label, ...cells]) => [label, cells]));
    expect(rows.get("Runs")).toEqual(["2", "2", "1"]);
    expect(rows.get("Cell")![0]).toBe("cup40.yaml");
    expect(rows.get("Tempo")).toEqual(["1", "1", "0.8"]);
    expect(rows.get("Filling in %")![0]).toBe("55.0");
    expect(rows.get("Least filling in %")![0]).toBe("50.0");
    expect(rows.get("Boxes an hour")![0]).toBe("10");
    expect(rows.get("Cost of a packed box")![0]).toBe("1.000");
    expect(rows.get("Plant")![0]).toBe("seed 1; seed 2");
  });
  it("are spread on one scale, and are fair where all packed the same", () => {
    const strips = stripsOf(runs.slice(0, 4), true)[0]!.strips;
    expect(strips.map(({ name }) => name)).toEqual(["cup40.yaml, my items.csv", "cup70.yaml, my items.csv"]);
    expect(strips[0]!.svg).toContain('cx="10.0"');
    expect(strips[1]!.svg).toMatch(/cx="290.0".*cx="290.0"/);
    expect(isFair(variantsOf(runs.slice(0, 4)))).toBe(true);
    expect(isFair(variantsOf(runs))).toBe(false);
    expect(pageOf(runs, NO_COSTS, "x", true)).toContain("<th>cup70.yaml, my items.csv</th>");
    expect(pageOf([packed("<script>", 1)], NO_COSTS, "x", true)).not.toContain("<script");
  });
});

describe("workbooks", () => {
  it("have the checksum of ZIP", () => {
    expect(crc32(new TextEncoder().encode("123456789"))).toBe(0xcbf43926);
  });
  it("are read back as they were written, words never as formulas", () => {
    const bytes = workbook([["", "a<b>"], ["=1+1", "-3.5"], ["x\u0001y", "007"]], "compare");
    const view = new DataView(bytes.buffer);
    const files = new Map<string, string>();
    for (let at = 0; view.getUint32(at, true) === 0x04034b50; ) {
      const size = view.getUint32(at + 18, true), length = view.getUint16(at + 26, true);
      const name = new TextDecoder().decode(bytes.subarray(at + 30, at + 30 + length));
      const content = bytes.subarray(at + 30 + length, at + 30 + length + size);
      expect(view.getUint16(at + 8, true)).toBe(0);
      expect(view.getUint32(at + 14, true)).toBe(crc32(content));
      files.set(name, new TextDecoder().decode(content));
      at += 30 + length + size;
    }
    expect([...files.keys()]).toEqual(["[Content_Types].xml", "_rels/.rels", "xl/workbook.xml", "xl/_rels/workbook.xml.rels", "xl/worksheets/sheet1.xml"]);
    const sheet = files.get("xl/worksheets/sheet1.xml")!;
    expect(sheet).toContain('<c r="B2"><v>-3.5</v></c>');
    expect(sheet).toContain("<t xml:space=\"preserve\">=1+1</t>");
    expect(sheet).not.toContain("<f>");
    expect(sheet).toContain("a&#60;b&#62;");
    expect(sheet).toContain(">xy<");
    expect(zip([["a", "b"]])).toEqual(zip([["a", "b"]]));
  });
});

describe("spreads", () => {
  it("are counted into parts of their range", () => {
    expect(histogram([[1, 2], [3, 1], [5, 1]], 2)).toEqual({ low: 1, high: 5, counts: [2, 2] });
    expect(histogram([[4, 3]]).counts).toEqual([3]);
  });
});

describe("who operates", () => {
  it("names items as snug pack reads them", () => {
    expect(["BOX027", "a b", "next", "#1", 'x"y', "w \\"].map(quoted)).toEqual(["BOX027", '"a b"', '"next"', '"#1"', 'x"y', '"w \\\\"']);
  });
});

const decision = (item: string, more: Partial<Decision> = {}): Decision => ({
  item, time: 0, outcome: "found", reason: "", planning_seconds: 0, candidates: [], candidates_in_all: 0, waited_seconds: 0, extent_mm: [100, 100, 50],
  planned: { position_mm: [0, 0, 25], insertion: "top-down", reorientation: "none", predicted_success: 0.9, samples: 8 }, happened: null, end: "placed", end_reason: "", troubles: [], operator: [], ...more });

describe("decisions", () => {
  it("are drawn by the last one of each box that is in the container", () => {
    const all = [decision("A"), decision("B"), decision("A", { end: "taken out" }), decision("C", { end: "" })];
    expect(boxesOf(all).map(({ item }) => item)).toEqual(["B", "C"]);
  });
  it("have a dash where nothing is known", () => {
    expect(outcomeRows(decision("A"))[2]).toEqual(["Largest force in N", "–", "–"]);
  });
});

describe("dropped files", () => {
  const of = (...names: string[]): { name: string; size: number }[] => names.map((name) => ({ name, size: 10 }));
  it("are one URDF and its meshes", () => {
    expect(splitDropped(of("arm.URDF", "a.STL", "b.dae"))).toEqual({ urdfs: [0], meshes: [1, 2], trouble: "" });
    expect(splitDropped(of("arm.xacro")).trouble).toMatch(/xacro/);
    expect(splitDropped(of("a.urdf", "b.urdf")).trouble).toMatch(/one arm/);
    expect(splitDropped([{ name: "a.urdf", size: 5 << 20 }]).trouble).toMatch(/at most/);
    expect(splitDropped([]).trouble).toMatch(/No URDF/);
  });
});

describe("a served cell in 3D", () => {
  const container: CellPart = { key: "containers.tote", name: "tote", position_mm: [500, 100, 20], yaw_deg: 90 };
  it("has boxes where they are perceived, and the one at hand where it is planned, in W", () => {
    const found = { items: [], now: "", held: "", standing: [{ item: "A", position_mm: [450, 90, 40], extent_mm: [100, 50, 40] }], decisions: [decision("B")] } satisfies Decisions;
    const [perceived, planned] = boxesInWorld(found, 0, container);
    expect(perceived).toEqual({ centre: [450, 90, 40], extent: [100, 50, 40], yaw_deg: 0, isPlanned: false });
    expect(planned).toMatchObject({ extent: [100, 100, 50], yaw_deg: 90, isPlanned: true });
    inWorld(container, [10, 20, 25]).forEach((x, i) => expect(x).toBeCloseTo([480, 110, 45][i]!, 9));
    expect(boxesInWorld({ ...found, decisions: [] }, 0, container)).toHaveLength(1);
  });
});
