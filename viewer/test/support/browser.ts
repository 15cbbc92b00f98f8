// A real Chromium, without network, and the built page with recordings inside.

import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium, type Browser, type Page } from "playwright-core";
import { inject } from "vitest";

const root = join(dirname(fileURLToPath(import.meta.url)), "../..");
const out = join(root, "test/out");

/** The one of all test files (one_browser.ts). To close it is to leave it. */
export const openBrowser = (): Promise<Browser> => chromium.connect(inject("browser"));

/** Writes the built page with these recordings and returns its address. */
export function pageWith(name: string, recordings: Uint8Array[]): string {
  const built = join(process.env.SNUG_VIEWER_OUT || join(root, "dist"), "index.html");
  if (!existsSync(built)) throw new Error(`${built} is missing: run \`npm run build\` first`);
  const scripts = recordings.map(
    (bytes, k) => `<script type="application/octet-stream;base64" id="snug-recording-${k}" data-name="r">${Buffer.from(bytes).toString("base64")}</script>`,
  );
  mkdirSync(out, { recursive: true });
  const path = join(out, `${name}.html`);
  writeFileSync(path, readFileSync(built, "utf8").replace("<!--snug:recordings-->", () => scripts.join("\n")));
  return `file://${path}`;
}

export interface Opened {
  page: Page;
  /** Errors of the console and of scripts. */
  errors: string[];
  /** Addresses asked for beside the page itself. */
  requests: string[];
  close(): Promise<void>;
}

export async function open(browser: Browser, url: string, width = 1280, height = 720): Promise<Opened> {
  const context = await browser.newContext({ viewport: { width, height }, offline: true });
  const page = await context.newPage();
  const errors: string[] = [];
  const requests: string[] = [];
  page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
  page.on("pageerror", (error) => errors.push(error.message));
  page.on("request", (request) => !/^(file|data|blob):/.test(request.url()) && requests.push(request.url()));
  await page.goto(url);
  await page.waitForFunction(() => (window as unknown as { snugReady?: boolean }).snugReady === true);
  return { page, errors, requests, close: () => context.close() };
}
