// Marks: which frames are drawn as axes and what is written beside frames and boxes.

import { Matrix4, Vector3 } from "three";
import type { Replay } from "../replay/replay";
import type { Boxes } from "./boxes";
import type { Label } from "./labels";
import { matrixOf } from "./maths";
import type { ViewOptions } from "./options";
import type { Triad } from "./triads";

/** Where things are at the frame that is drawn. */
export interface Scene {
  frame: number;
  /** X_WE and X_WS, null when there is no tool, no cup. */
  X_WE: Matrix4 | null;
  X_WS: Matrix4 | null;
  selected: number;
  /** The selected box or the held one; -1 for none. */
  marked: number;
}

const pose = new Float64Array(7);

/** Fixed frames of the scenario, E and S of the tool, P of the marked box. */
export function triadsOf(replay: Replay, at: Scene): Triad[] {
  const triads: Triad[] = replay.header.frames_named.map((f) => ({ letter: f.letter || f.name, X_W: matrixOf(f.X_W), size: 0.12 }));
  if (at.X_WE) triads.push({ letter: "E", X_W: at.X_WE, size: 0.075 });
  if (at.X_WS) triads.push({ letter: "S", X_W: at.X_WS, size: 0.06 });
  if (at.marked >= 0 && replay.bodyPose(at.marked, at.frame, pose)) triads.push({ letter: "P", X_W: matrixOf(pose), size: 0.09 });
  return triads;
}

export function labelsOf(replay: Replay, boxes: Boxes, at: Scene, triads: Triad[], options: ViewOptions): Label[] {
  const labels: Label[] = triads.map((triad, i) => ({
    id: `frame ${i}`, text: triad.letter, kind: "frame",
    at: new Vector3(-0.12, -0.12, -0.12).multiplyScalar(triad.size).applyMatrix4(triad.X_W),
  }));
  if (!options.names) return labels;
  const held = replay.attachedBody(at.frame);
  for (const body of new Set([held, at.selected])) {
    if (body < 0 || !replay.bodyPose(body, at.frame, pose)) continue;
    const above = pose[2]! + (boxes.halfOf(body)?.length() ?? 0.06) * 0.85;
    labels.push({ id: `body ${body}`, text: replay.bodies[body]!.name, at: new Vector3(pose[0], pose[1], above), kind: body === held ? "held" : "box" });
  }
  return labels;
}
