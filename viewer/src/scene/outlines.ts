// Outlines: wire boxes, rewritten each frame, in one draw call: the ghost of the commanded pose, a second recording.

import { BufferGeometry, DynamicDrawUsage, Float32BufferAttribute, LineBasicMaterial, LineDashedMaterial, LineSegments, Matrix4, Vector3 } from "three";
import { CORNERS } from "./boxes";

const EDGES: [number, number][] = [
  [0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7],
];

export class Outlines {
  readonly lines: LineSegments<BufferGeometry, LineBasicMaterial | LineDashedMaterial>;
  private position_: Float32BufferAttribute;
  private used_ = 0;
  private readonly corners_ = CORNERS.map(() => new Vector3());

  constructor(most: number, colour: string, isDashed: boolean, opacity: number) {
    this.position_ = new Float32BufferAttribute(new Float32Array(3 * 24 * Math.max(1, most)), 3);
    this.position_.setUsage(DynamicDrawUsage);
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", this.position_);
    const material = isDashed
      ? new LineDashedMaterial({ color: colour, dashSize: 0.012, gapSize: 0.008, transparent: true, opacity, depthTest: false })
      : new LineBasicMaterial({ color: colour, transparent: true, opacity, depthTest: false });
    this.lines = new LineSegments(geometry, material);
    this.lines.frustumCulled = false;
    this.lines.renderOrder = 7;
  }

  setColour(colour: string): void {
    this.lines.material.color.set(colour);
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
    this.lines.geometry.setDrawRange(0, this.used_);
    this.lines.visible = this.used_ > 0;
    this.position_.needsUpdate = true;
    if (this.lines.material instanceof LineDashedMaterial && this.used_ > 0) this.lines.computeLineDistances();
  }
}
