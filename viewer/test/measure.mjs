// Measures a report page in Chromium without a graphics card, beside the targets: `npm run measure -- report.html [SECOND]`.
// Not a test: the numbers depend on what else the machine does. SECOND: where in the run to play from (default: the middle).

import { readFileSync, readdirSync } from "node:fs";
import { resolve } from "node:path";
import { chromium } from "playwright-core";

const [report, from] = process.argv.slice(2);
if (!report) {
  console.error("usage: npm run measure -- report.html [SECOND]");
  process.exit(2);
}
const args = ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--enable-precise-memory-info", "--disable-quic"];

/** Proportional set size of the renderer that uses most, MB: the page, with its share of Chromium's own code. */
function rendererMegabytes(others) {
  let most = 0;
  for (const pid of readdirSync("/proc").filter((name) => /^\d+$/.test(name) && !others.has(name))) {
    try {
      if (!readFileSync(`/proc/${pid}/cmdline`, "utf8").includes("--type=renderer")) continue;
      most = Math.max(most, Number(/^Pss: *(\d+)/m.exec(readFileSync(`/proc/${pid}/smaps_rollup`, "utf8"))[1]) / 1024);
    } catch {
      // gone meanwhile, or not ours to read
    }
  }
  return most;
}

const others = new Set(readdirSync("/proc"));
const browser = await chromium.launch({ executablePath: process.env.SNUG_CHROMIUM || "/usr/bin/chromium", args });
await (await browser.newPage()).goto("about:blank"); // the browser's own start is not the page's
const page = await browser.newPage({ viewport: { width: 1380, height: 580 } });
await page.goto(`file://${resolve(report)}`);
await page.waitForFunction(() => window.snugReady);
const marks = await page.evaluate(() => performance.getEntriesByType("mark").map((mark) => [mark.name, mark.startTime]));
const canvas = await page.evaluate(() => {
  const drawing = document.querySelector(".view canvas");
  return `${drawing.clientWidth}x${drawing.clientHeight}`;
});
await page.evaluate((t) => window.snug.setTime(t), Number(from ?? NaN) || (await page.evaluate(() => window.snug.end / 2)));
await page.waitForTimeout(1500);
await page.evaluate(() => window.snug.play(1));
await page.waitForTimeout(6000);
const [fps, calls, heap] = await page.evaluate(() => [window.snug.fps(), window.snug.drawCalls(), performance.memory.usedJSHeapSize / 1e6]);
const drawn = Object.fromEntries(marks)["snug:started"] / 1000;
const row = (what, value, target) => console.log(`${what.padEnd(34)}${value.padStart(10)}   ${target}`);
row("first frame after navigation", `${drawn.toFixed(2)} s`, "<= 2 s");
row(`pictures a second, ${canvas}`, fps.toFixed(1), ">= 20");
row("draw calls a picture", String(calls), "");
row("memory of scripts", `${heap.toFixed(0)} MB`, "<= 300 MB");
row("memory of the renderer, its share", `${rendererMegabytes(others).toFixed(0)} MB`, "<= 300 MB");
await browser.close();
