// Measure: the distance between two points that were clicked, drawn and in numbers.

import { BufferGeometry, Float32BufferAttribute, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, SphereGeometry, Vector3 } from "three";
import type { Label } from "./labels";
import type { Palette } from "./palette";

export class Measure {
  readonly group = new Group();
  private points_: Vector3[] = [];
  private readonly line_: LineSegments<BufferGeometry, LineBasicMaterial>;
  private readonly ends_: Mesh<SphereGeometry, MeshBasicMaterial>[];

  constructor(palette: Palette) {
    const look = { color: palette.select, depthTest: false, depthWrite: false, transparent: true, fog: false };
    this.line_ = new LineSegments(new BufferGeometry(), new LineBasicMaterial(look));
    this.line_.frustumCulled = false;
    this.ends_ = [0, 1].map(() => new Mesh(new SphereGeometry(1, 12, 8), new MeshBasicMaterial(look)));
    for (const part of [this.line_, ...this.ends_]) {
      part.renderOrder = 13;
      this.group.add(part);
    }
    this.update(() => 0.001);
  }

  setPalette(palette: Palette): void {
    for (const part of [this.line_, ...this.ends_]) part.material.color.set(palette.select);
  }

  /** A third point begins anew. */
  add(point: Vector3): void {
    if (this.points_.length >= 2) this.points_ = [];
    this.points_.push(point.clone());
  }

  clear(): void {
    this.points_ = [];
  }

  get points(): Vector3[] {
    return this.points_;
  }

  /** Distance and its parts along x, y, z of W; empty before there are two points. */
  text(): string {
    const [a, b] = this.points_;
    if (!a || !b) return "";
    const [x, y, z] = b.clone().sub(a).toArray().map((v) => (1000 * v).toFixed(1).replace(/^-(0\.0)$/, "$1"));
    return `${(1000 * a.distanceTo(b)).toFixed(1)} mm (x ${x}, y ${y}, z ${z})`;
  }

  labels(): Label[] {
    const [a, b] = this.points_;
    if (!a || !b) return [];
    return [{ id: "measure", text: `${(1000 * a.distanceTo(b)).toFixed(1)} mm`, at: a.clone().lerp(b, 0.5), kind: "box" }];
  }

  /** Ends keep their size on the screen. */
  update(pixel: (point: Vector3) => number): void {
    this.ends_.forEach((end, k) => {
      const point = this.points_[k];
      end.visible = point !== undefined;
      if (point) end.position.copy(point);
      if (point) end.scale.setScalar(4 * pixel(point));
    });
    this.line_.visible = this.points_.length === 2;
    if (!this.line_.visible) return;
    this.line_.geometry.setAttribute("position", new Float32BufferAttribute(this.points_.flatMap((p) => p.toArray()), 3));
  }
}
