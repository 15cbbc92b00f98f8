// Labels: short texts that stay at points of the scene, as HTML above the drawing (crisp at any size).

import { Vector3, type Camera, type Plane } from "three";

export interface Label {
  id: string;
  text: string;
  at: Vector3;
  kind: "frame" | "box" | "held" | "second";
}

export class Labels {
  readonly host = document.createElement("div");
  private readonly live_ = new Map<string, HTMLSpanElement>();
  private readonly v_ = new Vector3();

  constructor() {
    this.host.className = "labels";
  }

  /** Labels of what the planes cut away are not shown. */
  update(labels: Label[], camera: Camera, width: number, height: number, cuts: Plane[] = []): void {
    const seen = new Set<string>();
    for (const label of labels) {
      if (cuts.some((plane) => plane.distanceToPoint(label.at) < 0)) continue;
      this.v_.copy(label.at).project(camera);
      if (this.v_.z > 1 || Math.abs(this.v_.x) > 1.1 || Math.abs(this.v_.y) > 1.1) continue;
      seen.add(label.id);
      let span = this.live_.get(label.id);
      if (!span) {
        span = document.createElement("span");
        this.live_.set(label.id, span);
        this.host.append(span);
      }
      if (span.textContent !== label.text) span.textContent = label.text;
      const className = `label ${label.kind}`;
      if (span.className !== className) span.className = className;
      const x = ((this.v_.x + 1) / 2) * width;
      const y = ((1 - this.v_.y) / 2) * height;
      span.style.transform = `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)`;
    }
    for (const [id, span] of this.live_) {
      if (seen.has(id)) continue;
      span.remove();
      this.live_.delete(id);
    }
  }
}
