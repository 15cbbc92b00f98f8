// Cameras: the views of the scene (cell, top, side, tool, free) and how they are framed.

import { Box3, OrthographicCamera, PerspectiveCamera, Vector3 } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import type { Replay } from "../replay/replay";
import { matrixOf } from "./maths";

export type CameraName = "cell" | "top" | "side" | "tool";
export const CAMERA_NAMES: CameraName[] = ["cell", "top", "side", "tool"];

/** Where things happen: all that moves during the run, and the container. */
export function interestBox(replay: Replay): Box3 {
  const box = new Box3();
  const pose = new Float64Array(7);
  const step = Math.max(1, Math.floor(replay.frames / 400));
  const at = new Vector3();
  const container = containerBox(replay);
  if (container) box.union(container);
  replay.bodies.forEach((body, k) => {
    if (body.kind === "static") return;
    for (let frame = 0; frame < replay.frames; frame += step) {
      if (!replay.bodyPose(k, frame, pose)) continue;
      at.set(pose[0]!, pose[1]!, pose[2]!);
      if (at.length() < 3 && at.z > -0.6) box.expandByPoint(at);
    }
  });
  if (box.isEmpty()) box.set(new Vector3(-0.5, -0.5, 0), new Vector3(0.5, 0.5, 0.5));
  const size = box.getSize(new Vector3());
  box.expandByScalar(Math.max(0.05, 0.05 * Math.max(size.x, size.y, size.z)));
  return box;
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
    const corners = [min.x, max.x].flatMap((x) => [min.y, max.y].flatMap((y) => [min.z, max.z].map((z) => new Vector3(x, y, z))));
    const away = new Vector3(0.36, -0.94, 0.88).normalize();
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
