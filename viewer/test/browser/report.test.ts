// The report of a real run in Chromium, from disk, without network: what is drawn is what the run's own table of numbers says.

import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { deflateSync, inflateSync } from "node:zlib";
import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { open, openBrowser, pageWith } from "../support/browser";
import { poseIn, readTable, repository, snug } from "../support/program";

interface Handle {
  error: string;
  time: number;
  frame: number;
  frames: number;
  setTime(t: number): void;
  bodyPose(name: string): { p: number[]; quat_wxyz: number[] } | null;
  lip(): number[];
  toggles(name: string, on: boolean): boolean;
}
declare const window: { snug: Handle };

/** A quantum of 1e-5 m of the form is off by half of it; the drawing has single precision beside that. */
const METRES = 0.5e-5 + 1e-6;
/** Half a quantum of 1e-5 in each of four parts, the normalisation, and single precision. */
const QUATERNION = 1.2e-5;

let folder = "";
let table: Map<string, number[]>;
let boxes: string[] = [];
let browser: Browser;
let page: Page;
let errors: string[] = [];
let requests: string[] = [];

beforeAll(async () => {
  folder = mkdtempSync(join(tmpdir(), "snug-report-"));
  const scenario = join(repository, "scenarios/box-demonstrator.yaml");
  const [program, recording, csv, report] = ["p.csv", "r.h5", "t.csv", "r.html"].map((name) => join(folder, name));
  snug("program", scenario, join(repository, "scenarios/demo-placements.yaml"), "--sequence", "1", "-o", program!);
  snug("simulate", scenario, "--program", program!, "--sequence", "1", "-o", recording!, "--csv", csv!);
  snug("report", recording!, "-o", report!);
  table = readTable(csv!);
  boxes = [...table.keys()].filter((name) => /^box\d+_FloatingBase_position_x$/.test(name)).map((name) => name.split("_")[0]!.toUpperCase());
  browser = await openBrowser();
  ({ page, errors, requests } = await open(browser, `file://${report}`));
});
afterAll(async () => {
  await browser?.close();
  if (folder) rmSync(folder, { recursive: true });
});

