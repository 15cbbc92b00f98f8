// One Chromium for all files of test/browser: to start one takes seconds. Each page has a context of its own.

import { chromium } from "playwright-core";
import type { TestProject } from "vitest/node";
import { launchOptions } from "./launch";

declare module "vitest" {
  export interface ProvidedContext {
    browser: string;
  }
}

export default async function setup(project: TestProject): Promise<() => Promise<void>> {
  const server = await chromium.launchServer(launchOptions());
  project.provide("browser", server.wsEndpoint());
  return () => server.close();
}
