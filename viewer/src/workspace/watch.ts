// Watch: a run in 3D while it goes on, by the viewer's own drawing.

import { decodeBase64, decodeReplay } from "../replay/decode";
import { Replay } from "../replay/replay";
import { View } from "../scene/view";
import { api } from "./api";
import { make, setChoices } from "./dom";
import { nextTime, Throttle } from "./pace";

/** Frames whose contacts nobody asks for are many: a page that watches for hours begins anew after so many. */
const MOST_FRAMES = 60_000;
/** Pictures a second where a processor draws. */
const MOST_PICTURES = 40;
/** ms between two changes of the words beside, which the browser sets anew. */
const BETWEEN_WORDS = 250;

export class Watch {
  readonly element = make("div", "watch");
  private readonly stage_ = make("div", "stage");
  private readonly text_ = make("span", "hint");
  private readonly camera_ = make("select");
  private source_: EventSource | null = null;
  private view_: View | null = null;
  private replay_: Replay | null = null;
  private name_ = "";
  private shown_ = 0;
  private pictures_ = 0;
  private isOver_ = false;
  private framedAt_ = 0;

  constructor() {
    setChoices(this.camera_, [["cell", "cell"], ["top", "top"], ["side", "side"], ["tool", "tool"]]);
    this.camera_.setAttribute("aria-label", "Camera");
    this.camera_.addEventListener("change", () => this.view_?.useCamera(this.camera_.value as "cell"));
    this.stage_.setAttribute("role", "img");
    this.element.append(make("div", "bar", this.camera_, this.text_), this.stage_);
    this.element.hidden = true;
    new ResizeObserver(() => this.resize()).observe(this.stage_);
    (window as unknown as { snugWatch: object }).snugWatch = {
      frames: () => this.replay_?.frames ?? 0, shown: () => this.shown_, end: () => this.replay_?.end ?? 0, fps: () => this.view_?.fps() ?? 0,
      pictures: () => this.pictures_, poses: () => this.view_?.poses ?? [],
    };
  }

  /** Which run is watched; empty: none. */
  get name(): string {
    return this.name_;
  }

  begin(name: string): void {
    if (name === this.name_) return;
    this.end();
    this.name_ = name;
    this.isOver_ = false;
    this.stage_.setAttribute("aria-label", `The run ${name} in 3D`);
    const source = (this.source_ = api.frames(name));
    // Messages are unpacked one after the other, however fast they come.
    let queue: Promise<void> = Promise.resolve();
    const on = (event: string, act: (data: string) => Promise<void> | void): void =>
      source.addEventListener(event, (message) => {
        queue = queue.then(() => (source === this.source_ ? act((message as MessageEvent<string>).data) : undefined)).catch(() => this.stop());
      });
    on("header", async (data) => {
      this.replay_ = new Replay(await decodeReplay(decodeBase64(data)));
      this.replay_.warnings.length = 0; // it is no fault that it goes on
    });
    on("frames", (data) => this.grow(data));
    on("end", () => this.stop());
    on("over", () => this.stop());
    source.addEventListener("error", () => this.stop());
  }

  /** Nothing is watched. */
  end(): void {
    this.source_?.close();
    this.source_ = null;
    this.view_?.dispose();
    this.view_ = null;
    this.replay_ = null;
    this.shown_ = 0;
    this.name_ = "";
    this.stage_.replaceChildren();
    this.element.hidden = true;
  }

  private stop(): void {
    this.source_?.close();
    this.isOver_ = true;
  }

  private async grow(data: string): Promise<void> {
    const replay = this.replay_;
    if (!replay || replay.frames > MOST_FRAMES) return;
    replay.append(await decodeReplay(decodeBase64(data)));
    if (this.view_ || replay.frames === 0) return this.reframe(replay);
    this.element.hidden = false;
    this.view_ = new View(replay, null, matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
    this.stage_.replaceChildren(this.view_.element);
    this.resize();
    this.view_.useCamera(this.camera_.value as "cell");
    // Marks of hundreds of contacts take more than all the rest; the report has them.
    for (const option of ["contacts", "forces"] as const) this.view_.setOption(option, false);
    this.view_.onAfterRender = () => ++this.pictures_;
    this.framedAt_ = replay.frames;
    this.play(this.view_, replay);
  }

  /** Shows what came, at a clock of its own: smooth between frames and between the messages that bring them. */
  private play(view: View, replay: Replay): void {
    const throttle = new Throttle(view.isSoftware ? MOST_PICTURES : Infinity);
    this.shown_ = replay.start;
    let last = performance.now(), worded = 0, drawn = NaN;
    const tick = (now: number): void => {
      if (view !== this.view_) return;
      this.shown_ = nextTime(this.shown_, replay.end, Math.min(0.25, Math.max(0, now - last) / 1000), !this.isOver_);
      last = now;
      const isSeen = this.stage_.clientWidth > 0; // else another tab is shown
      const isDone = this.isOver_ && this.shown_ >= replay.end;
      if ((isSeen || isDone) && this.shown_ !== drawn && throttle.may(now)) {
        view.setFrame(replay.frameBetween(this.shown_));
        drawn = this.shown_;
      }
      if (isDone || now - worded > BETWEEN_WORDS) {
        worded = now;
        const behind = replay.end - this.shown_;
        this.text_.textContent = `${this.shown_.toFixed(1)} s of the plant's time${isDone ? "; it is over" : behind >= 1 ? `; ${behind.toFixed(0)} s behind the run` : ""}`;
      }
      if (!isDone || drawn !== this.shown_) requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  /** Boxes that came since may lie outside the picture: it is framed again, less and less often. */
  private reframe(replay: Replay): void {
    if (!this.view_ || replay.frames < 4 * this.framedAt_ || this.framedAt_ > 2000) return;
    this.framedAt_ = replay.frames;
    if (this.camera_.value === "cell") this.view_.useCamera("cell");
  }

  private resize(): void {
    if (this.stage_.clientWidth > 0) this.view_?.resize(this.stage_.clientWidth, this.stage_.clientHeight);
  }
}
