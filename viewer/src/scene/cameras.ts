// Cameras: the views of the scene (cell, top, side, tool, free) and how they are framed.

import { Box3, OrthographicCamera, PerspectiveCamera, Vector3, type Matrix4 } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Shape } from "../replay/header";
import type { Replay } from "../replay/replay";
import { matrixOf } from "./maths";
import { chooseDirection, extentOf } from "./viewpoint";

export type CameraName = "cell" | "top" | "side" | "tool";
export const CAMERA_NAMES: CameraName[] = ["cell", "top", "side", "tool"];

/** A body that is farther from where things were at first than so many times their extent has left the scene. */
const GONE = 2;

/** Adds the corners of the boxes around the shapes of a body. */
function addBody(box: Box3, shapes: Shape[], X_WB: Matrix4): void {
  const around = new Box3();
  for (const shape of shapes) {
    const { half, centre } = extentOf(shape);
    around.set(centre.clone().sub(half), centre.clone().add(half)).applyMatrix4(X_WB.clone().multiply(matrixOf(shape.pose)));
    box.union(around);
  }
}

/** Fixed bodies of a scene without container that are not much wider than what moves: not a floor, which is as wide as one likes. */
function addFixed(box: Box3, replay: Replay): void {
  const pose = new Float64Array(7);
  const around = new Box3();
  const moving = box.getSize(new Vector3());
  const widest = box.isEmpty() ? Infinity : 3 * Math.max(moving.x, moving.y, moving.z);
  replay.bodies.forEach((body, k) => {
    if (body.kind !== "static" || !replay.bodyPose(k, 0, pose)) return;
    addBody(around.makeEmpty(), body.shapes, matrixOf(pose));
    const size = around.getSize(new Vector3());
    if (Math.max(size.x, size.y) < widest) box.union(around);
  });
}

/** Where things happen: all that moves during the run with its whole extent, and the container or, without one, what stands there. */
export function interestBox(replay: Replay): Box3 {
  const box = new Box3();
  const pose = new Float64Array(7);
  const container = containerBox(replay);
  if (container) box.union(container);
  const movers = replay.bodies.map((body, k) => ({ body, k })).filter(({ body }) => body.kind !== "static");
  const firsts = new Map<number, number>();
  for (const { body, k } of movers) {
    const present = replay.channel(`body.${k}.present`);
    let frame = 0;
    while (present && present.rows > 1 && frame < replay.frames - 1 && present.at(0, frame) !== 1) ++frame;
    firsts.set(k, frame);
    if (replay.bodyPose(k, frame, pose)) addBody(box, body.shapes, matrixOf(pose));
  }
  if (!container) addFixed(box, replay);
  if (box.isEmpty()) box.set(new Vector3(-0.5, -0.5, 0), new Vector3(0.5, 0.5, 0.5));
  const reach = box.clone().expandByScalar(GONE * Math.max(0.5, box.getSize(new Vector3()).length() / 2));
  const step = Math.max(1, Math.floor(replay.frames / 200));
  const at = new Vector3();
  for (const { body, k } of movers) {
    for (let frame = firsts.get(k)!; frame < replay.frames; frame += step) {
      if (!replay.bodyPose(k, frame, pose) || !reach.containsPoint(at.set(pose[0]!, pose[1]!, pose[2]!))) continue;
      if (at.z > (container?.min.z ?? -Infinity) - 0.6) addBody(box, body.shapes, matrixOf(pose));
    }
  }
  const size = box.getSize(new Vector3());
  return box.expandByScalar((container ? 0.03 : 0.15) * Math.max(size.x, size.y, size.z));
}

/** Axis-aligned box of the inner container in W. */
export function containerBox(replay: Replay): Box3 | null {
  const c = replay.header.container;
  if (!c) return null;
  const X = matrixOf(c.pose[0]).multiply(matrixOf(c.pose[1]));
  const [x, y, z] = c.inner_size;
  return new Box3(new Vector3(-x / 2, -y / 2, 0), new Vector3(x / 2, y / 2, z)).applyMatrix4(X);
}

/** Orthographic camera that shows a box from above, or from the side on which it is longest. */
export function orthoCamera(box: Box3, from: "top" | "side", aspect: number, margin = 1.12): OrthographicCamera {
  const size = box.getSize(new Vector3());
  const centre = box.getCenter(new Vector3());
  const camera = new OrthographicCamera(-1, 1, 1, -1, 0.01, 20);
  const longX = size.x > size.y;
  if (from === "top") {
    // The longer side lies across the picture, as in Figure 20.
    camera.up.set(longX ? 0 : -1, longX ? 1 : 0, 0);
    camera.position.set(centre.x, centre.y, box.max.z + 2);
  } else {
    camera.up.set(0, 0, 1);
    camera.position.set(centre.x + (longX ? 0 : 3), centre.y - (longX ? 3 : 0), centre.z);
  }
  camera.lookAt(from === "top" ? new Vector3(centre.x, centre.y, box.min.z) : centre);
  const width = Math.max(size.x, size.y) * margin;
  const height = (from === "top" ? Math.min(size.x, size.y) : size.z) * margin;
  const half = Math.max(width / aspect, height) / 2;
  camera.top = half;
  camera.bottom = -half;
  camera.left = -half * aspect;
  camera.right = half * aspect;
  camera.updateProjectionMatrix();
  return camera;
}

