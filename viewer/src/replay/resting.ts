// Resting: contacts of boxes that sleep, for recordings of older versions, which hold those of boxes that are awake; a pair that has
// not moved since its last recorded contact still has it.

import type { Replay } from "./replay";

/** A pose channel is rounded to 1e-5 m: two values of what did not move differ by one step of it at most. */
const SAME = 1.5e-5;

interface Run {
  first: number;
  last: number;
  block: number;
}

export class RestingContacts {
  private readonly runs_ = new Map<number, Run[]>();
  private indexed_ = 0;
  private frame_ = -1;
  private blocks_: number[] = [];
  private readonly then_ = new Float64Array(7);
  private readonly now_ = new Float64Array(7);

  constructor(private readonly replay: Replay) {}

  /** Collects from when to when each pair touched; frames that a live run has added since are added. */
  private index(): void {
    const { replay } = this;
    const tables = replay.contacts;
    if (!tables) return;
    const bodies = replay.bodies.length;
    for (; this.indexed_ < replay.frames; ++this.indexed_) {
      const frame = this.indexed_;
      const first = tables.frameFirst.at(0, frame);
      const end = first + tables.frameCount.at(0, frame);
      for (let f = first; f < end; ++f) {
        const block = tables.frameBlock.at(0, f);
        const key = tables.blockBody.at(0, block) * bodies + tables.blockBody.at(1, block);
        if (!Number.isFinite(key)) continue;
        let runs = this.runs_.get(key);
        if (!runs) this.runs_.set(key, (runs = []));
        const run = runs[runs.length - 1];
        if (run && run.last === frame - 1) {
          run.last = frame;
          run.block = block;
        } else {
          runs.push({ first: frame, last: frame, block });
        }
      }
    }
  }

  private isUnmoved(body: number, then: number, now: number): boolean {
    const { replay } = this;
    if (replay.bodies[body]?.kind === "static") return true;
    if (!replay.bodyPose(body, then, this.then_) || !replay.bodyPose(body, now, this.now_)) return false;
    const sign = this.then_[3]! * this.now_[3]! + this.then_[4]! * this.now_[4]! + this.then_[5]! * this.now_[5]! + this.then_[6]! * this.now_[6]! < 0 ? -1 : 1;
    for (let c = 0; c < 7; ++c) if (!(Math.abs(this.then_[c]! - (c < 3 ? 1 : sign) * this.now_[c]!) < SAME)) return false;
    return true;
  }

  /** Bodies that have recorded contacts at the frame, or hang on the cup: those are awake. */
  private awake(frame: number): Set<number> {
    const awake = new Set<number>([this.replay.attachedBody(frame)]);
    this.replay.forEachContact(frame, (_, a, b) => awake.add(a).add(b));
    return awake;
  }

  private collect(frame: number): void {
    this.index();
    this.frame_ = frame;
    this.blocks_ = [];
    const { bodies } = this.replay;
    const awake = this.awake(frame);
    const sleeps = (body: number): boolean => bodies[body]?.kind !== "dynamic" || !awake.has(body);
    for (const [key, runs] of this.runs_) {
      const run = lastRunFrom(runs, frame);
      if (!run || run.last >= frame) continue;
      const [a, b] = [Math.floor(key / bodies.length), key % bodies.length];
      if (sleeps(a) && sleeps(b) && this.isUnmoved(a, run.last, frame) && this.isUnmoved(b, run.last, frame)) this.blocks_.push(run.block);
    }
  }

  /** Calls `visit(point row, body a, body b)` for every contact that is not recorded at the frame but still there. */
  forEach(frame: number, visit: (point: number, a: number, b: number) => void): void {
    const tables = this.replay.contacts;
    if (!tables) return;
    if (frame !== this.frame_) this.collect(frame);
    for (const block of this.blocks_) this.replay.forEachPoint(block, visit);
  }
}

/** The last run that begins at or before a frame. */
function lastRunFrom(runs: Run[], frame: number): Run | null {
  let low = -1;
  let high = runs.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (runs[middle]!.first <= frame) low = middle;
    else high = middle - 1;
  }
  return low < 0 ? null : runs[low]!;
}
