// Player: the time cursor; every part of the page listens to it.

import type { Replay } from "../replay/replay";

export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20];

export class Player {
  time: number;
  frame = 0;
  isPlaying = false;
  speed = 1;
  private readonly listeners_: (() => void)[] = [];
  private readonly slowListeners_: (() => void)[] = [];
  private last_ = 0;
  private lastSlow_ = 0;

  constructor(readonly replay: Replay) {
    this.time = replay.start;
  }

  /** Called after each change of time, frame, speed or playing. */
  onChange(listener: () => void): void {
    this.listeners_.push(listener);
  }

  /** The same, but while playing at most ten times a second: for what is read, not watched. */
  onSlowChange(listener: () => void): void {
    this.slowListeners_.push(listener);
  }

  private changed(): void {
    for (const listener of this.listeners_) listener();
    const now = performance.now();
    if (this.isPlaying && now - this.lastSlow_ < 100) return;
    this.lastSlow_ = now;
    for (const listener of this.slowListeners_) listener();
  }

  setTime(time: number): void {
    const clamped = Math.min(Math.max(time, this.replay.start), this.replay.end);
    this.time = Number.isFinite(clamped) ? clamped : this.replay.start;
    this.frame = this.replay.frameAt(this.time);
    this.changed();
  }

  setFrame(frame: number): void {
    this.setTime(this.replay.timeOf(Math.min(Math.max(frame, 0), this.replay.frames - 1)));
  }

  step(frames: number): void {
    this.pause();
    this.setFrame(this.frame + frames);
  }

  setSpeed(speed: number): void {
    this.speed = speed;
    this.changed();
  }

  faster(by: number): void {
    const at = SPEEDS.indexOf(this.speed);
    this.setSpeed(SPEEDS[Math.min(Math.max(at + by, 0), SPEEDS.length - 1)]!);
  }

  toggle(): void {
    if (this.isPlaying) this.pause();
    else this.play();
  }

  play(): void {
    if (this.isPlaying) return;
    if (this.time >= this.replay.end) this.setTime(this.replay.start);
    this.isPlaying = true;
    this.last_ = performance.now();
    const tick = (now: number): void => {
      if (!this.isPlaying) return;
      this.setTime(this.time + (Math.min(now - this.last_, 250) / 1000) * this.speed);
      this.last_ = now;
      if (this.time >= this.replay.end) this.pause();
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
    this.changed();
  }

  pause(): void {
    if (!this.isPlaying) return;
    this.isPlaying = false;
    this.changed();
  }
}
