// Contacts: a mark at each point, coloured by its state, and an arrow for its force; pale where something is before them.

import {
  Color, ConeGeometry, CylinderGeometry, DynamicDrawUsage, GreaterDepth, Group, InstancedMesh, Matrix4, MeshBasicMaterial, OctahedronGeometry,
  Quaternion, Vector3, type BufferGeometry,
} from "three";
import type { Replay } from "../replay/replay";
import type { RestingContacts } from "../replay/resting";
import type { Palette } from "./palette";

export interface Arrow {
  at: Vector3;
  force: Vector3;
  colour: Color;
}

/** The forces of the cup on the box and on the flange at a frame, as recorded in S and in F, whose axes are those of E. */
export function wrenchArrows(replay: Replay, frame: number, X_WE: Matrix4, X_WS: Matrix4, palette: Palette): Arrow[] {
  const arrows: Arrow[] = [];
  for (const [name, X, colour] of [["cup.wrench", X_WS, palette.cupWrench], ["flange.wrench", X_WE, palette.flangeWrench]] as const) {
    const channel = replay.channel(name);
    if (!channel) continue;
    const force = new Vector3(channel.at(0, frame), channel.at(1, frame), channel.at(2, frame));
    const size = force.length();
    if (!(size > 0)) continue;
    arrows.push({ at: new Vector3().setFromMatrixPosition(X), force: force.transformDirection(X).multiplyScalar(size), colour: new Color(colour) });
  }
  return arrows;
}

/** Size of a pixel at a point, m. */
export type PixelSize = (point: Vector3) => number;

const UP = new Vector3(0, 1, 0);

/** How much is seen of what is behind something. */
const HIDDEN = 0.22;

/** A pool of instances that grows when more are asked for; drawn as they are, and as ghosts where something is before them. */
class Pool {
  mesh: InstancedMesh;
  private hidden_: InstancedMesh;
  count = 0;
  constructor(
    private readonly parent: Group,
    private readonly geometry: BufferGeometry,
    private readonly order: number,
    private capacity: number,
  ) {
    [this.mesh, this.hidden_] = this.make();
  }

  private make(): [InstancedMesh, InstancedMesh] {
    const shown = new MeshBasicMaterial({ depthWrite: false, transparent: true });
    const ghost = new MeshBasicMaterial({ depthWrite: false, transparent: true, opacity: HIDDEN, depthFunc: GreaterDepth });
    const mesh = new InstancedMesh(this.geometry, shown, this.capacity);
    mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    mesh.setColorAt(0, new Color());
    const hidden = new InstancedMesh(this.geometry, ghost, 0);
    hidden.instanceMatrix = mesh.instanceMatrix;
    hidden.instanceColor = mesh.instanceColor;
    for (const [k, part] of [hidden, mesh].entries()) {
      part.frustumCulled = false;
      part.renderOrder = this.order + 0.1 * k;
      this.parent.add(part);
    }
    return [mesh, hidden];
  }

  reserve(count: number): void {
    if (count <= this.capacity) return;
    for (const part of [this.mesh, this.hidden_]) {
      this.parent.remove(part);
      (part.material as MeshBasicMaterial).dispose();
      part.dispose();
    }
    this.capacity = Math.max(count, 2 * this.capacity);
    [this.mesh, this.hidden_] = this.make();
  }

  add(matrix: Matrix4, colour: Color): void {
    this.mesh.setMatrixAt(this.count, matrix);
    this.mesh.setColorAt(this.count, colour);
    ++this.count;
  }

  finish(): void {
    for (const part of [this.mesh, this.hidden_]) {
      part.count = this.count;
      part.visible = this.count > 0;
    }
    this.mesh.instanceMatrix.needsUpdate = true;
    if (this.mesh.instanceColor) this.mesh.instanceColor.needsUpdate = true;
  }
}

export interface ContactOptions {
  points: boolean;
  forces: boolean;
  wrenches: boolean;
  /** Length of arrows, m/N. */
  scale: number;
}

export class Contacts {
  readonly group = new Group();
  private readonly points_: Pool;
  private readonly shafts_: Pool;
  private readonly heads_: Pool;
  private readonly m_ = new Matrix4();
  private readonly q_ = new Quaternion();
  private readonly s_ = new Vector3();
  private readonly v_ = new Vector3();
  private readonly at_ = new Vector3();
  private readonly force_ = new Vector3();
  private stateColours_: Color[] = [];
  private restingColours_: Color[] = [];
  /** Contacts drawn in the last picture: recorded at its frame, and of boxes that sleep. */
  readonly drawn = { awake: 0, resting: 0 };

