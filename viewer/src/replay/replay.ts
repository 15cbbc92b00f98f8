// Replay: a decoded recording that answers what was where at which frame.

import type { Column, Decoded } from "./decode";
import { ReplayError } from "./errors";
import type { Body, Header } from "./header";

/** One named group of columns. */
export class Channel {
  constructor(
    readonly name: string,
    readonly columnNames: string[],
    readonly unit: string,
    readonly frame: string,
    private columns_: Column[],
    private rows_: number,
  ) {}

  get rows(): number {
    return this.rows_;
  }

  /** Value, NaN when missing or out of range; between two rows that of the first. */
  at(column: number, row: number): number {
    return row >= 0 && row < this.rows_ ? this.columns_[column]![Math.floor(row)]! : NaN;
  }

  column(column: number): Column {
    const values = this.columns_[column]!;
    return values.length === this.rows_ ? values : values.subarray(0, this.rows_);
  }

  /** Adds rows, each value raised by `offset`: references of a later part of a run count from the part's own start. */
  append(columns: Column[], rows: number, offset = 0): void {
    const total = this.rows_ + rows;
    this.columns_ = this.columns_.map((old, c) => {
      let values = old;
      if (values.length < total) {
        values = new (old.constructor as new (length: number) => Column)(Math.max(total, 2 * old.length, 256));
        values.set(old.subarray(0, this.rows_));
      }
      const added = columns[c]!;
      for (let row = 0; row < rows; ++row) values[this.rows_ + row] = added[row]! + offset;
      return values;
    });
    this.rows_ = total;
  }
}

/** Farther apart than that in one frame a body did not move: it was put elsewhere, m. */
const JUMP = 0.3;

/** A pose (x, y, z, unit quaternion w, x, y, z) on its way to the next, part 0 to 1 of it; as it is where they are far apart. */
export function blendPose(pose: Float64Array | number[], next: ArrayLike<number>, part: number): void {
  if (Math.hypot(next[0]! - pose[0]!, next[1]! - pose[1]!, next[2]! - pose[2]!) > JUMP) return;
  for (let c = 0; c < 3; ++c) pose[c] = pose[c]! + part * (next[c]! - pose[c]!);
  let cosine = 0;
  for (let c = 3; c < 7; ++c) cosine += pose[c]! * next[c]!;
  const sign = cosine < 0 ? -1 : 1;
  const angle = Math.acos(Math.min(1, sign * cosine));
  const sine = Math.sin(angle);
  const [a, b] = sine < 1e-6 ? [1 - part, part] : [Math.sin((1 - part) * angle) / sine, Math.sin(part * angle) / sine];
  for (let c = 3; c < 7; ++c) pose[c] = a * pose[c]! + sign * b * next[c]!;
  const norm = Math.hypot(pose[3]!, pose[4]!, pose[5]!, pose[6]!);
  for (let c = 3; c < 7; ++c) pose[c] = pose[c]! / norm;
}

export interface ContactTables {
  frameFirst: Channel;
  frameCount: Channel;
  frameBlock: Channel;
  blockBody: Channel;
  blockFirst: Channel;
  blockCount: Channel;
  point: Channel;
  normal: Channel;
  force: Channel;
  gap: Channel | undefined;
  state: Channel | undefined;
}

export class Replay {
  readonly header: Header;
  readonly size: number;
  readonly warnings: string[] = [];
  private readonly channels_ = new Map<string, Channel>();
  private readonly bodyByName_ = new Map<string, number>();
  private readonly bodyPose_: (Channel | undefined)[];
  private readonly bodyPresent_: (Channel | undefined)[];
  private contacts_: ContactTables | null = null;
  private readonly next_ = new Float64Array(7);

  constructor(decoded: Decoded) {
    this.header = decoded.header;
    this.size = decoded.size;
    for (const [name, c] of decoded.channels) {
      this.channels_.set(name, new Channel(name, c.meta.columns, c.meta.unit, c.meta.frame, c.columns, c.meta.rows));
    }
    const time = this.channels_.get("time");
    if (!time) throw new ReplayError("This recording is broken", 'it has no channel "time".');
    this.header.bodies.forEach((body, k) => this.bodyByName_.set(body.name, k));
    this.bodyPose_ = this.header.bodies.map((_, k) => this.channels_.get(`body.${k}.pose`));
    this.bodyPresent_ = this.header.bodies.map((_, k) => this.channels_.get(`body.${k}.present`));
    this.contacts_ = this.findContacts();
    if (this.header.interrupted) {
      this.warnings.push("A viewer ended the run early.");
    } else if (!this.header.complete) {
      this.warnings.push("The run did not finish: it was killed, failed, or was still running.");
    }
  }

  private findContacts(): ContactTables | null {
    const get = (name: string): Channel | undefined => this.channels_.get(`contacts.${name}`);
    const needed = ["frame_first", "frame_count", "frame_block", "block_body", "block_first", "block_count", "point"];
    if (needed.some((name) => !get(name)) || !get("normal") || !get("force")) return null;
    return {
      frameFirst: get("frame_first")!, frameCount: get("frame_count")!, frameBlock: get("frame_block")!,
      blockBody: get("block_body")!, blockFirst: get("block_first")!, blockCount: get("block_count")!,
      point: get("point")!, normal: get("normal")!, force: get("force")!, gap: get("gap"), state: get("state"),
    };
  }

