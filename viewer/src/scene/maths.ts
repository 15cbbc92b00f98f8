// Poses of recordings as three.js objects.

import { Matrix4, Quaternion, Vector3 } from "three";
import type { PoseRow } from "../replay/header";

const p = new Vector3();
const q = new Quaternion();
const one = new Vector3(1, 1, 1);

/** Matrix of a pose (x, y, z, qw, qx, qy, qz). */
export function matrixOf(pose: ArrayLike<number>, out = new Matrix4()): Matrix4 {
  p.set(pose[0]!, pose[1]!, pose[2]!);
  q.set(pose[4]!, pose[5]!, pose[6]!, pose[3]!).normalize();
  return out.compose(p, q, one);
}

export function pointOf(pose: ArrayLike<number>, local: Vector3, out = new Vector3()): Vector3 {
  q.set(pose[4]!, pose[5]!, pose[6]!, pose[3]!);
  out.copy(local).applyQuaternion(q);
  out.x += pose[0]!;
  out.y += pose[1]!;
  out.z += pose[2]!;
  return out;
}

export const IDENTITY: PoseRow = [0, 0, 0, 1, 0, 0, 0];

/** Rotation vector (rad) of a unit quaternion w, x, y, z. */
export function rotationVector(w: number, x: number, y: number, z: number): [number, number, number] {
  const s = w < 0 ? -1 : 1;
  const sine = Math.hypot(x, y, z);
  if (sine < 1e-12) return [0, 0, 0];
  const k = (s * 2 * Math.atan2(sine, s * w)) / sine;
  return [k * x, k * y, k * z];
}
