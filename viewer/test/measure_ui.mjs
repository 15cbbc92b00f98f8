// Measures the page of `snug ui` (`npm run measure:ui`): pictures a second while a run is watched and what serving it takes of the
// run's CPU; answers of the list with 200 runs beside 1000 orders of 50 boxes, memory; the map of a moved base. SNUG names the program.
import { execFileSync, spawn } from "node:child_process";
import { copyFileSync, existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { loadavg, tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";

const root = join(import.meta.dirname ?? new URL(".", import.meta.url).pathname, "../..");
const snug = process.env.SNUG || join(root, "build/snug");
const folder = mkdtempSync(join(tmpdir(), "snug-measure-"));
const TICK = 100; // of /proc, a second

/** s of CPU that a process used, without its children. */
function cpuOf(pid) {
  const fields = readFileSync(`/proc/${pid}/stat`, "utf8").replace(/^.*\) /s, "").split(" ");
  return (Number(fields[11]) + Number(fields[12])) / TICK;
}
const childrenOf = (pid) => execFileSync("ps", ["-o", "pid=", "--ppid", String(pid)], { encoding: "utf8" }).trim().split(/\s+/).filter(Boolean);
/** s of CPU of all processes of the browser. */
const cpuOfBrowser = () =>
  readdirSync("/proc").filter((pid) => /^\d+$/.test(pid)).reduce((sum, pid) => {
    try {
      return sum + (/chromium/.test(readFileSync(`/proc/${pid}/cmdline`, "utf8")) ? cpuOf(pid) : 0);
    } catch {
      return sum; // it has ended
    }
  }, 0);
const memoryOf = (pid) => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${pid}/status`, "utf8"))[1]) / 1024;
const median = (values) => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];

const server = spawn(snug, ["ui", folder, "--no-open"], { stdio: ["ignore", "ignore", "pipe"] });
const address = await new Promise((resolve) => {
  let said = "";
  server.stderr.on("data", (data) => {
    said += data;
    const found = /showing at (\S+)/.exec(said);
    if (found) resolve(found[1]);
  });
});
const ask = async (method, path, body) => {
  const url = new URL(address);
  const begin = performance.now();
  const answer = await fetch(`${url.origin}/api/1/${path}${url.search}`, { method, headers: { "X-Snug": "1", "Content-Type": "text/plain" }, body: body === undefined ? undefined : typeof body === "string" ? body : JSON.stringify(body) });
  const text = await answer.text();
  return { ms: performance.now() - begin, json: JSON.parse(text) };
};

const begun = (await ask("GET", "templates/demonstrator")).json;
await ask("PUT", `files/${begun.arm.name}`, begun.arm.text);
await ask("PUT", "files/cell.yaml", begun.text);
await ask("POST", "reach/cell.yaml", begun.text);
const reach = [];
for (let k = 0; k < 5; ++k) reach.push((await ask("POST", "reach/cell.yaml", begun.text.replace("pose: {yaw_deg: 180.0}", `pose: {position: [0.0${k + 1}, 0.0, 0.0], yaw_deg: 180.0}`))).ms);
console.log(`map of a moved base        ${(median(reach) / 1000).toFixed(2)} s (median of 5; at most 1)`);

const browser = await chromium.launch({
  executablePath: process.env.SNUG_CHROMIUM || "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader"],
});
const page = await browser.newPage({ viewport: { width: 1280, height: 720 } });
await page.goto(address);
await page.waitForFunction(() => window.snugReady === true);
await page.getByRole("tab", { name: "Run" }).click();
await page.getByText(/snug pack cell.yaml --sequence 1/).first().waitFor();
await page.getByRole("button", { name: "Start", exact: true }).click();
await page.waitForFunction(() => window.snugWatch.shown() > 1, null, { timeout: 600_000 });
const run = childrenOf(server.pid)[0];
const before = { ui: cpuOf(server.pid), run: cpuOf(run), browser: cpuOfBrowser() };
// What counts is a picture that was drawn and shows something else than the one before: other poses.
await page.evaluate(() => {
  const seen = (window.seen = { distinct: [], drawn: 0, begin: performance.now() });
  let last = performance.now(), pictures = window.snugWatch.pictures(), poses = "";
  const tick = (now) => {
    requestAnimationFrame(tick);
    if (window.snugWatch.pictures() === pictures) return;
    seen.drawn += window.snugWatch.pictures() - pictures;
    pictures = window.snugWatch.pictures();
    const shown = window.snugWatch.poses().join();
    if (shown === poses) return;
    poses = shown;
    seen.distinct.push(now - last);
    last = now;
  };
  requestAnimationFrame(tick);
});
let used = null; // s, as long as the run goes on
for (let k = 0; k < 80 && existsSync(`/proc/${run}/exe`); ++k) {
  await page.waitForTimeout(250);
  try {
    used = { ui: cpuOf(server.pid) - before.ui, run: cpuOf(run) - before.run, browser: cpuOfBrowser() - before.browser };
  } catch {
    break; // it has ended
  }
}
const seen = await page.evaluate(() => ({ ...window.seen, seconds: (performance.now() - window.seen.begin) / 1000 }));
if (used) {
  console.log(`CPU of serving it          ${((100 * used.ui) / used.run).toFixed(1)} % of the run's ${used.run.toFixed(1)} s (at most 5); the browser's: ${((1000 * used.browser) / seen.drawn).toFixed(0)} ms a picture`);
}
const longest = Math.max(...seen.distinct);
console.log(`pictures while it packs    ${(seen.distinct.length / seen.seconds).toFixed(0)} a second that differ (${seen.drawn} drawn in ${seen.seconds.toFixed(0)} s, median ${median(seen.distinct).toFixed(0)} ms apart, at most ${longest.toFixed(0)}; at least 30), without a graphics card at 1280x720`);
await ask("POST", "runs/run-1/stop-now");
await browser.close();

for (let k = 2; k <= 200; ++k) for (const ending of [".jsonl", ".txt"]) copyFileSync(join(folder, `run-1${ending}`), join(folder, `run-${k}${ending}`));
const lines = ["order,article,length_mm,width_mm,height_mm,mass_kg,count"];
for (let k = 1; k <= 1000; ++k) for (let i = 0; i < 5; ++i) lines.push(`o${k},a${i},${100 + 10 * i},100,80,0.3,10`);
const written = await ask("PUT", "files/many.csv", lines.join("\n") + "\n");
const first = (await ask("GET", "folder")).ms;
await new Promise((resolve) => setTimeout(resolve, 3000));
const lists = [];
for (let k = 0; k < 20; ++k) lists.push((await ask("GET", "folder")).ms);
console.log(`list of 200 runs           ${first.toFixed(0)} ms the first time, then ${median(lists).toFixed(0)} (median of 20), ${Math.max(...lists).toFixed(0)} at most (at most 100)`);
console.log(`1000 orders of 50 boxes    ${written.ms.toFixed(0)} ms to check and write; memory ${memoryOf(server.pid).toFixed(0)} MB (at most 300)`);
console.log(`load of the machine        ${loadavg()[0].toFixed(1)}`);
server.kill("SIGINT");
await new Promise((resolve) => server.once("exit", resolve));
rmSync(folder, { recursive: true, force: true });
