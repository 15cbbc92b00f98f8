// Cup: a bellows between E and S, bent, sheared, twisted and compressed as the recording says.

import {
  BufferGeometry, Color, DoubleSide, Float32BufferAttribute, Group, Matrix4, Mesh, Quaternion, Vector3,
} from "three";
import type { Replay } from "../replay/replay";
import { Lit } from "./lit";
import type { Palette } from "./palette";

const RINGS = 48;
const SEGMENTS = 24;
const FOLDS = 3;

/** X_ES at a frame: the recorded deformation while the cup holds, else the free or evacuated cup. */
export class CupState {
  private lowestSoFar_ = 0;
  private looked_ = 0; // rows; a run that goes on brings more
  constructor(private readonly replay: Replay) {}

  private get lowest_(): number {
    const pressure = this.replay.channel("cup.pressure_gauge");
    for (const rows = pressure?.rows ?? 0; this.looked_ < rows; ++this.looked_) this.lowestSoFar_ = Math.min(this.lowestSoFar_, pressure!.at(0, this.looked_) || 0);
    return this.lowestSoFar_;
  }

  /** Writes X_ES (7 numbers) and tells whether the cup holds something. */
  poseAt(frame: number, out: Float64Array): boolean {
    const { replay } = this;
    const cup = replay.header.cup;
    const isHolding = replay.attachedBody(frame) >= 0;
    if (isHolding && replay.pose(replay.channel("cup.pose"), frame, out)) return true;
    const free = cup?.free_length ?? 0.07;
    const hold = cup?.hold_length ?? free;
    const pressure = replay.channel("cup.pressure_gauge")?.at(0, frame) ?? 0;
    const vacuum = this.lowest_ < 0 ? Math.min(1, Math.max(0, pressure / this.lowest_)) : 0;
    out.fill(0);
    out[2] = free + (hold - free) * vacuum;
    out[3] = 1;
    return false;
  }

  /** How much of the recording's deepest vacuum there is, 0 to 1. */
  vacuumAt(frame: number): number {
    const pressure = this.replay.channel("cup.pressure_gauge")?.at(0, frame) ?? 0;
    return this.lowest_ < 0 ? Math.min(1, Math.max(0, pressure / this.lowest_)) : 0;
  }
}

/** Radius over the way from E (0) to S (1), in lip radii: socket, folds, foam lip. */
function profile(s: number, compression: number): number {
  if (s < 0.1) return 0.44;
  if (s > 0.84) return 0.74 + 0.26 * Math.min(1, (s - 0.84) / 0.1);
  const phase = ((s - 0.1) / 0.74) * FOLDS;
  const wave = 1 - Math.abs(2 * (phase - Math.floor(phase)) - 1);
  return 0.58 + (0.2 + 0.12 * compression) * wave;
}

export class Cup {
  readonly group = new Group();
  private readonly position_: Float32BufferAttribute;
  private readonly geometry_ = new BufferGeometry();
  private readonly look_ = new Lit({ vertexColors: true, side: DoubleSide });
  private readonly mesh_: Mesh;
  private readonly ghostlyColour_ = new Color();
  private body_ = new Color();
  private lip_ = new Color();
  private hold_ = new Color();
  private lipRadius_: number;
  private readonly X_ES_ = new Float64Array(7);
  private readonly state_: CupState;

  constructor(replay: Replay, palette: Palette) {
    this.state_ = new CupState(replay);
    this.lipRadius_ = replay.header.cup?.lip_radius ?? 0.035;
    const count = (RINGS + 1) * (SEGMENTS + 1);
    this.position_ = new Float32BufferAttribute(new Float32Array(3 * count), 3);
    this.geometry_.setAttribute("position", this.position_);
    this.geometry_.setAttribute("normal", new Float32BufferAttribute(new Float32Array(3 * count), 3));
    this.geometry_.setAttribute("color", new Float32BufferAttribute(new Float32Array(3 * count), 3));
    const index: number[] = [];
    for (let r = 0; r < RINGS; ++r) {
      for (let s = 0; s < SEGMENTS; ++s) {
        const a = r * (SEGMENTS + 1) + s;
        const b = a + SEGMENTS + 1;
        index.push(a, b, a + 1, b, b + 1, a + 1);
      }
    }
    this.geometry_.setIndex(index);
    this.mesh_ = new Mesh(this.geometry_, this.look_.of(false));
    this.mesh_.frustumCulled = false;
    this.mesh_.castShadow = true;
    this.group.add(this.mesh_);
    this.group.matrixAutoUpdate = false;
    this.setPalette(palette);
  }

  setPalette(palette: Palette): void {
    this.body_ = new Color(palette.cup);
    this.lip_ = new Color(palette.lip);
    this.hold_ = new Color(palette.sticking);
  }

  setShadows(on: boolean): void {
    this.mesh_.material = this.look_.of(on);
  }

  /** X_WE must be set as the group's matrix before; draws X_ES of the frame. Returns X_ES. */
  update(frame: number, X_WE: Matrix4): Float64Array {
    this.group.matrix.copy(X_WE);
    this.group.matrixWorldNeedsUpdate = true;
    this.state_.poseAt(frame, this.X_ES_);
    this.deform(this.X_ES_, this.state_.vacuumAt(frame));
    return this.X_ES_;
  }

  private deform(X_ES: Float64Array, vacuum: number): void {
    const end = new Vector3(X_ES[0], X_ES[1], X_ES[2]);
    const turn = new Quaternion(X_ES[4], X_ES[5], X_ES[6], X_ES[3]);
    const axis = new Vector3(0, 0, 1).applyQuaternion(turn);
    const length = Math.max(0.01, end.length());
    const compression = Math.min(1, Math.max(0, 1.6 - length / 0.045));
    const q = new Quaternion();
    const none = new Quaternion();
    const centre = new Vector3();
    const radial = new Vector3();
    const colours = this.geometry_.getAttribute("color");
    this.ghostlyColour_.copy(this.body_).lerp(this.hold_, 0.35 * vacuum);
    for (let r = 0; r <= RINGS; ++r) {
      const s = r / RINGS;
      // Hermite curve that leaves E along its z and arrives at S along the z of S.
      const h1 = s * s * (3 - 2 * s);
      const h2 = s * (1 - s) * (1 - s) * length;
      const h3 = s * s * (s - 1) * length;
      centre.set(h3 * axis.x, h3 * axis.y, h2 + h3 * axis.z).addScaledVector(end, h1);
      q.slerpQuaternions(none, turn, h1);
      const radius = this.lipRadius_ * profile(s, compression);
      const isLip = s > 0.84;
      for (let k = 0; k <= SEGMENTS; ++k) {
        const angle = (2 * Math.PI * k) / SEGMENTS;
        radial.set(radius * Math.cos(angle), radius * Math.sin(angle), 0).applyQuaternion(q).add(centre);
        const i = r * (SEGMENTS + 1) + k;
        this.position_.setXYZ(i, radial.x, radial.y, radial.z);
        const shade = isLip ? this.lip_ : this.ghostlyColour_;
        const stripe = k < 1 ? 0.5 : 0; // one light stripe shows torsion
        colours.setXYZ(i, shade.r + stripe, shade.g + stripe, shade.b + stripe);
      }
    }
    this.position_.needsUpdate = true;
    colours.needsUpdate = true;
    this.geometry_.computeVertexNormals();
  }
}