  constructor(palette: Palette) {
    const shaft = new CylinderGeometry(1, 1, 1, 8, 1, true).translate(0, 0.5, 0);
    const head = new ConeGeometry(1, 1, 12).translate(0, -0.5, 0);
    this.points_ = new Pool(this.group, new OctahedronGeometry(1, 1), 12, 128);
    this.shafts_ = new Pool(this.group, shaft, 10, 128);
    this.heads_ = new Pool(this.group, head, 11, 128);
    this.setPalette(palette);
  }

  setPalette(palette: Palette): void {
    this.stateColours_ = [palette.unknown, palette.open, palette.sticking, palette.sliding].map((c) => new Color(c));
    const pale = new Color(palette.background);
    this.restingColours_ = this.stateColours_.map((c) => c.clone().lerp(pale, 0.5));
  }

  /** Draws the contacts of a frame and the given extra arrows. Sizes follow the camera, so call it for each picture. */
  update(replay: Replay, resting: RestingContacts, frame: number, extra: Arrow[], options: ContactOptions, pixel: PixelSize): void {
    this.points_.count = this.shafts_.count = this.heads_.count = 0;
    this.drawn.awake = this.drawn.resting = 0;
    if (replay.contacts && (options.points || options.forces)) {
      replay.forEachContact(frame, () => ++this.drawn.awake);
      resting.forEach(frame, () => ++this.drawn.resting);
      this.reserve(this.drawn.awake + this.drawn.resting + extra.length);
      resting.forEach(frame, (row, a, b) => this.addContact(replay, row, a, b, this.restingColours_, options, pixel));
      replay.forEachContact(frame, (row, a, b) => this.addContact(replay, row, a, b, this.stateColours_, options, pixel));
    } else {
      this.reserve(extra.length);
    }
    if (options.wrenches) {
      for (const arrow of extra) {
        this.addArrow(arrow.at, this.force_.copy(arrow.force).multiplyScalar(options.scale), arrow.colour, pixel(arrow.at), 1.7);
      }
    }
    this.points_.finish();
    this.shafts_.finish();
    this.heads_.finish();
  }

  private addContact(replay: Replay, row: number, a: number, b: number, colours: Color[], options: ContactOptions, pixel: PixelSize): void {
    const tables = replay.contacts!;
    const at = this.at_.set(tables.point.at(0, row), tables.point.at(1, row), tables.point.at(2, row));
    if (!Number.isFinite(at.x)) return;
    const colour = colours[tables.state?.at(0, row) ?? 0] ?? colours[0]!;
    const size = pixel(at);
    if (options.points) this.addPoint(at, Math.max(0.0025, 2.6 * size), colour);
    if (!options.forces) return;
    const force = this.force_.set(tables.force.at(0, row), tables.force.at(1, row), tables.force.at(2, row));
    // Shown on the body that moves: b, unless only a does.
    if (replay.bodies[b]?.kind !== "dynamic" && replay.bodies[a]?.kind === "dynamic") force.negate();
    this.addArrow(at, force.multiplyScalar(options.scale), colour, size, 1);
  }

  private reserve(count: number): void {
    for (const pool of [this.points_, this.shafts_, this.heads_]) pool.reserve(Math.max(1, count));
  }

  private addPoint(at: Vector3, radius: number, colour: Color): void {
    this.m_.makeScale(radius, radius, radius).setPosition(at);
    this.points_.add(this.m_, colour);
  }

  private addArrow(at: Vector3, vector: Vector3, colour: Color, size: number, weight: number): void {
    const length = vector.length();
    if (!(length > 1.5 * size)) return;
    const thick = weight * Math.max(0.0012, 1.15 * size);
    const head = Math.min(0.45 * length, 7 * thick);
    this.q_.setFromUnitVectors(UP, vector.divideScalar(length));
    this.m_.compose(at, this.q_, this.s_.set(thick, length - head, thick));
    this.shafts_.add(this.m_, colour);
    const tip = this.v_.copy(vector).multiplyScalar(length).add(at);
    this.m_.compose(tip, this.q_, this.s_.set(2.6 * thick, head, 2.6 * thick));
    this.heads_.add(this.m_, colour);
  }
}
