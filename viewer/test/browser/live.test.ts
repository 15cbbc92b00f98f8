// The page in Chromium, served: recordings by HTTP, and a run that goes on, from a server made for the test.

import { createServer, type Server, type ServerResponse } from "node:http";
import { readFileSync } from "node:fs";
import type { AddressInfo } from "node:net";
import { join } from "node:path";
import type { Browser, Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, describe, expect, it } from "vitest";
import { openBrowser } from "../support/browser";
import { encodeReplay, type ChannelInput } from "../support/encode";
import { smallHeader } from "../support/sample";

interface Handle {
  error: string;
  time: number;
  frames: number;
  setTime(t: number): void;
  bodyPose(name: string): { p: number[] } | null;
}
declare const window: { snug: Handle; snugReady: boolean };

const POSE = ["x", "y", "z", "qw", "qx", "qy", "qz"];
const BOX = { kind: "box", pose: [0, 0, 0, 1, 0, 0, 0], half: [0.1, 0.1, 0.1] };
const body = (name: string, kind: string): object => ({ name, type: "", kind, mass: 1, com: [0, 0, 0], shapes: [BOX] });

/** Frames [first, last) of a box that moves along x by 1 mm a frame and touches the floor in one point below it. */
function part(first: number, last: number, extra: object = {}): Uint8Array {
  const rows = Array.from({ length: last - first }, (_, i) => first + i);
  const one = (name: string, of: (i: number, k: number) => number[], columns = ["value"], quantum = 1): ChannelInput => ({
    name, columns, quantum, rows: rows.map(of),
  });
  const channels: ChannelInput[] = [
    one("time", (i) => [0.01 * i], ["t"], 1e-6),
    { name: "body.0.pose", columns: POSE, quantum: 1e-5, rows: [[0, 0, -0.1, 1, 0, 0, 0]] },
    one("body.1.pose", (i) => [0.001 * i, 0, 0.1, 1, 0, 0, 0], POSE, 1e-5),
    one("body.1.present", () => [1], ["present"]),
    one("contacts.frame_first", (_, k) => [k]),
    one("contacts.frame_count", () => [1]),
    one("contacts.frame_block", (_, k) => [k]),
    one("contacts.block_body", () => [0, 1], ["a", "b"]),
    one("contacts.block_first", (_, k) => [k]),
    one("contacts.block_count", () => [1]),
    one("contacts.point", (i) => [0.001 * i, 0, 0], ["x", "y", "z"], 1e-4),
    one("contacts.normal", () => [0, 0, 1], ["x", "y", "z"], 1e-3),
    one("contacts.force", () => [0, 0, 5], ["x", "y", "z"], 1e-2),
  ];
  return encodeReplay({ format: "snug replay", version: 1, frames: last - first, events: [], ...extra }, channels);
}

const START = { name: "live", bodies: [body("floor", "static"), body("box", "dynamic")], scenario: { name: "by hand", text: "" }, complete: false };

let browser: Browser;
let server: Server;
let stream: ServerResponse | null = null;
let isLive = true;
const posts: string[] = [];

const send = (event: string, data: string): void => void stream!.write(`event: ${event}\ndata: ${data}\n\n`);
const sendForm = (event: string, form: Uint8Array): void => send(event, Buffer.from(form).toString("base64"));

/** The page without recordings, and these forms beside it. */
async function serve(recordings: Uint8Array[]): Promise<string> {
  const built = join(process.env.SNUG_VIEWER_OUT || "dist", "index.html");
  server = createServer((request, response) => {
    const path = request.url!.split("?")[0]!;
    if (request.method === "POST") {
      posts.push(`${path} ${request.headers["x-snug"]}`);
      response.writeHead(204).end();
    } else if (path === "/") {
      response.writeHead(200, { "Content-Type": "text/html" }).end(readFileSync(built, "utf8").replace("<!--snug:recordings-->", ""));
    } else if (path === "/recordings.json") {
      response.end(JSON.stringify({ recordings: isLive ? [] : recordings.map(() => ({ name: "r" })), live: isLive }));
    } else if (path.startsWith("/recording/")) {
      response.end(Buffer.from(recordings[Number(path.slice(11))]!));
    } else if (path === "/live") {
      response.writeHead(200, { "Content-Type": "text/event-stream" });
      stream = response;
      stream.write(":\n\n");
    } else {
      response.writeHead(404).end();
    }
  });
  await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
  return `http://127.0.0.1:${(server.address() as AddressInfo).port}/`;
}