describe("the report of a real run", () => {
  it("opens from disk without network, without an error, and asks nobody", async () => {
    expect(errors).toEqual([]);
    expect(requests).toEqual([]);
    expect(await page.evaluate(() => window.snug.error)).toBe("");
    expect(await page.evaluate(() => window.snug.frames)).toBe(table.get("t")!.length);
    expect(boxes.length).toBeGreaterThanOrEqual(12);
  });

  it("moves every box to where the run had it, at forty times in any order", async () => {
    const times = table.get("t")!;
    const rows = Array.from({ length: 40 }, (_, k) => (k * 7919) % times.length);
    const drawn = await page.evaluate(
      ([when, names]) =>
        when.map((t) => {
          window.snug.setTime(t);
          return { frame: window.snug.frame, poses: names.map((name) => window.snug.bodyPose(name)) };
        }),
      [rows.map((row) => times[row]!), boxes] as const,
    );
    let compared = 0;
    rows.forEach((row, k) => {
      expect(drawn[k]!.frame).toBe(row);
      boxes.forEach((box, b) => {
        const truth = poseIn(table, box, row);
        const found = drawn[k]!.poses[b]!;
        if (!Number.isFinite(truth.p[0])) return expect(found, `${box} before it comes`).toBeNull();
        truth.p.forEach((v, c) => expect(Math.abs(found.p[c]! - v), `${box} at ${times[row]} s`).toBeLessThan(METRES));
        const sign = Math.sign(truth.quat_wxyz.reduce((sum, v, c) => sum + v * found.quat_wxyz[c]!, 0));
        truth.quat_wxyz.forEach((v, c) => expect(Math.abs(sign * found.quat_wxyz[c]! - v), `${box} at ${times[row]} s`).toBeLessThan(QUATERNION));
        ++compared;
      });
    });
    expect(compared).toBeGreaterThan(200);
  });

  it("draws the lip of the cup where the run had it while it holds", async () => {
    const [times, held] = [table.get("t")!, table.get("cup_attached")!];
    const rows = held.flatMap((isHeld, row) => (isHeld > 0 ? [row] : [])).filter((_, k) => k % 997 === 0);
    expect(rows.length).toBeGreaterThan(3);
    for (const row of rows) {
      const at = (name: string): number => table.get(name)![row]!;
      // p_WS = p_WE + R_WE p_ES; the table has the quaternion of R_EW.
      const [w, x, y, z] = [at("tool_orientation_w"), -at("tool_orientation_x"), -at("tool_orientation_y"), -at("tool_orientation_z")];
      const [a, b, c] = [at("cup_position_x"), at("cup_position_y"), at("cup_position_z")];
      const s = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)] as const;
      const truth = [
        at("tool_position_x") + a + w * s[0] + y * s[2] - z * s[1],
        at("tool_position_y") + b + w * s[1] + z * s[0] - x * s[2],
        at("tool_position_z") + c + w * s[2] + x * s[1] - y * s[0],
      ];
      const found = await page.evaluate((t) => (window.snug.setTime(t), window.snug.lip()), times[row]!);
      // Two positions and a turn of the cup's length, each rounded to half of 1e-5.
      truth.forEach((v, k) => expect(Math.abs(found[k]! - v)).toBeLessThan(3 * METRES));
    }
  });

  it("writes the numbers of the table beside the plots", async () => {
    const row = table.get("cup_attached")!.findIndex((isHeld, k) => isHeld > 0 && k > 3000);
    await page.evaluate((t) => window.snug.setTime(t), table.get("t")![row]!);
    await page.waitForSelector(".plot output");
    const shown = (await page.locator(".plot").first().locator("output").allTextContents()).map(Number);
    ["x", "y", "z"].forEach((axis, k) => expect(shown[k]).toBeCloseTo(table.get(`tool_position_${axis}`)![row]!, 3));
    const pressure = page.locator(".plot", { hasText: "Vacuum" }).locator("output");
    expect(Number(await pressure.first().textContent())).toBeCloseTo(table.get("pressure_gauge")![row]! / 1000, 1);
  });

  it("shows contacts of boxes at rest and leaves them out when they are switched off", async () => {
    const count = (): Promise<string | null> => page.locator(".legend-box small").textContent();
    await page.evaluate((t) => window.snug.setTime(t), table.get("t")!.at(-1)!);
    await expect.poll(count).toMatch(/[1-9]\d* (contact points|at rest)/);
    await page.evaluate(() => [window.snug.toggles("contacts", false), window.snug.toggles("forces", false)]);
    await expect.poll(() => page.isVisible(".legend-box .states")).toBe(false);
    await page.evaluate(() => [window.snug.toggles("contacts", true), window.snug.toggles("forces", true)]);
    await expect.poll(() => page.isVisible(".legend-box .states")).toBe(true);
  });

  it("tells what ran: run, container, settings, program with jumps, scenario", async () => {
    await page.keyboard.press("i");
    expect(await page.textContent(".about")).toContain("box-demonstrator");
    await page.click(".about .tabs >> text=Container");
    await expect.poll(() => page.locator(".about canvas").count()).toBe(2);
    expect(await page.textContent(".about .fill")).toMatch(/this run.*\d+\.\d\d %.*I\.AM\. the report's robot, programmed by hand75\.66 %.*counted as this run.*State of the Art.*32\.21 %.*Manual Operator.*75\.66 %/);
    await page.click(".about .tabs >> text=Settings");
    expect(await page.textContent(".about table")).toContain("controller");
    await page.click(".about .tabs >> text=Scenario");
    expect(await page.textContent(".about pre")).toContain("parcels:");
    await page.click(".about .tabs >> text=Program");
    const go = page.locator(".about td button").nth(5);
    const there = parseFloat((await go.textContent())!);
    await go.click();
    expect(await page.isVisible(".about .card")).toBe(false);
    expect(await page.evaluate(() => window.snug.time)).toBeCloseTo(there, 2);
  });

  it("goes to a time that is typed, and follows the keys", async () => {
    await page.keyboard.press("g");
    await page.keyboard.type("100.5");
    await page.keyboard.press("Enter");
    expect(await page.evaluate(() => window.snug.time)).toBeCloseTo(100.5, 6);
    const before = await page.evaluate(() => window.snug.frame);
    await page.keyboard.press("ArrowLeft");
    expect(await page.evaluate(() => window.snug.frame)).toBe(before - 1);
    await page.keyboard.press("f");
    await expect.poll(() => page.locator(".label.frame").allTextContents()).toEqual(expect.arrayContaining(["W", "E"]));
    await page.keyboard.press("f");
    await expect.poll(() => page.locator(".label.frame").count()).toBe(0);
    expect(errors).toEqual([]);
  });
});

