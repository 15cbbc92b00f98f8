// Second: the boxes and the tool of another recording at the same time, as wire boxes over the first.

import { Vector3 } from "three";
import type { Replay } from "../replay/replay";
import { matrixOf } from "./maths";
import { Outlines } from "./outlines";
import type { Palette } from "./palette";

/** Where the rod of the tool begins, m along z of E. */
const ROD_START = -0.27;

export class Second {
  readonly outlines: Outlines;
  private readonly pose_ = new Float64Array(7);

  constructor(
    private readonly replay: Replay | null,
    palette: Palette,
  ) {
    this.outlines = new Outlines(replay ? replay.bodies.length + 1 : 1, palette.second, false, 0.75);
  }

  update(time: number, isOn: boolean): void {
    this.outlines.begin();
    const { replay } = this;
    if (replay && isOn) {
      const frame = replay.frameAt(time);
      replay.bodies.forEach((body, k) => {
        const shape = body.shapes[0];
        if (body.kind !== "dynamic" || body.shapes.length !== 1 || shape?.kind !== "box") return;
        if (!replay.bodyPose(k, frame, this.pose_)) return;
        this.outlines.box(matrixOf(this.pose_).multiply(matrixOf(shape.pose)), new Vector3(...shape.half));
      });
      if (replay.pose(replay.channel("tool.pose"), frame, this.pose_)) {
        const X_WE = matrixOf(this.pose_);
        this.outlines.line(new Vector3().applyMatrix4(X_WE), new Vector3(0, 0, ROD_START).applyMatrix4(X_WE));
      }
    }
    this.outlines.finish();
  }
}