async function openPage(url: string): Promise<{ page: Page; errors: string[] }> {
  const page = await browser.newPage();
  const errors: string[] = [];
  page.on("pageerror", (error) => errors.push(error.message));
  page.on("console", (message) => message.type() === "error" && !message.text().includes("favicon") && errors.push(message.text()));
  await page.goto(url);
  return { page, errors };
}

beforeAll(async () => {
  browser = await openBrowser();
});
afterAll(() => browser?.close());
afterEach(() => {
  stream?.end();
  stream = null;
  server.closeAllConnections();
  server.close();
  posts.length = 0;
});

describe("the served page", () => {
  it("shows the recordings that the server has", async () => {
    isLive = false;
    const { page } = await openPage(await serve([smallHeader(100), smallHeader(80)]));
    await page.waitForFunction(() => window.snugReady);
    expect(await page.evaluate(() => [window.snug.error, window.snug.frames])).toEqual(["", 100]);
    await page.close();
  });

  it("follows a run that goes on, commands it, and shows the whole of it at its end", async () => {
    isLive = true;
    const { page, errors } = await openPage(await serve([part(0, 30, START)]));
    while (!stream) await page.waitForTimeout(20);
    sendForm("header", part(0, 0, START));
    sendForm("frames", part(0, 1));
    await page.waitForFunction(() => window.snugReady && window.snug.frames === 1);
    sendForm("frames", part(1, 10));
    sendForm("frames", part(10, 25, { events: [{ time: 0.15, kind: "seal", body: "box", text: "", numbers: {} }] }));
    await page.waitForFunction(() => window.snug.frames === 25);
    // Follows while it stands at the end.
    expect(await page.evaluate(() => window.snug.time)).toBeCloseTo(0.24, 6);
    expect((await page.evaluate(() => window.snug.bodyPose("box")))!.p[0]).toBeCloseTo(0.024, 5);
    // References of later parts count from where the parts begin: every frame finds its own place.
    for (const frame of [0, 5, 24]) {
      const x = await page.evaluate((t) => (window.snug.setTime(t), window.snug.bodyPose("box")!.p[0]!), 0.01 * frame);
      expect(x).toBeCloseTo(0.001 * frame, 5);
    }
    await page.evaluate(() => window.snug.setTime(0.05));
    sendForm("frames", part(25, 30));
    await page.waitForFunction(() => window.snug.frames === 30);
    expect(await page.evaluate(() => window.snug.time)).toBeCloseTo(0.05, 6); // scrubbed away: stays
    await page.keyboard.press("p");
    await expect.poll(() => posts).toEqual(["/live/pause 1"]);
    send("state", '{"paused": true, "time": 0.29}');
    await page.waitForFunction("document.querySelector('.live span').textContent === 'live, paused'");
    await page.click(".live button:last-child");
    await page.keyboard.press("p");
    await expect.poll(() => posts).toEqual(["/live/pause 1", "/live/step 1", "/live/resume 1"]);
    isLive = false;
    send("end", '{"failure": ""}');
    await page.waitForFunction(() => document.querySelector(".live") === null && window.snugReady);
    expect(await page.evaluate(() => window.snug.frames)).toBe(30);
    expect(errors).toEqual([]);
    await page.close();
  });

  it("says so when a run ends without a frame, sends nonsense, or the server goes", async () => {
    isLive = true;
    const url = await serve([]);
    for (const [event, data, why] of [["end", '{"failure": "no such body"}', /no such body/], ["header", "bm9uc2Vuc2U=", /not a recording/i]] as const) {
      stream = null;
      const { page } = await openPage(url);
      while (!stream) await page.waitForTimeout(20);
      send(event, data);
      await page.waitForFunction(() => window.snug?.error);
      expect(await page.evaluate(() => window.snug.error)).toMatch(why);
      await page.close();
    }
    stream = null;
    const { page } = await openPage(url);
    while (!stream) await page.waitForTimeout(20);
    sendForm("header", part(0, 0, START));
    sendForm("frames", part(0, 5));
    await page.waitForFunction(() => window.snugReady);
    (stream as ServerResponse).destroy();
    await page.waitForFunction("document.querySelector('.live span').textContent === 'connection lost'");
    await page.close();
  });
});
