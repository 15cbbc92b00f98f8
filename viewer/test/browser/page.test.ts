// The page in Chromium, opened from disk without network: numbers, not pixels.

import type { Browser } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { open, openBrowser, pageWith } from "../support/browser";
import { encodeReplay } from "../support/encode";
import { pose, smallHeader } from "../support/sample";

interface Handle {
  error: string;
  time: number;
  frame: number;
  setTime(t: number): void;
  bodyPose(name: string): { p: number[]; quat_wxyz: number[] } | null;
  toggles(name: string, on: boolean): boolean;
}
declare const window: { snug: Handle };

let browser: Browser;
beforeAll(async () => {
  browser = await openBrowser();
});
afterAll(() => browser?.close());

describe("the page", () => {
  it("opens from disk without network, without an error, and asks nobody", async () => {
    const opened = await open(browser, pageWith("plain", [smallHeader(200)]));
    expect(opened.errors).toEqual([]);
    expect(opened.requests).toEqual([]);
    expect(await opened.page.title()).toBe("snug: by hand");
    await opened.close();
  });

  it("draws a box where the recording has it, after scrubbing and after steps", async () => {
    const { page, close } = await open(browser, pageWith("pose", [smallHeader(200)]));
    for (const frame of [0, 57, 199]) {
      const drawn = await page.evaluate((t) => (window.snug.setTime(t), window.snug.bodyPose("box")), 0.01 * frame);
      const truth = pose(frame);
      // A quantum of 1e-5 of the form, and single precision of the matrices of the drawing.
      drawn!.p.forEach((v, k) => expect(Math.abs(v - truth[k]!)).toBeLessThan(1.5e-5));
      const sign = Math.sign(drawn!.quat_wxyz[0]! * truth[3]!);
      drawn!.quat_wxyz.forEach((v, k) => expect(Math.abs(sign * v - truth[3 + k]!)).toBeLessThan(3e-5));
    }
    await page.evaluate(() => window.snug.setTime(0.5));
    await page.keyboard.press("ArrowRight");
    expect(await page.evaluate(() => window.snug.frame)).toBe(51);
    await page.keyboard.press("[");
    expect(await page.evaluate(() => window.snug.time)).toBeCloseTo(0.3, 6);
    await close();
  });

  it("shows a body only while it is there", async () => {
    const { page, close } = await open(browser, pageWith("late", [smallHeader(200)]));
    expect(await page.evaluate(() => (window.snug.setTime(0.1), window.snug.bodyPose("late")))).toBeNull();
    expect(await page.evaluate(() => (window.snug.setTime(1.9), window.snug.bodyPose("late")?.p[1]))).toBeCloseTo(0.5, 4);
    await close();
  });

  it("plays and pauses with the space bar", async () => {
    const { page, close } = await open(browser, pageWith("play", [smallHeader(2000)]));
    await page.keyboard.press(" ");
    await page.waitForFunction(() => window.snug.time > 0.3);
    await page.keyboard.press(" ");
    const before = await page.evaluate(() => window.snug.time);
    await page.waitForTimeout(200);
    expect(await page.evaluate(() => window.snug.time)).toBe(before);
    await close();
  });

  it("turns parts of the drawing on and off, and light into dark", async () => {
    const { page, errors, close } = await open(browser, pageWith("toggles", [smallHeader(100)]));
    for (const name of ["names", "frames", "trace", "xray", "shadows"]) {
      expect(await page.evaluate((n) => window.snug.toggles(n, true), name)).toBe(true);
      expect(await page.evaluate((n) => window.snug.toggles(n, false), name)).toBe(false);
    }
    for (const camera of ["2", "3", "4", "1"]) await page.keyboard.press(camera);
    await page.keyboard.press("d");
    expect(await page.evaluate("document.documentElement.dataset.theme")).toMatch(/dark|light/);
    await page.keyboard.press("?");
    expect(await page.isVisible(".help")).toBe(true);
    expect(errors).toEqual([]);
    await close();
  });

  it("selects a box in the list and jumps to its events", async () => {
    const { page, close } = await open(browser, pageWith("item-events", [smallHeader(100)]));
    await page.click(".item-events .events button");
    expect(await page.evaluate(() => window.snug.time)).toBeCloseTo(0.3, 6);
    expect(await page.textContent(".box.selected b")).toBe("B1"); // the article, before the id
    expect(await page.textContent(".box.selected .type")).toBe("box");
    await close();
  });

  it("draws a second recording beside the first", async () => {
    const { page, errors, close } = await open(browser, pageWith("two", [smallHeader(100), smallHeader(80)]));
    expect(await page.evaluate(() => window.snug.toggles("second", true))).toBe(true);
    expect(errors).toEqual([]);
    await close();
  });

  it("draws the links of a robot where the recording has them, and hides them together", async () => {
    const body = (name: string, kind: string, shape: object): object => ({ name, type: "", kind, mass: 1, com: [0, 0, 0], shapes: [shape] });
    const capsule = { kind: "capsule", pose: [0, 0, 0, 1, 0, 0, 0], radius: 0.05, half_length: 0.2 };
    const box = { kind: "box", pose: [0, 0, 0, 1, 0, 0, 0], half: [0.1, 0.08, 0.05] };
    const bodies = [body("robot/base", "static", box), body("robot/arm", "kinematic", capsule), body("late", "dynamic", box)];
    const { page, errors, close } = await open(browser, pageWith("robot", [smallHeader(100, { bodies, robot: { links: [0, 1] } })]));
    const drawn = (name: string): Promise<number[] | undefined> => page.evaluate((n) => (window.snug.setTime(0.4), window.snug.bodyPose(n)?.p), name);
    (await drawn("robot/arm"))!.forEach((v, k) => expect(Math.abs(v - pose(40)[k]!)).toBeLessThan(1.5e-5));
    (await drawn("robot/base"))!.forEach((v, k) => expect(v).toBeCloseTo([0, 0, -0.05][k]!, 5));
    expect(await page.evaluate(() => window.snug.toggles("robot", false))).toBe(false);
    expect(await drawn("robot/arm")).toBeUndefined();
    expect(errors).toEqual([]);
    await close();
  });

  it("is the drawing alone when a picture is asked for", async () => {
    const { page, close } = await open(browser, `${pageWith("picture", [smallHeader(100)])}#t=0.5&camera=top&picture=1`, 400, 300);
    expect(await page.isVisible(".timeline")).toBe(false);
    expect(await page.title()).toBe("snug:ready");
    expect(await page.evaluate(() => window.snug.frame)).toBe(50);
    const shot = await page.screenshot();
    expect(shot.length).toBeGreaterThan(3000); // an empty picture of this size has 1 kB
    await close();
  });

  it("says why it cannot show a broken, an empty, a huge or no recording", async () => {
    const good = smallHeader(50);
    const huge = encodeReplay({ format: "snug replay", version: 1, frames: 30_000_000 }, []);
    const cases: [Uint8Array[], RegExp][] = [
      [[], /no recording/i],
      [[good.subarray(0, good.length >> 1)], /broken|incomplete|cut/i],
      [[Uint8Array.from({ length: 4000 }, (_, i) => i % 251)], /not|no /i],
      [[huge], /./],
    ];
    for (const [recordings, why] of cases) {
      const { page, close } = await open(browser, pageWith("bad", recordings));
      expect(await page.evaluate(() => window.snug.error)).toMatch(why);
      expect(await page.isVisible(".error .card")).toBe(true);
      await close();
    }
  });
});
