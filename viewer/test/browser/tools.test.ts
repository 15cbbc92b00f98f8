// What one does with the page: layouts, windows of the plots, measuring, sections, dropped files; in Chromium, without network.

import { readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { open, openBrowser, pageWith } from "../support/browser";
import { encodeReplay, type ChannelInput } from "../support/encode";
import { smallHeader } from "../support/sample";

interface Handle {
  error: string;
  time: number;
  frames: number;
  setTime(t: number): void;
  section(axis: string, part?: number): void;
  measured(): string;
  plotted(): [number, number] | null;
  toggles(name: string, on: boolean): boolean;
}
declare const window: { snug: Handle; innerWidth: number; innerHeight: number };
declare const document: any;
declare const DataTransfer: any;
declare const File: any;
declare const DragEvent: any;

let browser: Browser;
beforeAll(async () => {
  browser = await openBrowser();
});
afterAll(() => browser?.close());

const RESULT = {
  boxes: [{ id: "box", state: "packed", up: "Z", pose: null, events: [] }, { id: "late", state: "packed", up: "-X", pose: null, events: [] }],
  filling_degree_percent: 61.25, packed: 2, failure: "", warnings: ["a warning that is so long that it would not fit beside the other facts of the headline of a page, however wide"],
  report_table7: { filling_percent: 75.66, boxes: 12, same_boxes_percent: 74.22, agent: "I.AM.", agents: [{ agent: "I.AM.", about: "a robot, programmed by hand", filling_percent: 75.66 }] },
};
const CONTAINER = { name: "tote", pose: [[0, 0, 0, 1, 0, 0, 0], [0, 0, 0, 1, 0, 0, 0]], inner_size: [0.8, 0.6, 0.4] };

async function boxOf(page: Page, selector: string): Promise<{ x: number; y: number; width: number; height: number }> {
  return (await page.locator(selector).first().boundingBox())!;
}

describe("layouts", () => {
  it.each([[800, 600], [1280, 720]])("has one line of headline, of tools and of legend at %i x %i, and nothing over the drawing", async (width, height) => {
    const recording = smallHeader(300, { result: RESULT, container: CONTAINER, sequence: "1", snug_version: "0.1.0 (0123456789-dirty)" });
    const { page, errors, close } = await open(browser, pageWith("layout", [recording]), width, height);
    await page.waitForTimeout(200);
    const drawing = await boxOf(page, ".view canvas");
    expect(drawing.width).toBeGreaterThan(400);
    expect(drawing.height).toBeGreaterThan(350);
    for (const [selector, most] of [[".bar", 40], [".warnings", 26], [".toolbar", 40], [".legend-box", 26], [".timeline", 50]] as const) {
      const box = await boxOf(page, selector);
      expect(box.height, selector).toBeLessThan(most);
      const isApart = box.y + box.height <= drawing.y + 0.5 || box.y >= drawing.y + drawing.height - 0.5;
      expect(isApart, `${selector} beside the drawing`).toBe(true);
    }
    for (const button of await page.locator(".bar button:visible, .toolbar button:visible, .toolbar summary:visible, .timeline button:visible").all()) {
      const box = (await button.boundingBox())!;
      expect(box.x + box.width, await button.textContent() ?? "").toBeLessThanOrEqual(width);
    }
    expect(await page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.scrollHeight])).toEqual([width, height]);
    const states = await page.locator(".box .state").all();
    for (const state of states) expect((await state.boundingBox())!.height).toBeLessThan(24);
    await page.keyboard.press("w");
    const plots = await boxOf(page, ".plots");
    for (const button of await page.locator(".toolbar button:visible, .toolbar summary:visible").all()) {
      const box = (await button.boundingBox())!;
      expect(box.x + box.width, `${await button.textContent() ?? ""} beside wide plots`).toBeLessThanOrEqual(plots.x);
    }
    expect(errors).toEqual([]);
    await close();
  });

  it("says what labels mean: who reached it, as printed or counted as this run", async () => {
    const { page, close } = await open(browser, pageWith("labels", [smallHeader(100, { result: RESULT, container: CONTAINER })]));
    const text = (await page.locator(".fill-row").allTextContents()).join("\n");
    expect(text).toContain("I.AM. a robot, programmed by hand");
    expect(text).toContain("the same 12 boxes, counted as this run");
    expect(text).not.toContain("as here");
    await close();
  });
});

