// What the page of `snug ui` computes itself: costs, workbooks, typical orders, orders of who operates, dropped files.

import { describe, expect, it } from "vitest";
import type { CellPart, Decision, Decisions, RunStatus } from "../../src/workspace/api";
import { costOfABox, csvOf, describeSpread, NO_COSTS, pageOf, spreadsOf, worstOf } from "../../src/workspace/compare";
import { outcomeRows, quoted } from "../../src/workspace/decisions";
import { splitDropped } from "../../src/workspace/parts";
import { boxesOf } from "../../src/workspace/plan_drawing";
import { boxesInWorld, inWorld } from "../../src/workspace/plan_stage";
import { crc32, workbook, zip } from "../../src/workspace/spreadsheet";
import { histogram, typicalOrders } from "../../src/workspace/typical";

const run = (name: string, more: Partial<RunStatus> = {}): RunStatus => ({
  name, state: "done", can_be_stopped: false, command: `snug pack ${name}.yaml`, message: "", sequence: "mine", plant: "p", items: 10, done: 10, packed: 8, lost: 1,
  percent: 60, time: 3600, stopped: "", now: "", held: "", files: [], ...more });

describe("costs of runs", () => {
  it("are those of the cell's time, of what is lost and of what is left", () => {
    expect(costOfABox(run("a"), { hour: 40, lost: 16, left: 2 })).toBe((40 + 16 + 2) / 8);
    expect(costOfABox(run("a"), NO_COSTS)).toBeNull();
    expect(costOfABox(run("a", { packed: 0 }), { hour: 40, lost: 0, left: 0 })).toBeNull();
    expect(csvOf([run("a")], { hour: 40, lost: 16, left: 2 })).toContain("Cost of a packed box,7.250\r\n");
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

describe("typical orders", () => {
  it("are the same by the same seed, and of one mass for one article", () => {
    const text = typicalOrders({ orders: 5, boxes: 20, seed: 7 });
    expect(typicalOrders({ orders: 5, boxes: 20, seed: 7 })).toBe(text);
    expect(typicalOrders({ orders: 5, boxes: 20, seed: 8 })).not.toBe(text);
    const masses = new Map<string, string>();
    for (const line of text.trim().split("\n").slice(1)) {
      const cells = line.split(",");
      expect(masses.get(cells[1]!) ?? cells[5]).toBe(cells[5]);
      masses.set(cells[1]!, cells[5]!);
    }
  });
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
