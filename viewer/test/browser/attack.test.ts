// A page of another site, in Chromium, against the server of a live run: it can neither steer the run nor read it.

import type { ChildProcess } from "node:child_process";
import { createServer, type Server } from "node:http";
import type { AddressInfo } from "node:net";
import { join } from "node:path";
import type { Browser, Page } from "playwright-core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { openBrowser } from "../support/browser";
import { repository, serveWith } from "../support/program";

let browser: Browser;
let child: ChildProcess;
let target = "";
let foreign: Server;
let page: Page;

beforeAll(async () => {
  ({ child, address: target } = await serveWith("view", "--live", join(repository, "scenarios/drop.yaml"), "--speed", "0.01", "--no-open"));
  foreign = createServer((_, response) => response.setHeader("Content-Type", "text/html").end("<title>foreign</title>"));
  await new Promise<void>((resolve) => foreign.listen(0, "127.0.0.1", resolve));
  // A name that the attacker owns and lets point to this machine.
  browser = await openBrowser();
  page = await browser.newPage();
  await page.goto(`http://localhost:${(foreign.address() as AddressInfo).port}/`);
});
afterAll(async () => {
  await browser?.close();
  child?.kill();
  foreign?.closeAllConnections();
  foreign?.close();
});

/** What the server tells its watchers until now: all events from the beginning of the run. */
async function told(): Promise<string> {
  const stop = new AbortController();
  const response = await fetch(`${target}live`, { signal: stop.signal });
  setTimeout(() => stop.abort(), 700);
  let text = "";
  try {
    const reader = response.body!.getReader();
    for (let part = await reader.read(); !part.done; part = await reader.read()) text += Buffer.from(part.value).toString();
  } catch {
    // ended by us
  }
  return text;
}
const isPaused = async (): Promise<boolean> => (await told()).includes('"paused":true');

const COMMAND = "POST /live/pause HTTP/1.1\r\nHost: localhost\r\nX-Snug: 1\r\nContent-Length: 0\r\n\r\n";

describe("a page of another site", () => {
  it("is another origin, and the server is there", async () => {
    expect(await page.title()).toBe("foreign");
    expect((await fetch(`${target}recordings.json`)).status).toBe(200);
    expect(await told()).toContain("event: header");
    expect(await isPaused()).toBe(false);
  });

  it("cannot pause the run by a request within the body of another", async () => {
    const sent = await page.evaluate(async ([url, body]) => {
      const ways = ["", "live/pause", "recordings.json"];
      const answers: string[] = [];
      for (const way of [...ways, ...ways]) {
        // As a browser lets any page send it: text/plain asks for no leave.
        answers.push(await fetch(url + way, { method: "POST", mode: "no-cors", body: body! }).then((r) => r.type, () => "failed"));
      }
      return answers;
    }, [target, COMMAND]);
    expect(sent).toContain("opaque"); // it was sent, and answered
    expect(await isPaused()).toBe(false);
  });

  it("cannot send the header of the server's own page, nor read anything", async () => {
    const [steered, read, streamed] = await page.evaluate(async (url) => [
      await fetch(`${url}live/pause`, { method: "POST", headers: { "X-Snug": "1" } }).then(() => "sent", () => "refused"),
      await fetch(`${url}recordings.json`).then(() => "read", () => "refused"),
      await new Promise<string>((resolve) => {
        const events = new EventSource(`${url}live`);
        events.addEventListener("header", () => resolve("read"));
        events.onerror = () => resolve("refused");
      }),
    ], target);
    expect([steered, read, streamed]).toEqual(["refused", "refused", "refused"]);
    expect(await isPaused()).toBe(false);
  });

  it("cannot take the places of watchers", async () => {
    await page.evaluate(async (url) => {
      const sources = Array.from({ length: 12 }, () => new EventSource(`${url}live`));
      await Promise.all(sources.map((source) => new Promise<void>((resolve) => { source.onerror = () => resolve(); })));
      const images = Array.from({ length: 12 }, () => { const image = new Image(); image.src = `${url}live`; return image; });
      await Promise.all(images.map((image) => new Promise<void>((resolve) => { image.onerror = () => resolve(); })));
    }, target);
    expect(await told()).toContain("event: header");
  });

  it("gets nothing under a name of its own that points to this machine", async () => {
    const rebound = await browser.newPage();
    const answer = await rebound.goto(target.replace("127.0.0.1", "evil.example"));
    expect(answer!.status()).toBe(403);
    const status = await rebound.evaluate(() => fetch("/live/pause", { method: "POST", headers: { "X-Snug": "1" } }).then((r) => r.status));
    expect(status).toBe(403);
    expect(await isPaused()).toBe(false);
    await rebound.close();
  });

  it("would be noticed if it had paused the run", async () => {
    expect((await fetch(`${target}live/pause`, { method: "POST", headers: { "X-Snug": "1" } })).status).toBe(204);
    expect(await isPaused()).toBe(true);
  });
});