  /** Adds the frames and events of a later part of the same run. */
  append(part: Decoded): void {
    const rows = (name: string): number => this.channels_.get(name)?.rows ?? 0;
    const offsets = new Map([
      ["contacts.frame_first", rows("contacts.frame_block")],
      ["contacts.frame_block", rows("contacts.block_body")],
      ["contacts.block_first", rows("contacts.point")],
    ]);
    for (const [name, { meta, columns }] of part.channels) {
      const channel = this.channels_.get(name);
      if (!channel || columns.length !== channel.columnNames.length) {
        throw new ReplayError("The live run is broken", `it has no channel "${name}" of that kind at its beginning.`);
      }
      const body = /^body\.(\d+)\.pose$/.exec(name)?.[1];
      const isStatic = body !== undefined && this.header.bodies[Number(body)]?.kind === "static";
      if (!isStatic) channel.append(columns, meta.rows, offsets.get(name) ?? 0);
    }
    this.header.events.push(...part.header.events);
  }

  get frames(): number {
    return this.channels_.get("time")!.rows;
  }

  get bodies(): Body[] {
    return this.header.bodies;
  }

  get contacts(): ContactTables | null {
    return this.contacts_;
  }

  /** Whether something carried boxes: a scene of bodies alone has channels of a tool that never moves. */
  get hasTool(): boolean {
    return this.header.tool !== null || this.header.cup !== null;
  }

  channel(name: string): Channel | undefined {
    if (!this.hasTool && /^(tool|cup|flange)\./.test(name)) return undefined;
    const channel = this.channels_.get(name);
    return channel && channel.rows > 0 ? channel : undefined;
  }

  bodyIndex(name: string): number {
    return this.bodyByName_.get(name) ?? -1;
  }

  timeOf(frame: number): number {
    return this.channels_.get("time")!.at(0, Math.max(0, Math.min(frame, this.frames - 1)));
  }

  get start(): number {
    return this.frames ? this.timeOf(0) : 0;
  }

  get end(): number {
    return this.frames ? this.timeOf(this.frames - 1) : 0;
  }

  /** Last frame at or before `time` (s); 0 before the first. Half a microsecond is forgiven: times are rounded. */
  frameAt(time: number): number {
    const times = this.channels_.get("time")!.column(0);
    let low = 0;
    let high = times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle]! <= time + 1e-6) low = middle;
      else high = middle - 1;
    }
    return Math.max(0, low);
  }

  /** As frameAt, with the part of the way to the next frame: a time between two frames. */
  frameBetween(time: number): number {
    const frame = this.frameAt(time);
    const from = this.timeOf(frame);
    const step = this.timeOf(frame + 1) - from;
    return step > 0 ? frame + Math.min(1 - 1e-9, Math.max(0, (time - from) / step)) : frame;
  }

  /**
   * Reads a pose with normalised quaternion; false when it is missing. Channels of one row hold for all frames. Between two
   * frames (1.25 is a quarter of the way from 1 to 2) positions are linear and turns go at a constant rate the shorter way,
   * unless a pose is missing or jumps: then it is that of the frame before.
   */
  pose(channel: Channel | undefined, frame: number, out: Float64Array | number[]): boolean {
    if (!channel || channel.rows === 0) return false;
    const row = channel.rows === 1 ? 0 : Math.floor(frame);
    if (!this.poseOfRow(channel, row, out)) return false;
    const part = channel.rows === 1 ? 0 : frame - row;
    if (part > 0 && row + 1 < channel.rows && this.poseOfRow(channel, row + 1, this.next_)) blendPose(out, this.next_, part);
    return true;
  }

  private poseOfRow(channel: Channel, row: number, out: Float64Array | number[]): boolean {
    for (let c = 0; c < 7; ++c) out[c] = channel.at(c, row);
    const norm = Math.hypot(out[3]!, out[4]!, out[5]!, out[6]!);
    if (!(norm > 0.1) || !Number.isFinite(out[0]! + out[1]! + out[2]!)) return false;
    for (let c = 3; c < 7; ++c) out[c] = out[c]! / norm;
    return true;
  }

  /** X_WB of a body; false while it is not in the cell. */
  bodyPose(body: number, frame: number, out: Float64Array | number[]): boolean {
    const present = this.bodyPresent_[body];
    if (present && present.rows > 1 && present.at(0, frame) !== 1) return false;
    return this.pose(this.bodyPose_[body], frame, out);
  }

  poseChannelOfBody(body: number): Channel | undefined {
    return this.bodyPose_[body];
  }

  attachedBody(frame: number): number {
    const value = this.channels_.get("cup.attached_body")?.at(0, frame) ?? -1;
    return Number.isFinite(value) ? value : -1;
  }

  /** Calls `visit(point row, body a, body b)` for every contact of the frame. */
  forEachContact(frame: number, visit: (point: number, a: number, b: number) => void): void {
    const c = this.contacts_;
    if (!c) return;
    const first = c.frameFirst.at(0, frame);
    const count = c.frameCount.at(0, frame);
    for (let f = first; f < first + count; ++f) this.forEachPoint(c.frameBlock.at(0, f), visit);
  }

  /** The same for the contacts of one block: one pair of bodies. */
  forEachPoint(block: number, visit: (point: number, a: number, b: number) => void): void {
    const c = this.contacts_;
    if (!c) return;
    const a = c.blockBody.at(0, block);
    const b = c.blockBody.at(1, block);
    const begin = c.blockFirst.at(0, block);
    const end = Math.min(begin + c.blockCount.at(0, block), c.point.rows);
    for (let p = begin; p < end; ++p) visit(p, a, b);
  }
}
