// Timeline: play, step, speed, and a bar to scrub along, with a mark for every event.

import type { Replay } from "../replay/replay";
import { button, make, seconds } from "./dom";
import { SPEEDS, type Player } from "./player";

const STEPS_OF_SLIDER = 10000;
/** Events worth a mark; the rest are listed with each box. */
const MARKED = new Set(["seal", "release", "flip", "repick", "lost", "no seal", "dropped", "reseal", "bend", "slip",
  "arm_contact", "protective_stop", "out of cell", "deep contact"]);
const BAD = new Set(["lost", "no seal", "dropped", "bend", "slip", "arm_contact", "protective_stop", "out of cell",
  "deep contact"]);

export class Timeline {
  readonly element = make("footer", "timeline");
  private readonly slider_ = make("input", "slider");
  private readonly clock_ = make("span", "clock");
  private readonly now_ = make("input", "now");
  private readonly end_ = make("span");
  private readonly play_: HTMLButtonElement;
  private readonly speed_ = make("select", "speed");
  private readonly row_ = make("span", "row");
  private readonly marks_ = make("div", "marks");

  constructor(
    private readonly player: Player,
    private readonly replay: Replay,
  ) {
    this.play_ = button("▶", "Play or pause (space)", () => player.toggle(), "play");
    this.slider_.type = "range";
    this.slider_.min = "0";
    this.slider_.max = String(STEPS_OF_SLIDER);
    this.slider_.step = "1";
    this.slider_.setAttribute("aria-label", "time");
    this.slider_.addEventListener("input", () => {
      const part = Number(this.slider_.value) / STEPS_OF_SLIDER;
      player.setTime(replay.start + part * (replay.end - replay.start));
    });
    this.now_.inputMode = "decimal";
    this.now_.size = 7;
    this.now_.title = "Time, s: type one to go there (g)";
    this.now_.setAttribute("aria-label", "time in seconds");
    this.now_.addEventListener("focus", () => this.now_.select());
    this.now_.addEventListener("blur", () => this.update());
    this.now_.addEventListener("keydown", (e) => {
      if (e.key === "Escape") this.now_.blur();
      if (e.key !== "Enter") return;
      const time = Number(this.now_.value.replace(",", ".").replace("s", ""));
      this.now_.blur();
      if (!Number.isFinite(time)) return;
      player.pause();
      player.setTime(time);
    });
    this.clock_.append(this.now_, this.end_);
    for (const speed of SPEEDS) this.speed_.append(new Option(`${speed}×`, String(speed)));
    this.speed_.title = "Speed (- and +)";
    this.speed_.addEventListener("change", () => player.setSpeed(Number(this.speed_.value)));
    const track = make("div", "track", this.marks_, this.slider_);
    this.refresh();
    this.element.append(
      button("«", "Event before ([)", () => this.jump(-1)),
      button("‹", "One frame back (left)", () => player.step(-1)),
      this.play_,
      button("›", "One frame on (right)", () => player.step(1)),
      button("»", "Next event (])", () => this.jump(1)),
      this.speed_, track, this.clock_, this.row_,
    );
    player.onSlowChange(() => this.update());
    this.update();
  }

  /** Puts the marks where they belong now: a live run grows. */
  refresh(): void {
    const marks: HTMLElement[] = [];
    const length = Math.max(this.replay.end - this.replay.start, 1e-9);
    for (const event of this.replay.header.events) {
      if (!MARKED.has(event.kind)) continue;
      const mark = make("i", BAD.has(event.kind) ? "bad" : event.kind);
      mark.style.left = `${(100 * (event.time - this.replay.start)) / length}%`;
      mark.title = `${seconds(event.time)} ${event.body} ${event.kind}`;
      marks.push(mark);
    }
    this.marks_.replaceChildren(...marks);
  }

  askTime(): void {
    this.now_.focus();
  }

  /** To the nearest event before or after now. */
  jump(direction: -1 | 1): void {
    const times = this.replay.header.events.map((e) => e.time);
    const now = this.player.time;
    const there = direction > 0 ? times.filter((t) => t > now + 1e-3) : times.filter((t) => t < now - 1e-3);
    if (!there.length) return;
    this.player.pause();
    this.player.setTime(direction > 0 ? Math.min(...there) : Math.max(...there));
  }

  private update(): void {
    const { player, replay } = this;
    const length = Math.max(replay.end - replay.start, 1e-9);
    this.slider_.value = String(Math.round((STEPS_OF_SLIDER * (player.time - replay.start)) / length));
    if (document.activeElement !== this.now_) this.now_.value = player.time.toFixed(3);
    this.end_.textContent = ` / ${seconds(replay.end, 1)}`;
    this.play_.textContent = player.isPlaying ? "❚❚" : "▶";
    this.speed_.value = String(player.speed);
    const row = replay.channel("program_row")?.at(0, player.frame) ?? -1;
    this.row_.textContent = replay.header.program.names[row] ?? "";
    this.row_.title = row >= 0 ? `row ${row + 1} of the program` : "";
  }
}
