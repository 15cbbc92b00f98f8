// Trace: the way of a chosen point (the tool, the cup or a corner of a box) through the whole run; the past is solid.

import { BufferGeometry, Float32BufferAttribute, Line, LineBasicMaterial, Group, Vector3 } from "three";
import type { Replay } from "../replay/replay";
import { pointOf } from "./maths";

export type TracePoint = { kind: "tool" } | { kind: "body"; body: number; local: Vector3; label: string };

export class Trace {
  readonly group = new Group();
  private readonly past_: Line<BufferGeometry, LineBasicMaterial>;
  private readonly future_: Line<BufferGeometry, LineBasicMaterial>;
  /** Frame of each vertex, ascending. */
  private frames_: number[] = [];

  constructor(colour: string) {
    const geometry = new BufferGeometry();
    this.past_ = new Line(geometry, new LineBasicMaterial({ color: colour }));
    this.future_ = new Line(geometry.clone(), new LineBasicMaterial({ color: colour, transparent: true, opacity: 0.22 }));
    for (const line of [this.past_, this.future_]) {
      line.frustumCulled = false;
      this.group.add(line);
    }
  }

  setColour(colour: string): void {
    this.past_.material.color.set(colour);
    this.future_.material.color.set(colour);
  }

  /** Collects the way of the point; points closer than half a millimetre to the last are left out. */
  build(replay: Replay, point: TracePoint | null): void {
    const xyz: number[] = [];
    this.frames_ = [];
    if (point) {
      const channel = point.kind === "tool" ? replay.channel("tool.pose") : replay.poseChannelOfBody(point.body);
      const pose = new Float64Array(7);
      const at = new Vector3();
      const last = new Vector3(NaN, NaN, NaN);
      const local = point.kind === "tool" ? new Vector3() : point.local;
      for (let frame = 0; frame < replay.frames; ++frame) {
        if (!replay.pose(channel, frame, pose)) continue;
        pointOf(pose, local, at);
        if (at.distanceToSquared(last) < 2.5e-7) continue;
        last.copy(at);
        xyz.push(at.x, at.y, at.z);
        this.frames_.push(frame);
      }
    }
    for (const line of [this.past_, this.future_]) {
      line.geometry.dispose();
      line.geometry = new BufferGeometry();
    }
    const attribute = new Float32BufferAttribute(xyz, 3);
    this.past_.geometry.setAttribute("position", attribute);
    this.future_.geometry.setAttribute("position", attribute);
  }

  update(frame: number): void {
    let low = 0;
    let high = this.frames_.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.frames_[middle]! <= frame) low = middle + 1;
      else high = middle;
    }
    this.past_.geometry.setDrawRange(0, low);
    this.future_.geometry.setDrawRange(Math.max(0, low - 1), Infinity);
    this.past_.visible = low > 1;
    this.future_.visible = this.frames_.length - low > 0 && this.frames_.length > 1;
  }
}
