// Section: a plane that cuts the drawing open along an axis of the container; boxes that it cuts are filled where they are cut.

import { BufferGeometry, Color, DoubleSide, DynamicDrawUsage, Float32BufferAttribute, Group, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial, Plane, Vector3 } from "three";
import type { Replay } from "../replay/replay";
import type { Boxes } from "./boxes";
import { CORNERS } from "./boxes";
import { interestBox } from "./cameras";
import { matrixOf } from "./maths";
import { EDGES } from "./outlines";
import type { BoxColours, Palette } from "./palette";

export type SectionAxis = "off" | "x" | "y" | "z";
export const SECTION_AXES: SectionAxis[] = ["off", "x", "y", "z"];
/** Faces lie so far behind the plane that it does not cut them away, m. */
const BEHIND = 1e-4;

/** Corners of the polygon in which a plane cuts a box, in order; empty where it does not. */
export function cutBox(plane: Plane, X_WB: Matrix4, half: Vector3): Vector3[] {
  const corners = CORNERS.map((c) => new Vector3(c[0] * half.x, c[1] * half.y, c[2] * half.z).applyMatrix4(X_WB));
  const heights = corners.map((corner) => plane.distanceToPoint(corner));
  const points: Vector3[] = [];
  for (const [a, b] of EDGES) {
    const [ha, hb] = [heights[a]!, heights[b]!];
    if (ha < 0 === hb < 0) continue;
    points.push(corners[a]!.clone().lerp(corners[b]!, ha / (ha - hb)));
  }
  if (points.length < 3) return [];
  const middle = points.reduce((sum, p) => sum.add(p), new Vector3()).divideScalar(points.length);
  const u = points[0]!.clone().sub(middle).normalize();
  const v = plane.normal.clone().cross(u);
  const angle = (p: Vector3): number => Math.atan2(p.clone().sub(middle).dot(v), p.clone().sub(middle).dot(u));
  return points.sort((p, q) => angle(p) - angle(q));
}

export class Section {
  readonly group = new Group();
  axis: SectionAxis = "off";
  /** From one side of the container (0) to the other (1). */
  part = 0.5;
  readonly plane = new Plane();
  private readonly faces_: Mesh<BufferGeometry, MeshBasicMaterial>;
  private readonly rims_: LineSegments<BufferGeometry, LineBasicMaterial>;
  private readonly X_WI_: Matrix4;
  private readonly low_: Vector3;
  private readonly high_: Vector3;

  constructor(
    private readonly replay: Replay,
    private readonly boxes: Boxes,
    private readonly colours: BoxColours,
    palette: Palette,
  ) {
    this.faces_ = new Mesh(new BufferGeometry(), new MeshBasicMaterial({ vertexColors: true, side: DoubleSide, fog: false }));
    this.rims_ = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color: palette.boxEdge, fog: false }));
    this.faces_.frustumCulled = this.rims_.frustumCulled = false;
    this.rims_.renderOrder = 1;
    this.group.add(this.faces_, this.rims_);
    this.group.visible = false;
    const container = replay.header.container;
    if (container) {
      this.X_WI_ = matrixOf(container.pose[0]).multiply(matrixOf(container.pose[1]));
      const [x, y, z] = container.inner_size;
      [this.low_, this.high_] = [new Vector3(-x / 2, -y / 2, 0), new Vector3(x / 2, y / 2, z)];
    } else {
      const box = interestBox(replay);
      [this.X_WI_, this.low_, this.high_] = [new Matrix4(), box.min, box.max];
    }
  }

  setPalette(palette: Palette): void {
    this.rims_.material.color.set(palette.boxEdge);
  }

  /** The planes for the renderer: what is on the side of the camera is cut away. */
  planes(camera: Vector3): Plane[] {
    if (this.axis === "off") return [];
    const n = new Vector3(this.axis === "x" ? 1 : 0, this.axis === "y" ? 1 : 0, this.axis === "z" ? 1 : 0);
    const at = this.low_.clone().lerp(this.high_, this.part).applyMatrix4(this.X_WI_);
    n.transformDirection(this.X_WI_);
    if (n.dot(camera.clone().sub(at)) > 0) n.negate();
    this.plane.setFromNormalAndCoplanarPoint(n, at);
    return [this.plane];
  }

  /** Fills the boxes that are cut, as they are at a frame. */
  update(frame: number): void {
    this.group.visible = this.axis !== "off";
    if (!this.group.visible) return;
    const positions: number[] = [];
    const shades: number[] = [];
    const rims: number[] = [];
    const pose = new Float64Array(7);
    const plane = this.plane.clone();
    plane.constant -= BEHIND;
    for (const body of this.boxes.bodies) {
      const [half, shape] = [this.boxes.halfOf(body), this.boxes.shapePoseOf(body)];
      if (!half || !shape || !this.replay.bodyPose(body, frame, pose)) continue;
      const corners = cutBox(plane, matrixOf(pose).multiply(shape), half);
      const colour = new Color(this.colours.of(this.replay.bodies[body]!.type)).multiplyScalar(0.82);
      corners.forEach((corner, k) => {
        const next = corners[(k + 1) % corners.length]!;
        rims.push(...corner.toArray(), ...next.toArray());
        if (k < 2) return;
        for (const p of [corners[0]!, corners[k - 1]!, corner]) {
          positions.push(...p.toArray());
          shades.push(colour.r, colour.g, colour.b);
        }
      });
    }
    write(this.faces_.geometry, positions, shades);
    write(this.rims_.geometry, rims);
  }
}

function write(geometry: BufferGeometry, positions: number[], shades?: number[]): void {
  geometry.dispose();
  geometry.setAttribute("position", new Float32BufferAttribute(positions, 3).setUsage(DynamicDrawUsage));
  if (shades) geometry.setAttribute("color", new Float32BufferAttribute(shades, 3));
  geometry.setDrawRange(0, positions.length / 3);
}
