// Statics: workbench, belt, aligner and containers in four draw calls; the ground fades into the background.

import {
  DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial, PlaneGeometry,
  GridHelper, type BufferGeometry,
} from "three";
import type { Body, Shape } from "../replay/header";
import type { Replay } from "../replay/replay";
import { matrixOf } from "./maths";
import type { Palette } from "./palette";
import { mergeGeometries, shapeGeometry } from "./shapes";

type Role = "fixed" | "belt" | "metal" | "wall";

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

export class Statics {
  readonly group = new Group();
  private readonly materials_: [MeshLambertMaterial | MeshBasicMaterial | LineBasicMaterial, (p: Palette) => string][] = [];
  private readonly wall_: MeshLambertMaterial;
  private grid_: GridHelper | null = null;
  readonly walls = new Group();

  constructor(replay: Replay, palette: Palette) {
    const container = replay.bodies.find((b) => b.name === replay.header.container?.name);
    const faces: Record<Role, BufferGeometry[]> = { fixed: [], belt: [], metal: [], wall: [] };
    const edges: Record<Role, BufferGeometry[]> = { fixed: [], belt: [], metal: [], wall: [] };
    const pose = new Float64Array(7);
    replay.bodies.forEach((body, k) => {
      if (body.kind !== "static" || !replay.bodyPose(k, 0, pose)) return;
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
    this.wall_ = new MeshLambertMaterial({ transparent: true, depthWrite: false, side: DoubleSide });
    for (const role of ["fixed", "belt", "metal"] as const) {
      if (faces[role].length === 0) continue;
      const material = new MeshLambertMaterial({ polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
      this.materials_.push([material, (p) => p[role]]);
      const mesh = new Mesh(mergeGeometries(faces[role]), material);
      mesh.receiveShadow = true;
      this.group.add(mesh);
    }
    const line = new LineBasicMaterial({ transparent: true, opacity: 0.55 });
    this.materials_.push([line, (p) => p.edge]);
    const solidEdges = [...edges.fixed, ...edges.belt, ...edges.metal];
    if (solidEdges.length) this.group.add(new LineSegments(mergeGeometries(solidEdges), line));
    if (faces.wall.length) {
      this.materials_.push([this.wall_, (p) => p.wall]);
      const wall = new Mesh(mergeGeometries(faces.wall), this.wall_);
      wall.renderOrder = 2;
      const wallLine = new LineBasicMaterial({ transparent: true, opacity: 0.75 });
      this.materials_.push([wallLine, (p) => p.wall]);
      this.walls.add(wall, new LineSegments(mergeGeometries(edges.wall), wallLine));
      this.group.add(this.walls);
    }
    this.setPalette(palette);
  }

  private addGround(shape: Shape & { kind: "box" }, pose: Float64Array, palette: Palette): void {
    const top = pose[2]! + shape.pose[2] + shape.half[2];
    const material = new MeshBasicMaterial({ polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 2 });
    this.materials_.push([material, (p) => p.ground]);
    const plane = new Mesh(new PlaneGeometry(2 * shape.half[0], 2 * shape.half[1]), material);
    plane.position.set(pose[0]!, pose[1]!, top);
    const divisions = Math.min(80, Math.round(4 * Math.max(shape.half[0], shape.half[1])));
    this.grid_ = new GridHelper(2 * Math.max(shape.half[0], shape.half[1]), divisions, palette.grid, palette.grid);
    this.grid_.rotation.x = Math.PI / 2;
    this.grid_.position.set(pose[0]!, pose[1]!, top);
    this.group.add(plane, this.grid_);
  }

  setPalette(palette: Palette): void {
    for (const [material, pick] of this.materials_) material.color.set(pick(palette));
    this.wall_.opacity = palette.wallOpacity;
    if (this.grid_) {
      const grid = new GridHelper(1, 1, palette.grid, palette.grid);
      const colours = grid.geometry.getAttribute("color");
      const target = this.grid_.geometry.getAttribute("color");
      for (let i = 0; i < target.count; ++i) target.setXYZ(i, colours.getX(0), colours.getY(0), colours.getZ(0));
      target.needsUpdate = true;
      grid.dispose();
    }
  }
}
