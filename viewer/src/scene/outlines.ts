// Outlines: wire boxes, rewritten each frame, in one draw call: the ghost of the commanded pose, a second recording.

import {
  BufferGeometry, DynamicDrawUsage, Float32BufferAttribute, GreaterDepth, Group, LessEqualDepth, LineBasicMaterial, LineDashedMaterial,
  LineSegments, Matrix4, Vector3,
} from "three";
import { CORNERS } from "./boxes";

export const EDGES: [number, number][] = [
  [0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7],
];

/** How much is seen of lines that are behind something. */
const HIDDEN = 0.25;

export class Outlines {
  /** The lines, and once more as ghosts where something is before them. */
  readonly lines = new Group();
  private readonly parts_: LineSegments<BufferGeometry, LineBasicMaterial | LineDashedMaterial>[];
  private position_: Float32BufferAttribute;
  private used_ = 0;
  private readonly corners_ = CORNERS.map(() => new Vector3());

  constructor(most: number, colour: string, isDashed: boolean, opacity: number) {
    this.position_ = new Float32BufferAttribute(new Float32Array(3 * 24 * Math.max(1, most)), 3);
    this.position_.setUsage(DynamicDrawUsage);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", this.position_);
    this.parts_ = [false, true].map((isHidden) => {
      const look = { color: colour, transparent: true, opacity: isHidden ? HIDDEN * opacity : opacity, depthWrite: false, depthFunc: isHidden ? GreaterDepth : LessEqualDepth };
      const material = isDashed ? new LineDashedMaterial({ ...look, dashSize: 0.012, gapSize: 0.008 }) : new LineBasicMaterial(look);
      const lines = new LineSegments(geometry, material);
      lines.frustumCulled = false;
      lines.renderOrder = 7;
      this.lines.add(lines);
      return lines;
    });
  }

  setColour(colour: string): void {
    for (const part of this.parts_) part.material.color.set(colour);
  }

  begin(): void {
    this.used_ = 0;
  }

  box(X_WB: Matrix4, half: Vector3): void {
    CORNERS.forEach((c, i) => this.corners_[i]!.set(c[0] * half.x, c[1] * half.y, c[2] * half.z).applyMatrix4(X_WB));
    for (const [a, b] of EDGES) {
      this.line(this.corners_[a]!, this.corners_[b]!);
    }
  }

  line(a: Vector3, b: Vector3): void {
    if (this.used_ + 2 > this.position_.count) return;
    this.position_.setXYZ(this.used_++, a.x, a.y, a.z);
    this.position_.setXYZ(this.used_++, b.x, b.y, b.z);
  }

  finish(): void {
    const [first] = this.parts_;
    first!.geometry.setDrawRange(0, this.used_);
    this.lines.visible = this.used_ > 0;
    this.position_.needsUpdate = true;
    if (first!.material instanceof LineDashedMaterial && this.used_ > 0) first!.computeLineDistances();
  }
}