describe("a scene without tool", () => {
  it("shows no tool, no cup and no count of packed boxes, and its bodies in view", async () => {
    const rows = Array.from({ length: 100 }, (_, k) => k);
    const tool: ChannelInput[] = [
      { name: "tool.pose", columns: ["x", "y", "z", "qw", "qx", "qy", "qz"], quantum: 1e-5, rows: rows.map(() => [0, 0, 0, 1, 0, 0, 0]) },
      { name: "cup.pressure_gauge", columns: ["pressure"], quantum: 10, rows: rows.map(() => [0]) },
      { name: "time", columns: ["t"], quantum: 1e-6, rows: rows.map((k) => [0.01 * k]) },
      { name: "body.0.pose", columns: ["x", "y", "z", "qw", "qx", "qy", "qz"], quantum: 1e-5, rows: rows.map((k) => [30 + 0.01 * k, 4, 0.5, 1, 0, 0, 0]) },
      { name: "solver.residual", columns: ["residual"], quantum: 1e-8, rows: rows.map(() => [1e-6]) },
    ];
    const body = { name: "far", type: "", kind: "dynamic", mass: 1, com: [0, 0, 0], shapes: [{ kind: "box", pose: [0, 0, 0, 1, 0, 0, 0], half: [0.5, 0.5, 0.5] }] };
    const result = { boxes: [], filling_degree_percent: 0, packed: 0, failure: "", warnings: [], report_table7: null };
    const form = encodeReplay({ format: "snug replay", version: 1, frames: 100, bodies: [body], result }, tool);
    const { page, errors, close } = await open(browser, pageWith("scene", [form]));
    await page.waitForSelector(".plot");
    expect(await page.locator(".group summary").allTextContents()).toEqual(["Contacts and solver"]);
    expect(await page.textContent(".headline")).not.toContain("packed");
    expect(await page.locator(".cameras").first().locator("button").allTextContents()).toEqual(["cell", "top", "side"]);
    expect(await page.locator(".fill-row").count()).toBe(0);
    // Its middle is a box: a click there selects it.
    const drawing = await boxOf(page, ".view canvas");
    await page.mouse.click(drawing.x + drawing.width / 2, drawing.y + drawing.height / 2);
    expect(await page.textContent(".box.selected b")).toBe("far");
    expect(errors).toEqual([]);
    await close();
  });
});

describe("plots", () => {
  it("show a window that follows the time, zoom where one drags, go back, and grow wide", async () => {
    const { page, errors, close } = await open(browser, pageWith("window", [smallHeader(9000)]));
    await page.click(".item-events .head");
    await page.waitForSelector(".plot");
    expect(await page.evaluate(() => window.snug.plotted())).toEqual([0, 20]);
    await page.evaluate(() => window.snug.setTime(50));
    const [begin, end] = (await page.evaluate(() => window.snug.plotted()))!;
    expect(end - begin).toBeCloseTo(20, 6);
    expect(begin < 50 && 50 < end).toBe(true);
    const plot = await boxOf(page, ".plot .u-over");
    await page.mouse.move(plot.x + 50, plot.y + 20);
    await page.mouse.down();
    await page.mouse.move(plot.x + 120, plot.y + 20, { steps: 4 });
    await page.mouse.up();
    await expect.poll(async () => { const [a, b] = (await page.evaluate(() => window.snug.plotted()))!; return b - a; }).toBeLessThan(8);
    await page.click(".when .back");
    await expect.poll(async () => { const [a, b] = (await page.evaluate(() => window.snug.plotted()))!; return b - a; }).toBeCloseTo(20, 6);
    await page.selectOption(".when .window", "0");
    expect(await page.evaluate(() => window.snug.plotted())).toBeNull();
    const narrow = (await boxOf(page, ".plot .u-over")).width;
    await page.keyboard.press("w");
    await expect.poll(async () => (await boxOf(page, ".plot .u-over")).width).toBeGreaterThan(2 * narrow);
    await page.keyboard.press("w");
    await expect.poll(async () => (await boxOf(page, ".plot .u-over")).width).toBeCloseTo(narrow, 0);
    expect(errors).toEqual([]);
    await close();
  });
});

