// Viewpoint: from where the cell is seen best: container, place of pick and arm with as little as possible before them.

import { Box3, Matrix4, Vector3 } from "three";
import type { Shape } from "../replay/header";
import type { Replay } from "../replay/replay";
import { matrixOf } from "./maths";

/** Directions tried: around, and above the horizon (degrees). Below 30 the rim of a tote hides its floor. */
const AROUND = 24;
const ABOVE = [34, 42, 50, 58];
/** Where one stands if nothing is in the way: the side of -y, a little to the right. */
const USUAL_AROUND = Math.atan2(-0.94, 0.36);
const USUAL_ABOVE = 42;
/** What leaving it costs, of the part that is seen: half a turn, and ten degrees up or down. */
const COST_AROUND = 0.1;
const COST_ABOVE = 0.02;
const INSTANTS = 6;

/** A box that hides what is behind it. */
interface Occluder {
  X_GW: Matrix4;
  half: Vector3;
}

/** Points that should be seen at an instant, with what they count, and what moves before them. */
interface Instant {
  points: { at: Vector3; weight: number; isLink?: boolean }[];
  movers: Occluder[];
}

/** Half edges and middle of the box around a shape, in its own frame. */
export function extentOf(shape: Shape): { half: Vector3; centre: Vector3 } {
  if (shape.kind === "box") return { half: new Vector3(...shape.half), centre: new Vector3() };
  if (shape.kind === "hull" || shape.kind === "mesh") {
    const box = new Box3().setFromPoints(shape.vertices.map((v) => new Vector3(...v)));
    return { half: box.getSize(new Vector3()).multiplyScalar(0.5), centre: box.getCenter(new Vector3()) };
  }
  const length = shape.half_length + (shape.kind === "capsule" ? shape.radius : 0);
  return { half: new Vector3(shape.radius, shape.radius, length), centre: new Vector3() };
}

function occluder(X_WB: Matrix4, shape: Shape): Occluder {
  const { half, centre } = extentOf(shape);
  const X_WG = X_WB.clone().multiply(matrixOf(shape.pose)).multiply(new Matrix4().makeTranslation(centre.x, centre.y, centre.z));
  return { X_GW: X_WG.invert(), half };
}

const origin = new Vector3();
const along = new Vector3();

/** Whether the ray from a point along a direction meets the box; a point on its surface is not hidden by it. */
function hides(box: Occluder, from: Vector3, direction: Vector3): boolean {
  origin.copy(from).applyMatrix4(box.X_GW);
  along.copy(direction).transformDirection(box.X_GW);
  let [near, far] = [1e-3, Infinity];
  for (const k of ["x", "y", "z"] as const) {
    const h = box.half[k] - 1e-4;
    if (Math.abs(along[k]) < 1e-12) {
      if (Math.abs(origin[k]) > h) return false;
      continue;
    }
    const [a, b] = [(-h - origin[k]) / along[k], (h - origin[k]) / along[k]];
    near = Math.max(near, Math.min(a, b));
    far = Math.min(far, Math.max(a, b));
    if (near >= far) return false;
  }
  return true;
}

function containerPoints(replay: Replay): Vector3[] {
  const c = replay.header.container;
  if (!c) return [];
  const X = matrixOf(c.pose[0]).multiply(matrixOf(c.pose[1]));
  const [x, y, z] = c.inner_size;
  const parts = [-0.42, -0.14, 0.14, 0.42];
  return [0.02, 0.9].flatMap((up) => parts.flatMap((u) => parts.map((v) => new Vector3(u * x, v * y, up * z).applyMatrix4(X))));
}

/** Where boxes appear: at most a dozen. */
function arrivals(replay: Replay): Vector3[] {
  const points: Vector3[] = [];
  const pose = new Float64Array(7);
  replay.bodies.forEach((body, k) => {
    if (body.kind !== "dynamic" || points.length >= 12) return;
    const present = replay.channel(`body.${k}.present`);
    let frame = 0;
    while (present && present.rows > 1 && frame < replay.frames - 1 && present.at(0, frame) !== 1) ++frame;
    if (replay.bodyPose(k, frame, pose)) points.push(new Vector3(pose[0], pose[1], pose[2]));
  });
  return points;
}

function instantsOf(replay: Replay): Instant[] {
  const container = containerPoints(replay);
  const places = arrivals(replay);
  const links = replay.header.robot?.links ?? [];
  const fixed = [...container.map((at) => ({ at, weight: 1 / container.length })), ...places.map((at) => ({ at, weight: 0.6 / places.length }))];
  const pose = new Float64Array(7);
  const instants: Instant[] = [];
  const count = links.length ? INSTANTS : 1;
  for (let k = 0; k < count; ++k) {
    const frame = Math.floor(((k + 0.5) / count) * replay.frames);
    const instant: Instant = { points: [...fixed], movers: [] };
    for (const link of links) {
      if (!replay.bodyPose(link, frame, pose)) continue;
      const X = matrixOf(pose);
      for (const shape of replay.bodies[link]!.shapes) instant.movers.push(occluder(X, shape));
      instant.points.push({ at: new Vector3(pose[0], pose[1], pose[2]), weight: 0.3 / links.length, isLink: true });
    }
    instants.push(instant);
  }
  return instants;
}

/** Fixed bodies that hide something: not the ground, which is only drawn as a grid, and not the container, seen through. */
function standing(replay: Replay): Occluder[] {
  const links = new Set(replay.header.robot?.links ?? []);
  const pose = new Float64Array(7);
  const container = replay.header.container?.name;
  return replay.bodies.flatMap((body, k) => {
    if (body.kind !== "static" || links.has(k) || body.name === container || !replay.bodyPose(k, 0, pose)) return [];
    const X = matrixOf(pose);
    return body.shapes.filter((s) => !(s.kind === "box" && s.half[0] > 1.5 && s.half[1] > 1.5)).map((shape) => occluder(X, shape));
  });
}

const directionOf = (around: number, above: number): Vector3 =>
  new Vector3(Math.cos(around) * Math.cos(above), Math.sin(around) * Math.cos(above), Math.sin(above));

/** Part of the points that is seen from a direction, 0 to 1. An arm does not hide itself. */
function seenPart(instants: Instant[], fixed: Occluder[], direction: Vector3): number {
  let [seen, all] = [0, 0];
  for (const { points, movers } of instants) {
    points.forEach(({ at, weight, isLink }) => {
      all += weight;
      if (fixed.some((box) => hides(box, at, direction))) return;
      if (!isLink && movers.some((box) => hides(box, at, direction))) return;
      seen += weight;
    });
  }
  return all > 0 ? seen / all : 1;
}

/** Unit vector from the scene to where it is seen from. */
export function chooseDirection(replay: Replay): Vector3 {
  const usual = directionOf(USUAL_AROUND, (USUAL_ABOVE * Math.PI) / 180);
  if (replay.frames === 0) return usual;
  const instants = instantsOf(replay);
  const fixed = standing(replay);
  let best = usual;
  let most = -Infinity;
  for (const above of ABOVE) {
    for (let k = 0; k < AROUND; ++k) {
      const turn = (2 * Math.PI * k) / AROUND;
      const direction = directionOf(USUAL_AROUND + turn, (above * Math.PI) / 180);
      const away = Math.min(turn, 2 * Math.PI - turn) / Math.PI;
      const value = seenPart(instants, fixed, direction) - COST_AROUND * away - COST_ABOVE * (Math.abs(above - USUAL_ABOVE) / 10);
      if (value > most + 1e-9) [best, most] = [direction, value];
    }
  }
  return best;
}