export class Cameras {
  name: CameraName = "cell";
  active: PerspectiveCamera | OrthographicCamera;
  readonly controls: OrbitControls;
  private readonly perspective_ = new PerspectiveCamera(32, 1, 0.02, 30);
  private aspect_ = 1;
  private readonly follow_ = new Vector3();
  private away_: Vector3 | null = null;
  private framed_ = 0;

  constructor(
    private readonly replay: Replay,
    element: HTMLElement,
    onChange: () => void,
  ) {
    this.perspective_.up.set(0, 0, 1);
    this.active = this.perspective_;
    this.controls = new OrbitControls(this.active, element);
    this.controls.addEventListener("change", onChange);
    this.controls.screenSpacePanning = true;
    this.controls.maxDistance = 20;
  }

  setAspect(aspect: number): void {
    this.aspect_ = aspect;
    if (this.active instanceof OrthographicCamera) {
      const half = this.active.top;
      this.active.left = -half * aspect;
      this.active.right = half * aspect;
    }
    this.perspective_.aspect = aspect;
    this.perspective_.updateProjectionMatrix();
    this.active.updateProjectionMatrix();
  }

  use(name: CameraName, tool: Vector3 | null): void {
    this.name = name;
    if (name === "top" || name === "side") {
      const box = (containerBox(this.replay) ?? interestBox(this.replay)).clone();
      this.active = orthoCamera(box, name, this.aspect_, 1.3);
      this.controls.object = this.active;
      this.controls.target.copy(box.getCenter(new Vector3()));
      this.active.up.set(0, 0, 1);
      if (name === "top") this.tiltForOrbit(box);
    } else {
      this.active = this.perspective_;
      this.controls.object = this.active;
      if (name === "tool" && tool) this.frameTool(tool);
      else this.frameCell();
    }
    this.controls.update();
  }

  /** Orbit controls need a view that is not exactly along their up axis: a hair of tilt gives the azimuth. */
  private tiltForOrbit(box: Box3): void {
    const size = box.getSize(new Vector3());
    const centre = this.controls.target;
    this.active.position.set(centre.x, centre.y, box.max.z + 2);
    if (size.x > size.y) this.active.position.y -= 1e-4;
    else this.active.position.x += 1e-4;
  }

  /** All that happens in the middle of the view, as near as its corners allow. */
  private frameCell(): void {
    const { min, max } = interestBox(this.replay);
    const reach = max.distanceTo(min);
    this.perspective_.near = Math.min(0.02, reach / 50);
    this.perspective_.far = Math.max(30, 12 * reach);
    this.controls.maxDistance = Math.max(20, 6 * reach);
    const corners = [min.x, max.x].flatMap((x) => [min.y, max.y].flatMap((y) => [min.z, max.z].map((z) => new Vector3(x, y, z))));
    const away = this.direction().clone();
    const right = new Vector3(0, 0, 1).cross(away).normalize();
    const up = away.clone().cross(right);
    const slopeUp = Math.tan((this.perspective_.fov * Math.PI) / 360);
    const slopeRight = slopeUp * this.aspect_;
    const centre = min.clone().add(max).multiplyScalar(0.5);
    let distance = 0.1;
    for (let round = 0; round < 4; ++round) {
      const at = corners.map((corner) => corner.clone().sub(centre));
      distance = Math.max(0.1, ...at.map((d) => d.dot(away) + Math.max(Math.abs(d.dot(right)) / slopeRight, Math.abs(d.dot(up)) / slopeUp)));
      // What is near looks larger: the middle of the picture is not the middle of the box.
      for (const axis of [right, up]) {
        const seen = at.map((d) => d.dot(axis) / (distance - d.dot(away)));
        centre.addScaledVector(axis, (distance * (Math.max(...seen) + Math.min(...seen))) / 2);
      }
    }
    this.controls.target.copy(centre);
    this.active.position.copy(centre).addScaledVector(away, distance);
    this.active.updateProjectionMatrix();
  }

  /** From where the cell is seen: chosen once, and again when a live run has brought more. */
  private direction(): Vector3 {
    if (!this.away_ || this.replay.frames > 2 * this.framed_) {
      this.away_ = chooseDirection(this.replay);
      this.framed_ = this.replay.frames;
    }
    return this.away_;
  }

  private frameTool(tool: Vector3): void {
    this.follow_.copy(tool);
    this.controls.target.copy(tool);
    this.active.position.copy(tool).add(new Vector3(0.3, -0.85, 0.32));
  }

  /** Moves with the tool when that view is chosen. */
  follow(tool: Vector3): void {
    if (this.name !== "tool") return;
    const moved = tool.clone().sub(this.follow_);
    this.follow_.copy(tool);
    this.controls.target.add(moved);
    this.active.position.add(moved);
    this.active.updateMatrixWorld();
  }
}