describe("measuring and cutting", () => {
  it("measures between corners of boxes that are clicked, and cuts the container open", async () => {
    const { page, errors, close } = await open(browser, pageWith("measure", [smallHeader(100, { container: CONTAINER })]));
    await page.evaluate(() => window.snug.setTime(0));
    await page.keyboard.press("2"); // from above: x and y of the drawing are those of the world
    await page.keyboard.press("m");
    const drawing = await boxOf(page, ".view canvas");
    // The container of 0.8 m (with a margin of 1.3) lies across the picture; the box of 0.2 x 0.16 m at (0.3, 0), 0.2 m up.
    const metre = drawing.height / Math.max((0.8 * 1.3 * drawing.height) / drawing.width, 0.6 * 1.3);
    const at = (x: number, y: number): [number, number] => [drawing.x + drawing.width / 2 + x * metre, drawing.y + drawing.height / 2 - y * metre];
    await page.mouse.click(...at(0.3 - 0.098, -0.078));
    await page.mouse.click(...at(0.3 + 0.098, -0.078));
    const text = await page.evaluate(() => window.snug.measured());
    expect(Number(/^([\d.]+) mm/.exec(text)?.[1])).toBeCloseTo(200, 0);
    await expect.poll(() => page.textContent(".legend-box .measured")).toBe(text); // written when it is drawn
    await page.keyboard.press("Escape");
    expect(await page.evaluate(() => window.snug.measured())).toBe("");
    await page.click(".item-events .head"); // a selected box has its name
    await expect.poll(() => page.locator(".labels .label").count()).toBeGreaterThan(0);
    const before = await page.locator(".view canvas").screenshot();
    await page.evaluate(() => window.snug.section("x", 0.85));
    await page.keyboard.press("1");
    await page.waitForTimeout(700);
    expect((await page.locator(".view canvas").screenshot()).equals(before)).toBe(false);
    await page.evaluate(() => window.snug.section("z", 0));
    await expect.poll(() => page.locator(".labels .label").count(), { message: "what is cut away has no label" }).toBe(0);
    expect(errors).toEqual([]);
    await close();
  });
});

describe("files that are dropped", () => {
  /** Drops a file of these bytes at a place of the page, 0 to 1 from left to right. */
  async function drop(page: Page, name: string, bytes: Uint8Array, where: number): Promise<void> {
    await page.evaluate(
      ([file, base64, part]) => {
        const raw = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
        const transfer = new DataTransfer();
        transfer.items.add(new File([raw], file));
        const place = { clientX: part * window.innerWidth, clientY: 300, dataTransfer: transfer, bubbles: true, cancelable: true };
        for (const kind of ["dragover", "drop"]) document.body.dispatchEvent(new DragEvent(kind, place));
      },
      [name, Buffer.from(bytes).toString("base64"), where] as const,
    );
  }

  it("replace what is shown or overlay it; other files are refused", async () => {
    const { page, errors, close } = await open(browser, pageWith("drop", [smallHeader(100)]));
    await drop(page, "other.snug", smallHeader(50, { name: "dropped" }), 0.2);
    await expect.poll(() => page.title()).toBe("snug: dropped");
    expect(await page.evaluate(() => window.snug.frames)).toBe(50);
    const report = readFileSync(fileURLToPath(pageWith("dropped-report", [smallHeader(70, { name: "in a report" })])));
    await page.evaluate(() => window.snug.setTime(0.2));
    await drop(page, "report.html", report, 0.8);
    await expect.poll(() => page.evaluate(() => window.snug.toggles("second", true))).toBe(true);
    expect(await page.evaluate(() => window.snug.time), "what is shown goes on from where it was").toBeCloseTo(0.2, 6);
    expect(await page.title()).toBe("snug: dropped");
    const about = async (): Promise<string | null> => {  // as it is when it is opened
      await page.keyboard.press("Escape");
      await page.keyboard.press("i");
      return page.textContent(".about");
    };
    await expect.poll(about, { timeout: 10_000 }).toContain("Overlaid: in a report");
    await page.keyboard.press("Escape");
    await drop(page, "notes.txt", new TextEncoder().encode("no recording"), 0.2);
    await expect.poll(() => page.locator(".toast").textContent()).toMatch(/not a recording of snug/);
    expect(await page.evaluate(() => window.snug.frames)).toBe(50);
    expect(errors).toEqual([]);
    await close();
  });

  it("open on a page without a run", async () => {
    const { page, close } = await open(browser, pageWith("empty", []));
    expect(await page.isVisible(".error .card")).toBe(true);
    await drop(page, "a.snug", smallHeader(30, { name: "first" }), 0.5);
    await expect.poll(() => page.title()).toBe("snug: first");
    await close();
  });
});
