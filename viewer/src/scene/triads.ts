// Triads: axes of frames with the report's letters (W, A, C, T fixed; E, S, P moving); one draw call.

import { Color, ConeGeometry, CylinderGeometry, Group, InstancedMesh, Matrix4, MeshBasicMaterial, Vector3 } from "three";
import { mergeGeometries } from "./shapes";

export interface Triad {
  letter: string;
  X_W: Matrix4;
  size: number;
}

const AXIS_COLOURS = ["#d1495b", "#2a9d5c", "#2f6fd0"];
const MOST = 24;

export class Triads {
  readonly group = new Group();
  private readonly mesh_: InstancedMesh;
  private readonly m_ = new Matrix4();
  private readonly axis_: Matrix4[];

  constructor() {
    const shaft = new CylinderGeometry(0.022, 0.022, 0.85, 8).translate(0, 0.425, 0);
    const head = new ConeGeometry(0.065, 0.2, 12).translate(0, 0.9, 0);
    const arrow = mergeGeometries([shaft, head]);
    this.mesh_ = new InstancedMesh(arrow, new MeshBasicMaterial({ depthTest: false, transparent: true, depthWrite: false }), 3 * MOST);
    this.mesh_.frustumCulled = false;
    this.mesh_.renderOrder = 8;
    for (let i = 0; i < 3 * MOST; ++i) this.mesh_.setColorAt(i, new Color(AXIS_COLOURS[i % 3]!));
    this.axis_ = [
      new Matrix4().makeRotationZ(-Math.PI / 2), // y of the arrow onto x
      new Matrix4(),
      new Matrix4().makeRotationX(Math.PI / 2), // onto z
    ];
    this.group.add(this.mesh_);
  }

  update(triads: Triad[]): void {
    let i = 0;
    for (const triad of triads.slice(0, MOST)) {
      for (const axis of this.axis_) {
        this.m_.copy(triad.X_W).multiply(axis).scale(new Vector3(triad.size, triad.size, triad.size));
        this.mesh_.setMatrixAt(i++, this.m_);
      }
    }
    this.mesh_.count = i;
    this.mesh_.visible = i > 0;
    this.mesh_.instanceMatrix.needsUpdate = true;
  }
}
