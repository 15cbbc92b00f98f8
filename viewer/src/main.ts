// Main: finds the recordings in the page, decodes them and shows them, or says why not.

import { acceptDrops } from "./drop";
import { askServer, awaitNextRun, followLive } from "./live";
import { decodeBase64, decodeReplay } from "./replay/decode";
import { ReplayError } from "./replay/errors";
import { Replay } from "./replay/replay";
import { CAMERA_NAMES, type CameraName } from "./scene/cameras";
import type { Theme } from "./scene/palette";
import type { SectionAxis } from "./scene/section";
import type { ViewOption } from "./scene/view";
import { App } from "./ui/app";
import { make } from "./ui/dom";
import "./ui/style.css";

/** What tests and `snug picture` ask and tell the page. */
interface Handle {
  readonly error: string;
  readonly time: number;
  readonly frame: number;
  readonly frames: number;
  /** Time of the last frame, s. */
  readonly end: number;
  setTime(time: number): void;
  bodyPose(name: string): { p: number[]; quat_wxyz: number[] } | null;
  lip(): number[];
  toggles(name: ViewOption, on: boolean): boolean;
  play(speed: number): void;
  pause(): void;
  fps(): number;
  drawCalls(): number;
  /** Cuts the drawing open along an axis of the container, at a part of its length from 0 to 1. */
  section(axis: SectionAxis, part?: number): void;
  /** Distance and its parts, as the legend says it; empty before two points were clicked. */
  measured(): string;
  /** What the plots show of the time, s; null is the whole run. */
  plotted(): [number, number] | null;
}

declare global {
  interface Window {
    snug: Handle | { error: string };
    snugReady: boolean;
  }
}

const fragment = new URLSearchParams(location.hash.slice(1));

function theme(): Theme {
  const asked = fragment.get("theme");
  if (asked === "light" || asked === "dark") return asked;
  return matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
}

async function recordingsInPage(): Promise<Replay[]> {
  const replays: Replay[] = [];
  for (let k = 0; ; ++k) {
    const element = document.getElementById(`snug-recording-${k}`);
    if (!element) return replays;
    replays.push(new Replay(await decodeReplay(decodeBase64(element.textContent ?? ""))));
    element.remove(); // the text is no longer needed
  }
}

function handleOf(app: App): Handle {
  return {
    error: "",
    get time() {
      return app.player.time;
    },
    get frame() {
      return app.player.frame;
    },
    get frames() {
      return app.replay.frames;
    },
    get end() {
      return app.replay.end;
    },
    setTime: (time) => {
      app.player.setTime(time);
      app.view.render();
    },
    bodyPose: (name) => app.view.drawnPose(name),
    lip: () => app.view.lip,
    toggles: (name, on) => {
      app.setOption(name, on);
      return app.view.options[name];
    },
    play: (speed) => {
      app.player.setSpeed(speed);
      app.player.play();
    },
    pause: () => app.player.pause(),
    fps: () => app.view.fps(),
    drawCalls: () => app.view.drawCalls,
    section: (axis, part) => app.setSection(axis, part),
    measured: () => app.view.measure.text(),
    plotted: () => app.plots.shown,
  };
}

/** Follows what the address asks for: #t=12.3&camera=top&picture=1&theme=dark&show=frames,trace. */
function followAddress(app: App): void {
  const camera = fragment.get("camera") as CameraName | null;
  if (camera && CAMERA_NAMES.includes(camera)) app.useCamera(camera);
  const time = Number(fragment.get("t") ?? "NaN");
  if (Number.isFinite(time)) app.player.setTime(time);
  for (const option of app.view.available) {
    if (fragment.get("show")?.split(",").includes(option)) app.setOption(option, true);
    if (fragment.get("hide")?.split(",").includes(option)) app.setOption(option, false);
  }
}

function showPicture(app: App): void {
  document.documentElement.classList.add("picture");
  const [width, height] = (fragment.get("size") ?? "").split("x").map(Number);
  app.view.resize(width || window.innerWidth, height || window.innerHeight);
  followAddress(app);
  app.view.freeze();
}

function showError(error: unknown): void {
  const known = error instanceof ReplayError ? error : new ReplayError("This page failed", String(error));
  window.snug = { error: `${known.title}: ${known.detail}` };
  const card = make("div", "card", make("h1", "", known.title), make("p", "", known.detail));
  if (known.hint) card.append(make("p", "hint", known.hint));
  document.getElementById("app")!.replaceChildren(make("div", "error", card));
}

let current: App | null = null;

/** A message that goes away by itself, when what is shown stays. */
function toast(error: unknown): void {
  const known = error instanceof ReplayError ? error : new ReplayError("This page failed", String(error));
  const note = make("div", "toast", `${known.title}: ${known.detail}${known.hint ? ` ${known.hint}` : ""}`);
  note.setAttribute("role", "alert");
  document.body.append(note);
  window.setTimeout(() => note.remove(), 8000);
}

function show(first: Replay, second: Replay | null): App {
  const before = current?.replay === first ? current : null; // something is laid over it
  current?.dispose();
  const app = (current = new App(first, second, theme(), fragment.has("picture")));
  document.getElementById("app")!.replaceChildren(app.element);
  document.title = `snug: ${first.header.name}`;
  app.start();
  if (fragment.has("picture")) showPicture(app);
  else followAddress(app);
  if (before) app.goOnFrom(before);
  window.snug = handleOf(app);
  return app;
}

async function main(): Promise<void> {
  performance.mark("snug:start");
  document.documentElement.dataset.theme = theme();
  acceptDrops({ current: () => current?.replay ?? null, show, fail: (error) => (current ? toast(error) : showError(error)) });
  let replays = await recordingsInPage();
  if (replays.length === 0 && location.protocol.startsWith("http")) {
    const served = await askServer();
    if (served.isLive) return followLive((replay) => show(replay, null), showError);
    if (served.hasMore) awaitNextRun();
    replays = served.replays;
  }
  const [first, second] = replays;
  if (!first) {
    throw new ReplayError("There is no recording in this page", "It is the page without a run.", "Drop a recording (.h5) or a report (.html) onto it, or make one with `snug report RECORDING.h5 -o report.html`.");
  }
  if (first.frames === 0) throw new ReplayError("This recording is empty", "It has no frame.", "Was the run stopped before its first second?");
  performance.mark("snug:decoded");
  show(first, second ?? null);
  performance.mark("snug:started");
}

main()
  .catch(showError)
  .finally(() => {
    requestAnimationFrame(() => {
      window.snugReady = true;
      if (fragment.has("picture")) document.title = "snug:ready";
    });
  });