describe("the recording itself, dropped onto the page", () => {
  it("is read there: every box where the run had it", async () => {
    const opened = await open(browser, pageWith("for-drop", []));
    await opened.page.evaluate(
      (base64) => {
        const raw = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
        const transfer = new DataTransfer();
        transfer.items.add(new File([raw], "r.h5"));
        document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true, cancelable: true }));
      },
      readFileSync(join(folder, "r.h5")).toString("base64"),
    );
    await expect.poll(() => opened.page.title(), { timeout: 100_000 }).toBe("snug: r.h5");
    expect(await opened.page.evaluate(() => window.snug.frames)).toBe(table.get("t")!.length);
    expect(await opened.page.textContent(".headline")).toMatch(/sequence 1packed ?\d+ of \d+/);
    await opened.page.evaluate(() => window.snug.setTime(60));
    expect(await opened.page.textContent(".timeline"), "the waypoint by its name").toMatch(/(Pick|Place|Twist|Box)\w*\(BOX\d+\)/);
    for (const row of [0, 5000, table.get("t")!.length - 1]) {
      for (const box of boxes.slice(0, 4)) {
        const found = await opened.page.evaluate(([t, name]) => (window.snug.setTime(t), window.snug.bodyPose(name)), [table.get("t")![row]!, box] as const);
        const truth = poseIn(table, box, row);
        if (!Number.isFinite(truth.p[0])) expect(found).toBeNull();
        else truth.p.forEach((v, c) => expect(Math.abs(found!.p[c]! - v)).toBeLessThan(METRES));
      }
    }
    expect(opened.errors).toEqual([]);
    await opened.close();
  }, 180_000);
});

describe("a recording that is not as it should be", () => {
  /** The report with its recording changed. */
  async function messageOf(name: string, change: (form: Buffer) => Buffer): Promise<string> {
    const html = readFileSync(join(folder, "r.html"), "utf8");
    const text = /id="snug-recording-0"[^>]*>([^<]*)</.exec(html)![1]!;
    const path = join(folder, `${name}.html`);
    writeFileSync(path, html.replace(text, () => change(Buffer.from(text, "base64")).toString("base64")));
    const opened = await open(browser, `file://${path}`);
    expect(await opened.page.isVisible(".error .card")).toBe(true);
    expect(opened.errors).toEqual([]);
    const message = await opened.page.evaluate(() => window.snug.error);
    await opened.close();
    return message;
  }

  /** The form with its header changed; lengths as they should be. */
  function withHeader(form: Buffer, change: (header: Record<string, any>) => void): Buffer {
    const content = inflateSync(form.subarray(8));
    const length = content.readUInt32LE(0);
    const header = JSON.parse(content.subarray(4, 4 + length).toString()) as Record<string, any>;
    change(header);
    const text = Buffer.from(JSON.stringify(header));
    const size = Buffer.alloc(4);
    size.writeUInt32LE(text.length);
    return Buffer.concat([form.subarray(0, 8), deflateSync(Buffer.concat([size, text, content.subarray(4 + length)]), { level: 1 })]);
  }

  it("gives a message when it is cut, of a newer version, of a size that no page can hold, or damaged", async () => {
    expect(await messageOf("cut", (form) => form.subarray(0, form.length - 1000))).toMatch(/broken/);
    expect(await messageOf("newer", (form) => withHeader(form, (h) => (h.version = 2)))).toMatch(/version/i);
    expect(await messageOf("huge", (form) => withHeader(form, (h) => h.channels.forEach((c: { rows: number }) => (c.rows = 4e9))))).toMatch(/broken|large/);
    expect(await messageOf("damaged", (form) => (form.fill(0x55, form.length >> 1, (form.length >> 1) + 64), form))).toMatch(/broken/);
    expect(await messageOf("bomb", (form) => Buffer.concat([form.subarray(0, 8), deflateSync(Buffer.alloc(250e6), { level: 1 })]))).toMatch(/too large/);
  });
});
