// Robot: a UR10 drawn from its joints, when the recording has those but no bodies for the links. Lengths are those of the
// maker's data sheet.

import { CapsuleGeometry, Group, Matrix4, Mesh, Quaternion, SphereGeometry, Vector3 } from "three";
import type { Replay } from "../replay/replay";
import { Lit } from "./lit";
import type { Palette } from "./palette";

/** Denavit-Hartenberg rows (a, d, alpha) of the UR10, m and rad. */
const UR10: [number, number, number][] = [
  [0, 0.1273, Math.PI / 2],
  [-0.612, 0, 0],
  [-0.5723, 0, 0],
  [0, 0.163941, Math.PI / 2],
  [0, 0.1157, -Math.PI / 2],
  [0, 0.0922, 0],
];
/** Distance of upper arm and forearm from the plane of the shoulder, along the joint's axis, m. */
const UPPER_ARM = 0.176;
const FOREARM = 0.048;
const RADII = [0.085, 0.065, 0.055, 0.048, 0.048, 0.042];

function rowMatrix(a: number, d: number, alpha: number, theta: number): Matrix4 {
  const [c, s, ca, sa] = [Math.cos(theta), Math.sin(theta), Math.cos(alpha), Math.sin(alpha)];
  // prettier-ignore
  return new Matrix4().set(
    c, -s * ca, s * sa, a * c,
    s, c * ca, -c * sa, a * s,
    0, sa, ca, d,
    0, 0, 0, 1,
  );
}

/** Frames of the six links in the robot's base for joint angles q (rad); the last is the flange. */
export function linkFrames(q: ArrayLike<number>): Matrix4[] {
  const frames: Matrix4[] = [];
  let X = new Matrix4();
  UR10.forEach(([a, d, alpha], i) => {
    X = X.clone().multiply(rowMatrix(a, d, alpha, q[i]!));
    frames.push(X);
  });
  return frames;
}

/** Points between which links are drawn, in W. */
export function linkPoints(q: ArrayLike<number>): [Vector3, Vector3][] {
  const frames = linkFrames(q);
  const at = (i: number, z: number): Vector3 => new Vector3(0, 0, z).applyMatrix4(frames[i]!);
  const shoulder = at(0, 0);
  const upperStart = at(0, UPPER_ARM);
  const upperEnd = at(1, UPPER_ARM);
  const foreStart = at(1, FOREARM);
  const foreEnd = at(2, FOREARM);
  return [
    [new Vector3(), shoulder],
    [upperStart, upperEnd],
    [foreStart, foreEnd],
    [at(2, FOREARM), at(3, 0)],
    [at(3, 0), at(4, 0)],
    [at(4, 0), at(5, 0)],
    [shoulder, upperStart],
    [upperEnd, foreStart],
  ];
}

export class Robot {
  readonly group = new Group();
  /** Whether the joints are known at the frame. */
  isThere = false;
  private readonly look_: Lit;
  private readonly links_: { mesh: Mesh; caps: Mesh[]; radius: number }[] = [];

  /** Null when the recording has no six joints, or has the links themselves. */
  static make(replay: Replay, palette: Palette): Robot | null {
    const joints = replay.channel("joints.position");
    return !replay.header.robot && joints && joints.columnNames.length === 6 ? new Robot(palette) : null;
  }

  private constructor(palette: Palette) {
    this.look_ = new Lit({ color: palette.metal });
    for (let i = 0; i < 8; ++i) {
      const radius = i < 6 ? RADII[i]! : 0.06;
      const mesh = new Mesh(new CapsuleGeometry(radius, 1, 6, 20).rotateX(Math.PI / 2), this.look_.of(false));
      const caps = [0, 1].map(() => new Mesh(new SphereGeometry(radius * 1.08, 20, 14), this.look_.of(false)));
      this.group.add(mesh, ...caps);
      this.links_.push({ mesh, caps, radius });
    }
  }

  setPalette(palette: Palette): void {
    this.look_.setColour(palette.metal);
  }

  setShadows(on: boolean): void {
    for (const { mesh, caps } of this.links_) for (const part of [mesh, ...caps]) part.material = this.look_.of(on);
  }

  update(replay: Replay, frame: number): void {
    const joints = replay.channel("joints.position");
    if (!joints) return;
    const part = frame - Math.floor(frame);
    const q = [0, 1, 2, 3, 4, 5].map((c) => {
      const [from, to] = [joints.at(c, frame), part > 0 ? joints.at(c, frame + 1) : NaN];
      return Number.isFinite(to) ? from + part * (to - from) : from;
    });
    this.isThere = q.every(Number.isFinite);
    if (!this.isThere) return;
    linkPoints(q).forEach(([a, b], i) => {
      const link = this.links_[i]!;
      const along = b.clone().sub(a);
      const length = along.length();
      link.mesh.visible = length > 1e-4;
      if (length > 1e-4) {
        link.mesh.position.copy(a).addScaledVector(along, 0.5);
        link.mesh.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), along.divideScalar(length)));
        link.mesh.scale.set(1, 1, length / (1 + 2 * link.radius));
      }
      link.caps[0]!.position.copy(a);
      link.caps[1]!.position.copy(b);
    });
  }
}
