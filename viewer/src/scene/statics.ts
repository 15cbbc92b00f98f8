// Statics: workbench, belt, aligner and containers in few draw calls, their light computed once: they never move.

import {
  Color, Float32BufferAttribute, FrontSide, GridHelper, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial,
  MeshLambertMaterial, Vector3, type BufferGeometry,
} from "three";
import type { Body, Shape } from "../replay/header";
import type { Replay } from "../replay/replay";
import { matrixOf } from "./maths";
import type { Palette } from "./palette";
import { mergeGeometries, shapeGeometry } from "./shapes";
import { SUN } from "./sun";

type Role = "fixed" | "belt" | "metal" | "wall";
const ROLES: Role[] = ["fixed", "belt", "metal", "wall"];

/** A container, or a body of the same make (the demonstrator has a second, empty tote). */
function isContainer(body: Body, container: Body | undefined): boolean {
  if (!container) return false;
  const key = (b: Body): string => b.shapes.map((s) => (s.kind === "box" ? s.half.map((x) => x.toFixed(4)).join() : s.kind)).join(";");
  return body === container || key(body) === key(container);
}

function isGround(body: Body): boolean {
  const [shape] = body.shapes;
  return body.shapes.length === 1 && shape?.kind === "box" && shape.half[0] > 1.5 && shape.half[1] > 1.5;
}

function roleOf(body: Body, container: Body | undefined): Role {
  if (isContainer(body, container)) return "wall";
  if (/conveyor|belt/i.test(body.name)) return "belt";
  if (/align|plate|wall/i.test(body.name)) return "metal";
  return "fixed";
}

/** Writes the colour of each vertex: what three's Lambert material would show of the sky and the sun, without shadows. */
function bakeLight(geometry: BufferGeometry, base: string, palette: Palette): void {
  const normals = geometry.getAttribute("normal");
  const colours = new Float32Array(3 * normals.count);
  const diffuse = new Color(base).multiplyScalar(1 / Math.PI);
  const light = new Color();
  const sky = new Color(palette.skyLight);
  const below = new Color(palette.groundLight);
  const n = new Vector3();
  for (let i = 0; i < normals.count; ++i) {
    n.fromBufferAttribute(normals, i);
    light.copy(below).lerp(sky, 0.5 + 0.5 * n.z).multiplyScalar(palette.ambient);
    const sun = palette.sun * Math.max(0, n.dot(SUN));
    colours.set([(light.r + sun) * diffuse.r, (light.g + sun) * diffuse.g, (light.b + sun) * diffuse.b], 3 * i);
  }
  geometry.setAttribute("color", new Float32BufferAttribute(colours, 3));
}

export class Statics {
  readonly group = new Group();
  readonly walls = new Group();
  private readonly baked_: { mesh: Mesh<BufferGeometry>; role: Role; plain: MeshBasicMaterial; lit: MeshLambertMaterial | null }[] = [];
  private readonly lines_: [LineBasicMaterial, (p: Palette) => string][] = [];
  private grid_: GridHelper | null = null;

  constructor(replay: Replay, palette: Palette) {
    const container = replay.bodies.find((b) => b.name === replay.header.container?.name);
    const faces: Record<Role, BufferGeometry[]> = { fixed: [], belt: [], metal: [], wall: [] };
    const edges: Record<Role, BufferGeometry[]> = { fixed: [], belt: [], metal: [], wall: [] };
    const pose = new Float64Array(7);
    const links = new Set(replay.header.robot?.links ?? []);
    replay.bodies.forEach((body, k) => {
      if (body.kind !== "static" || links.has(k) || !replay.bodyPose(k, 0, pose)) return;
      const X = matrixOf(pose);
      if (isGround(body)) {
        this.addGround(body.shapes[0] as Shape & { kind: "box" }, pose, palette);
        return;
      }
      const role = roleOf(body, container);
      for (const shape of body.shapes) {
        const geometry = shapeGeometry(shape);
        faces[role].push(geometry.faces.applyMatrix4(X));
        if (geometry.edges) edges[role].push(geometry.edges.applyMatrix4(X));
      }
    });
    this.group.add(this.walls);
    for (const role of ROLES) if (faces[role].length) this.addFaces(role, mergeGeometries(faces[role]));
    this.addLines([...edges.fixed, ...edges.belt, ...edges.metal], 0.55, this.group, (p) => p.edge);
    this.addLines(edges.wall, 0.75, this.walls, (p) => p.wall);
    this.setPalette(palette);
  }

  private addFaces(role: Role, geometry: BufferGeometry): void {
    const isWall = role === "wall";
    // One side only: of a thin wall the eye then sees one face, not four, and a slow computer draws a quarter.
    const shared = { side: FrontSide, fog: false, transparent: isWall, depthWrite: !isWall, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };
    const plain = new MeshBasicMaterial({ ...shared, vertexColors: true });
    const mesh = new Mesh(geometry, plain);
    mesh.renderOrder = isWall ? 2 : 0;
    mesh.receiveShadow = !isWall;
    this.baked_.push({ mesh, role, plain, lit: isWall ? null : new MeshLambertMaterial(shared) });
    (isWall ? this.walls : this.group).add(mesh);
  }

  private addLines(parts: BufferGeometry[], opacity: number, parent: Group, pick: (p: Palette) => string): void {
    if (parts.length === 0) return;
    const material = new LineBasicMaterial({ transparent: true, opacity, fog: false });
    this.lines_.push([material, pick]);
    const lines = new LineSegments(mergeGeometries(parts), material);
    lines.renderOrder = 3;
    parent.add(lines);
  }

  /** The ground is the background with a grid that fades into it. */
  private addGround(shape: Shape & { kind: "box" }, pose: Float64Array, palette: Palette): void {
    const divisions = Math.min(80, Math.round(4 * Math.max(shape.half[0], shape.half[1])));
    this.grid_ = new GridHelper(2 * Math.max(shape.half[0], shape.half[1]), divisions, palette.grid, palette.grid);
    this.grid_.rotation.x = Math.PI / 2;
    this.grid_.position.set(pose[0]!, pose[1]!, pose[2]! + shape.pose[2] + shape.half[2]);
    this.grid_.renderOrder = 1;
    this.group.add(this.grid_);
  }

  /** With shadows the light must be computed in each picture. */
  setShadows(on: boolean): void {
    for (const item of this.baked_) item.mesh.material = on && item.lit ? item.lit : item.plain;
  }

  setPalette(palette: Palette): void {
    for (const { mesh, role, plain, lit } of this.baked_) {
      bakeLight(mesh.geometry, palette[role], palette);
      if (role === "wall") plain.opacity = palette.wallOpacity;
      lit?.color.set(palette[role]);
    }
    for (const [material, pick] of this.lines_) material.color.set(pick(palette));
    if (this.grid_) {
      const { r, g, b } = new Color(palette.grid);
      const target = this.grid_.geometry.getAttribute("color");
      for (let i = 0; i < target.count; ++i) target.setXYZ(i, r, g, b);
      target.needsUpdate = true;
    }
  }
}
