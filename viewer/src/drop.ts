// Drop: recordings and reports that are dragged onto the page: one half replaces what is shown, the other overlays it.

import { decodeBase64, decodeReplay } from "./replay/decode";
import { ReplayError } from "./replay/errors";
import { decodeHdf5, isHdf5 } from "./replay/hdf5";
import { Replay } from "./replay/replay";
import { make } from "./ui/dom";

const EMBEDDED = /<script type="application\/octet-stream;base64" id="snug-recording-\d+"[^>]*>([^<]*)<\/script>/g;

/** The recordings of a file: a recording (.h5), a replay form, or a report with one or two in it. Throws ReplayError. */
export async function readDropped(name: string, bytes: Uint8Array): Promise<Replay[]> {
  if (isHdf5(bytes)) return [new Replay(decodeHdf5(bytes, name))];
  if (String.fromCharCode(...bytes.subarray(0, 8)) === "SNUGRPL1") return [new Replay(await decodeReplay(bytes))];
  const text = new TextDecoder().decode(bytes);
  const replays: Replay[] = [];
  for (const [, base64] of text.matchAll(EMBEDDED)) replays.push(new Replay(await decodeReplay(decodeBase64(base64!))));
  if (replays.length > 0) return replays;
  throw new ReplayError("This is not a recording of snug", `${name} is neither a recording (.h5) nor a report (.html) of snug.`, "`snug simulate ... -o run.h5` makes a recording, `snug report run.h5 -o run.html` a report.");
}

/** A recording does not have the meshes of its robot (`snug report` adds them): one with the links of the robot that is shown looks like it. */
function borrowLooks(replay: Replay, shown: Replay): void {
  const [robot, other] = [replay.header.robot, shown.header.robot];
  if (!robot || robot.looks?.length || !other?.looks?.length) return;
  const rows = new Map(robot.links.map((link) => [replay.bodies[link]!.name, link]));
  if (rows.size !== other.links.length || !other.links.every((link) => rows.has(shown.bodies[link]!.name))) return;
  robot.looks = other.looks.map((look) => ({ ...look, body: rows.get(shown.bodies[look.body]!.name)! }));
}

export interface DropTarget {
  /** What is shown now; null when nothing is. */
  current(): Replay | null;
  show(first: Replay, second: Replay | null): void;
  fail(error: unknown): void;
}

/** Shows where to drop while a file is dragged over the page, and opens what is dropped. */
export function acceptDrops(target: DropTarget): void {
  const open = make("div", "drop-half", make("b", "", "open"), "replaces what is shown");
  const over = make("div", "drop-half", make("b", "", "lay over"), "this run, as wire boxes and dashed curves");
  const overlay = make("div", "drop", open, over);
  overlay.hidden = true;
  document.body.append(overlay);
  const isFile = (e: DragEvent): boolean => e.dataTransfer?.types.includes("Files") ?? false;
  const isOver = (e: DragEvent): boolean => target.current() !== null && e.clientX > window.innerWidth / 2;
  window.addEventListener("dragover", (e) => {
    if (!isFile(e)) return;
    e.preventDefault();
    overlay.hidden = false;
    over.hidden = target.current() === null;
    open.classList.toggle("on", !isOver(e));
    over.classList.toggle("on", isOver(e));
  });
  window.addEventListener("dragleave", (e) => {
    if (e.relatedTarget === null) overlay.hidden = true;
  });
  window.addEventListener("drop", (e) => {
    if (!isFile(e)) return;
    e.preventDefault();
    overlay.hidden = true;
    void take([...(e.dataTransfer?.files ?? [])], isOver(e)).catch((error: unknown) => target.fail(error));
  });

  async function take(files: File[], onto: boolean): Promise<void> {
    const replays: Replay[] = [];
    for (const file of files.slice(0, 2)) replays.push(...(await readDropped(file.name, new Uint8Array(await file.arrayBuffer()))));
    const [first, second] = replays;
    if (!first) return;
    const current = target.current();
    if (current) for (const replay of replays) borrowLooks(replay, current);
    if (onto && current) target.show(current, first);
    else target.show(first, second ?? null);
  }
}
