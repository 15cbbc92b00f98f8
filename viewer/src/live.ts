// Live: recordings and runs that go on, from the `snug view` that served the page.

import { decodeBase64, decodeReplay } from "./replay/decode";
import { ReplayError } from "./replay/errors";
import { Replay } from "./replay/replay";
import type { App } from "./ui/app";
import { button, make } from "./ui/dom";

/** Lists and plots are made again at most this often, and so seldom that they take a tenth of the time at most. */
const REFRESH_MS = 1000;
const REFRESH_SHARE = 0.1;
/** How often a page that shows a run that is over asks whether another one has begun. */
const NEXT_RUN_MS = 1000;

interface Listing {
  recordings: { name: string }[];
  live: boolean;
  /** After the run that is over others may follow. */
  more?: boolean;
}

export async function askServer(): Promise<{ isLive: boolean; hasMore: boolean; replays: Replay[] }> {
  const fetched = async (path: string): Promise<Response> => {
    const response = await fetch(path);
    if (!response.ok) throw new ReplayError("The server has no recording", `it answers ${response.status} for ${path}.`);
    return response;
  };
  const listing = (await (await fetched("recordings.json")).json()) as Listing;
  const replays: Replay[] = [];
  for (let k = 0; k < listing.recordings.length; ++k) {
    const bytes = new Uint8Array(await (await fetched(`recording/${k}`)).arrayBuffer());
    replays.push(new Replay(await decodeReplay(bytes)));
  }
  return { isLive: listing.live, hasMore: listing.more === true, replays };
}

/** Loads the page again when another run has begun, for as long as the server is there. */
export function awaitNextRun(): void {
  const timer = window.setInterval(async () => {
    try {
      const listing = (await (await fetch("recordings.json")).json()) as Listing;
      if (!listing.live) return;
      window.clearInterval(timer);
      location.hash = "";
      location.reload();
    } catch {
      window.clearInterval(timer);
    }
  }, NEXT_RUN_MS);
}

/** Pause and step of the run itself, beside the cameras. */
class LiveBar {
  readonly element = make("div", "live");
  private readonly pause_: HTMLButtonElement;
  private readonly step_: HTMLButtonElement;
  private readonly text_ = make("span", "", "live");
  private isPaused_ = false;

  constructor() {
    this.pause_ = button("❚❚ run", "Pause or resume the simulation (p)", () => this.toggle());
    this.step_ = button("› frame", "One frame of the simulation (n)", () => void this.send("step"));
    this.element.append(this.text_, this.pause_, this.step_);
    this.setPaused(false);
    window.addEventListener("keydown", (e) => {
      if (e.ctrlKey || e.metaKey || e.altKey) return;
      if (e.key === "p") this.toggle();
      if (e.key === "n" && this.isPaused_) void this.send("step");
    });
  }

  private toggle(): void {
    void this.send(this.isPaused_ ? "resume" : "pause");
  }

  private async send(command: string): Promise<void> {
    await fetch(`live/${command}`, { method: "POST", headers: { "X-Snug": "1" } }).catch(() => this.end("server gone"));
  }

  setPaused(isPaused: boolean): void {
    this.isPaused_ = isPaused;
    this.pause_.textContent = isPaused ? "▶ run" : "❚❚ run";
    this.step_.disabled = !isPaused;
    this.text_.textContent = isPaused ? "live, paused" : "live";
  }

  end(why: string, hint = ""): void {
    this.text_.textContent = why;
    this.element.title = hint;
    this.element.classList.add("lost");
    this.pause_.disabled = this.step_.disabled = true;
  }
}

/** Shows the run as it comes; at its end loads the page again, which then has the whole run with its result. */
export async function followLive(show: (replay: Replay) => App, fail: (error: unknown) => void): Promise<void> {
  const source = new EventSource("live");
  const bar = new LiveBar();
  let replay: Replay | null = null;
  let app: App | null = null;
  let nextRefresh = 0;

  const grow = async (text: string): Promise<void> => {
    const part = await decodeReplay(decodeBase64(text));
    if (!replay) return;
    const wasAtEnd = !app || app.player.time >= replay.end - 1e-6;
    replay.append(part);
    if (!app) {
      app = show(replay);
      app.addTool(bar.element);
    }
    if (wasAtEnd && !app.player.isPlaying) app.player.setTime(replay.end);
    const begin = performance.now();
    if (begin < nextRefresh) return;
    app.refresh();
    requestAnimationFrame(() => {
      // Plots are drawn in a task of their own: what has passed until the next picture is what all of it took.
      nextRefresh = begin + Math.max(REFRESH_MS, (performance.now() - begin) / REFRESH_SHARE);
    });
    nextRefresh = begin + REFRESH_MS;
  };

  await new Promise<void>((ready) => {
    // Messages are unpacked one after the other, however fast they come.
    let queue: Promise<void> = Promise.resolve();
    const on = (event: string, act: (data: string) => Promise<void> | void): void =>
      source.addEventListener(event, (message) => {
        queue = queue
          .then(() => act((message as MessageEvent<string>).data))
          .catch((error: unknown) => {
            source.close();
            fail(error);
            ready();
          });
      });
    on("header", async (data) => {
      replay = new Replay(await decodeReplay(decodeBase64(data)));
      replay.warnings.length = 0; // it is no fault that it goes on
    });
    on("frames", async (data) => {
      await grow(data);
      ready();
    });
    on("state", (data) => bar.setPaused((JSON.parse(data) as { paused: boolean }).paused));
    on("end", (data) => {
      source.close();
      if (app) {
        location.hash = `t=${app.player.time}`;
        return location.reload();
      }
      throw new ReplayError("The run ended before its first frame", (JSON.parse(data) as { failure: string }).failure);
    });
    source.addEventListener("error", () => {
      source.close(); // it would come again from the beginning
      bar.end("connection lost", "The simulation was ended or its machine is gone. What came until then can be replayed; reload the page when `snug view --live` runs again.");
      app?.refresh();
    });
  });
}
