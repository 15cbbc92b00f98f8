// How Chromium is started for tests.

import { existsSync } from "node:fs";
import type { LaunchOptions } from "playwright-core";

/** Chromium that draws without a graphics card and asks nobody for anything: every other name is this machine. */
export function launchOptions(): LaunchOptions {
  const executablePath = process.env.SNUG_CHROMIUM || "/usr/bin/chromium";
  if (!existsSync(executablePath)) throw new Error(`${executablePath} is missing: install Debian's package chromium`);
  return {
    executablePath,
    args: ["--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
      "--disable-background-networking", "--disable-component-update", "--disable-sync", "--host-resolver-rules=MAP evil.example 127.0.0.1"],
  };
}
