// ItemEvents: every box of the run with what happened to it; a click goes there.

import type { Replay } from "../replay/replay";
import type { View } from "../scene/view";
import { button, make } from "./dom";
import type { Player } from "./player";

interface ItemEvent {
  kind: string;
  time: number;
  text: string;
}

/** A seal that is lost and found at every tick is one event: `lost, 8 times`. */
function withoutChatter(events: ItemEvent[]): ItemEvent[] {
  const kept: (ItemEvent & { count: number; last: number })[] = [];
  for (const event of events) {
    const same = kept.find((k) => k.kind === event.kind && event.time - k.last < 0.5);
    if (!same) {
      kept.push({ ...event, count: 1, last: event.time });
      continue;
    }
    ++same.count;
    same.last = event.time;
  }
  return kept.map((k) => ({ ...k, kind: k.count > 1 ? `${k.kind} ${k.count}×` : k.kind }));
}

/** When a body came within 1 mm of where it ends and stayed there; null if it never moved or moves to the end. */
export function restOf(replay: Replay, body: number): ItemEvent | null {
  const end = new Float64Array(7);
  const pose = new Float64Array(7);
  if (body < 0 || !replay.bodyPose(body, replay.frames - 1, end)) return null;
  let frame = replay.frames - 2;
  while (frame >= 0 && replay.bodyPose(body, frame, pose)) {
    if (Math.hypot(pose[0]! - end[0]!, pose[1]! - end[1]!, pose[2]! - end[2]!) > 1e-3) break;
    --frame;
  }
  if (frame < 0 || frame >= replay.frames - 2 || !replay.bodyPose(body, frame, pose)) return null;
  return { kind: "rest", time: replay.timeOf(frame + 1), text: "from here on within 1 mm of where it is at the end" };
}

/** More events than this are shown for the selected and the held box only, until all are asked for. */
const MOST_EVENTS = 24;
const BAD = new Set(["recovery", "refused", "lost", "dropped", "bend", "slip", "outside", "out of cell", "deep contact"]);

/** What the session has to say of a box, beside what happened to it. */
const OF_SESSION = new Set(["recovery", "refused"]);

const merged = (own: ItemEvent[], more: ItemEvent[]): ItemEvent[] => (more.length ? [...own, ...more].sort((a, b) => a.time - b.time) : own);

export class ItemEvents {
  readonly element = make("aside", "item-events");
  private readonly all_: HTMLButtonElement;
  private isAll_: boolean | null = null;
  private held_ = "";
  private readonly rows_ = new Map<string, HTMLElement>();
  private readonly list_ = make("div");
  private events_: { button: HTMLButtonElement; time: number }[] = [];
  selected = "";
  onSelect: (box: string) => void = () => {};

  constructor(
    private readonly replay: Replay,
    private readonly player: Player,
    private readonly view: View,
  ) {
    this.all_ = button("", "Show what happened to every box, or to the selected and the held one only", () => {
      this.isAll_ = !this.list_.classList.contains("all");
      this.showAll(this.isAll_);
    });
    this.element.append(make("div", "title", make("h2", "", "Boxes"), this.all_), this.list_);
    player.onSlowChange(() => this.update());
    this.refresh();
  }

  /** Lists the boxes as they are known now: a live run grows. */
  refresh(): void {
    this.rows_.clear();
    this.events_ = [];
    this.list_.replaceChildren(...this.boxes().map(({ id, state, up, events }) => this.row(id, state, up, events)));
    this.showAll(this.isAll_ ?? this.events_.length <= MOST_EVENTS);
    this.update();
  }

  private showAll(isAll: boolean): void {
    this.list_.classList.toggle("all", isAll);
    this.all_.textContent = isAll ? "fewer" : "all events";
  }

  private boxes(): { id: string; state: string; up: string; events: ItemEvent[] }[] {
    const { result, events } = this.replay.header;
    if (result?.boxes.length) {
      const ofSession = events.filter((event) => OF_SESSION.has(event.kind));
      return result.boxes.map((box) => ({ id: box.id, state: box.state ?? "", up: box.up, events: merged(box.events, ofSession.filter((e) => e.body === box.id)) }));
    }
    return this.replay.bodies
      .filter((body) => body.kind === "dynamic")
      .map((body) => ({ id: body.name, state: "", up: "", events: events.filter((e) => e.body === body.name) }));
  }

  private row(id: string, state: string, up: string, events: ItemEvent[]): HTMLElement {
    const body = this.replay.bodyIndex(id);
    const swatch = make("i", "swatch");
    swatch.style.background = this.view.colours.of(this.replay.bodies[body]?.type ?? "");
    const head = button("", "Select this box (again: none)", () => this.select(this.selected === id ? "" : id), "head");
    const article = this.replay.bodies[body]?.type ?? "";
    head.append(swatch, ...(article ? [make("b", "", article), make("span", "type", id)] : [make("b", "", id)]));
    if (state) head.append(make("span", `state ${state}`, up ? `${state}, ${up} up` : state));
    const list = make("div", "events");
    const rest = restOf(this.replay, body);
    const life = make("div", "life");
    for (const event of [...withoutChatter(events), ...(rest ? [rest] : [])]) {
      life.append(this.mark(event));
      const go = button(event.kind, event.text || event.kind, () => {
        this.player.pause();
        this.player.setTime(event.time);
        this.select(id);
      });
      go.append(make("time", "", event.time.toFixed(1)));
      list.append(go);
      this.events_.push({ button: go, time: event.time });
    }
    const row = make("section", "box", head, life, list);
    this.rows_.set(id, row);
    return row;
  }

  /** An event on the line of the box: where along it, that is when in the run. */
  private mark(event: ItemEvent): HTMLElement {
    const mark = make("i", BAD.has(event.kind.split(" ")[0]!) ? "bad" : event.kind);
    mark.style.left = `${(100 * (event.time - this.replay.start)) / Math.max(this.replay.end - this.replay.start, 1e-9)}%`;
    return mark;
  }

  select(id: string): void {
    this.selected = id;
    this.view.setSelected(this.replay.bodyIndex(id));
    this.update();
    if (id) this.rows_.get(id)?.scrollIntoView({ block: "nearest" });
    this.onSelect(id);
  }

  private update(): void {
    const held = this.replay.bodies[this.replay.attachedBody(this.player.frame)]?.name;
    for (const [id, row] of this.rows_) {
      row.classList.toggle("selected", id === this.selected);
      row.classList.toggle("held", id === held);
    }
    if (held !== undefined && held !== this.held_) this.rows_.get(held)?.scrollIntoView({ block: "nearest" });
    this.held_ = held ?? "";
    for (const { button: go, time } of this.events_) go.classList.toggle("past", time <= this.player.time + 1e-6);
  }
}
