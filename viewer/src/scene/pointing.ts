// Pointing: what a drawing shows under a point of its canvas.

import { Matrix4, Mesh, Raycaster, Vector2, Vector3, type Camera, type Intersection, type Object3D, type Plane } from "three";
import type { Boxes } from "./boxes";

/** A click so near to the corner of a box means that corner. */
const SNAP_PIXELS = 14;

export interface Picked {
  body: number;
  corner: number;
}

export interface Pointing {
  camera: Camera;
  width: number; // of the canvas, CSS pixels
  height: number;
  boxes: Boxes;
  surfaces: Object3D[];
  cuts: Plane[]; // what is behind them is not shown
  pixelSize: (point: Vector3) => number; // m
}

function hits(at: Pointing, objects: Object3D[], x: number, y: number): Intersection[] {
  const ray = new Raycaster();
  ray.setFromCamera(new Vector2((2 * x) / at.width - 1, 1 - (2 * y) / at.height), at.camera);
  at.boxes.mesh.boundingSphere = null;
  return ray.intersectObjects(objects);
}

function poseOf(at: Pointing, instance: number): Matrix4 {
  const X = new Matrix4();
  at.boxes.mesh.getMatrixAt(instance, X);
  return X;
}

export function pickBox(at: Pointing, x: number, y: number): Picked | null {
  const [hit] = hits(at, [at.boxes.mesh], x, y);
  if (!hit || hit.instanceId === undefined) return null;
  const body = at.boxes.bodies[hit.instanceId]!;
  const local = hit.point.clone().applyMatrix4(poseOf(at, hit.instanceId).invert());
  const corner = (local.x > 0 ? 1 : 0) + (local.y > 0 ? 2 : 0) + (local.z > 0 ? 4 : 0);
  return { body, corner };
}

export function findSurface(at: Pointing, x: number, y: number): Vector3 | null {
  const [hit] = hits(at, at.surfaces, x, y)
    .filter(({ object, point }) => object instanceof Mesh && at.cuts.every((plane) => plane.distanceToPoint(point) > -1e-3));
  if (!hit) return null;
  if (hit.object !== at.boxes.mesh || hit.instanceId === undefined) return hit.point;
  const X = poseOf(at, hit.instanceId);
  const local = hit.point.clone().applyMatrix4(X.clone().invert());
  const corner = new Vector3(Math.sign(local.x), Math.sign(local.y), Math.sign(local.z)).applyMatrix4(X);
  return corner.distanceTo(hit.point) < SNAP_PIXELS * at.pixelSize(corner) ? corner : hit.point;
}
