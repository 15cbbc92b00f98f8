// Boxes: all dynamic boxes in one draw call, with edges, names and axes drawn on their faces by the shader.

import {
  BufferGeometry, CanvasTexture, Color, DynamicDrawUsage, Float32BufferAttribute, Group, InstancedBufferAttribute, InstancedMesh,
  LinearMipmapLinearFilter, Matrix4, Quaternion, Vector3, type IUniform, type WebGLProgramParametersWithUniforms,
} from "three";
import type { Replay } from "../replay/replay";
import { Lit } from "./lit";
import { matrixOf } from "./maths";
import type { BoxColours, Palette } from "./palette";
import type { TracePoint } from "./trace";

/** Outward normal, right and up of each face as a reader with the box's z up sees it. */
const FACES: { n: number[]; u: number[]; v: number[] }[] = [
  { n: [1, 0, 0], u: [0, 1, 0], v: [0, 0, 1] },
  { n: [-1, 0, 0], u: [0, -1, 0], v: [0, 0, 1] },
  { n: [0, 1, 0], u: [-1, 0, 0], v: [0, 0, 1] },
  { n: [0, -1, 0], u: [1, 0, 0], v: [0, 0, 1] },
  { n: [0, 0, 1], u: [1, 0, 0], v: [0, 1, 0] },
  { n: [0, 0, -1], u: [1, 0, 0], v: [0, -1, 0] },
];
export const CORNERS: [number, number, number][] = [
  [-1, -1, -1], [1, -1, -1], [-1, 1, -1], [1, 1, -1], [-1, -1, 1], [1, -1, 1], [-1, 1, 1], [1, 1, 1],
];
const CELL_W = 128;
const CELL_H = 64;
const COLUMNS = 8;

function unitBox(): BufferGeometry {
  const position: number[] = [];
  const normal: number[] = [];
  const face: number[] = [];
  const index: number[] = [];
  FACES.forEach(({ n, u, v }, f) => {
    for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, 1]] as const) {
      for (let k = 0; k < 3; ++k) position.push(n[k]! + a * u[k]! + b * v[k]!);
      normal.push(...n);
      face.push(a, b, f);
    }
    const o = 4 * f;
    index.push(o, o + 1, o + 2, o, o + 2, o + 3);
  });
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(position, 3));
  geometry.setAttribute("normal", new Float32BufferAttribute(normal, 3));
  geometry.setAttribute("face", new Float32BufferAttribute(face, 3));
  geometry.setIndex(index);
  return geometry;
}

/** White letters on nothing; the shader colours them. The first three cells are the axes. */
function letterAtlas(names: string[]): CanvasTexture {
  const cells = ["X", "Y", "Z", ...names];
  const canvas = document.createElement("canvas");
  canvas.width = CELL_W * COLUMNS;
  canvas.height = CELL_H * Math.max(1, Math.ceil(cells.length / COLUMNS));
  const pen = canvas.getContext("2d")!;
  pen.fillStyle = "#fff";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  cells.forEach((text, i) => {
    pen.font = `600 ${text.length > 4 ? 30 : 54}px "DejaVu Sans", Arial, Helvetica, sans-serif`;
    pen.fillText(text, ((i % COLUMNS) + 0.5) * CELL_W, (Math.floor(i / COLUMNS) + 0.54) * CELL_H, CELL_W - 8);
  });
  const texture = new CanvasTexture(canvas);
  texture.minFilter = LinearMipmapLinearFilter;
  texture.flipY = false;
  return texture;
}

/** BOX013 is 013 on its faces: what all names begin with says nothing. */
export function shortNames(names: string[]): string[] {
  const match = names.map((name) => /^(\D*)(\d+)$/.exec(name));
  const first = match[0]?.[1];
  const share = names.length > 0 && match.every((m) => m && m[1] === first);
  return share ? match.map((m) => m![2]!) : names;
}

const VERTEX_HEAD = `
attribute vec3 face;
attribute vec4 boxHalf; // half edge lengths, m; cell of the name
attribute float boxMark;
varying vec2 vFace;
varying vec2 vExtent;
varying vec3 vCell;
`;
const VERTEX_BODY = `
vFace = face.xy;
float axisOfFace = floor(face.z * 0.5 + 0.01);
vExtent = axisOfFace < 0.5 ? boxHalf.yz : (axisOfFace < 1.5 ? boxHalf.xz : boxHalf.xy);
vCell = vec3(boxHalf.w, axisOfFace, boxMark);
`;
const FRAGMENT_HEAD = `
uniform sampler2D atlas;
uniform vec2 atlasCells;
uniform vec3 ink;
uniform vec3 edgeInk;
uniform vec3 markInk;
uniform float showNames;
uniform float pixelRatio;
varying vec2 vFace;
varying vec2 vExtent;
varying vec3 vCell;
float letter(vec2 at, float cell) {
  // at: (0, 0) lower left to (1, 1) upper right of the cell
  float inside = step(0.0, at.x) * step(at.x, 1.0) * step(0.0, at.y) * step(at.y, 1.0);
  vec2 place = vec2(mod(cell + 0.5, atlasCells.x) - 0.5 + at.x, floor((cell + 0.5) / atlasCells.x) + 1.0 - at.y);
  return inside * texture2D(atlas, place / atlasCells).a;
}
`;
const FRAGMENT_BODY = `
vec2 metres = vFace * vExtent;
vec2 pixel = fwidth(metres);
if (vCell.y > 1.5) { // packing tape along the long side of top and bottom
  float across = vExtent.x > vExtent.y ? metres.y : metres.x;
  float tape = 1.0 - smoothstep(0.014 - 0.5 * pixel.x, 0.014 + 0.5 * pixel.x, abs(across));
  diffuseColor.rgb = mix(diffuseColor.rgb, vec3(1.0), 0.22 * tape);
}
if (showNames > 0.5) {
  float h = clamp(min(vExtent.y * 0.9, vExtent.x * 0.62), 0.008, 0.05);
  float name = letter(metres / vec2(2.0 * h, h) + 0.5, vCell.x);
  float k = 0.55 * h;
  float axis = letter((metres - vec2(vExtent.x - 0.9 * k, -vExtent.y + 0.75 * k)) / vec2(2.0 * k, k) + 0.5, vCell.y);
  diffuseColor.rgb = mix(diffuseColor.rgb, ink, max(0.88 * name, 0.6 * axis));
}
vec2 rim = (vExtent - abs(metres)) / max(pixel, vec2(1e-6));
float width = (vCell.z > 0.5 ? 3.0 : 1.25) * pixelRatio;
float line = 1.0 - smoothstep(width - 0.5, width + 0.5, min(rim.x, rim.y));
diffuseColor.rgb = mix(diffuseColor.rgb, vCell.z > 0.5 ? markInk : edgeInk, line * (vCell.z > 0.5 ? 1.0 : 0.8));
`;

export class Boxes {
  readonly group = new Group();
  /** Rows of the recording's bodies that are drawn here, in the order of instances. */
  readonly bodies: number[];
  readonly names: string[];
  readonly mesh: InstancedMesh;
  private readonly half_: Vector3[] = [];
  private readonly shapePose_: Matrix4[] = [];
  private readonly uniforms_: Record<string, IUniform>;
  private readonly look_: Lit;
  private readonly mark_: InstancedBufferAttribute;
  private readonly pose_ = new Float64Array(7);
  private readonly matrix_ = new Matrix4();
  private readonly instanceOf_ = new Map<number, number>();

  constructor(replay: Replay, palette: Palette, colours: BoxColours) {
    this.bodies = replay.bodies
      .map((body, k) => ({ body, k }))
      .filter(({ body }) => body.kind === "dynamic" && body.shapes.length === 1 && body.shapes[0]!.kind === "box")
      .map(({ k }) => k);
    const boxes = this.bodies.map((k) => replay.bodies[k]!);
    colours.learn(boxes.map((b) => b.type));
    this.names = shortNames(boxes.map((b) => b.name));
    const count = this.bodies.length;
    const texture = letterAtlas(this.names);
    this.uniforms_ = {
      atlas: { value: texture },
      atlasCells: { value: { x: COLUMNS, y: Math.max(1, Math.ceil((count + 3) / COLUMNS)) } },
      ink: { value: new Color(palette.boxInk) },
      edgeInk: { value: new Color(palette.boxEdge) },
      markInk: { value: new Color(palette.select) },
      showNames: { value: 1 },
      pixelRatio: { value: 1 },
    };
    this.look_ = new Lit({ fog: false }, "boxes", (shader) => this.extendShader(shader));
    const geometry = unitBox();
    const half = new Float32Array(4 * count);
    boxes.forEach((body, i) => {
      const shape = body.shapes[0]!;
      if (shape.kind !== "box") return;
      this.half_.push(new Vector3(...shape.half));
      this.shapePose_.push(matrixOf(shape.pose));
      half.set([...shape.half, i + 3], 4 * i);
      this.instanceOf_.set(this.bodies[i]!, i);
    });
    geometry.setAttribute("boxHalf", new InstancedBufferAttribute(half, 4));
    this.mark_ = new InstancedBufferAttribute(new Float32Array(count), 1);
    geometry.setAttribute("boxMark", this.mark_);
    this.mesh = new InstancedMesh(geometry, this.look_.of(false), count);
    this.mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    this.mesh.frustumCulled = false;
    boxes.forEach((body, i) => this.mesh.setColorAt(i, new Color(colours.of(body.type))));
    this.group.add(this.mesh);
  }

  private extendShader(shader: WebGLProgramParametersWithUniforms): void {
    Object.assign(shader.uniforms, this.uniforms_);
    shader.vertexShader =
      VERTEX_HEAD + shader.vertexShader.replace("#include <begin_vertex>", `#include <begin_vertex>\n${VERTEX_BODY}`);
    shader.fragmentShader =
      FRAGMENT_HEAD + shader.fragmentShader.replace("#include <color_fragment>", `#include <color_fragment>\n${FRAGMENT_BODY}`);
  }

  setPalette(palette: Palette): void {
    (this.uniforms_.ink!.value as Color).set(palette.boxInk);
    (this.uniforms_.edgeInk!.value as Color).set(palette.boxEdge);
    (this.uniforms_.markInk!.value as Color).set(palette.select);
  }

  /** Edges keep their width on the screen. */
  setPixelRatio(ratio: number): void {
    this.uniforms_.pixelRatio!.value = ratio;
  }

  setNames(on: boolean): void {
    this.uniforms_.showNames!.value = on ? 1 : 0;
  }

  setTranslucent(on: boolean): void {
    this.look_.change((material) => {
      material.transparent = on;
      material.opacity = on ? 0.35 : 1;
      material.depthWrite = !on;
    });
  }

  setShadows(on: boolean): void {
    this.mesh.material = this.look_.of(on);
  }

  setSelected(body: number): void {
    this.mark_.array.fill(0);
    const i = this.instanceOf_.get(body);
    if (i !== undefined) this.mark_.array[i] = 1;
    this.mark_.needsUpdate = true;
  }

  update(replay: Replay, frame: number): void {
    for (let i = 0; i < this.bodies.length; ++i) {
      if (replay.bodyPose(this.bodies[i]!, frame, this.pose_)) {
        matrixOf(this.pose_, this.matrix_).multiply(this.shapePose_[i]!).scale(this.half_[i]!);
      } else {
        this.matrix_.makeScale(0, 0, 0);
      }
      this.mesh.setMatrixAt(i, this.matrix_);
    }
    this.mesh.instanceMatrix.needsUpdate = true;
  }

  /** X_WB as drawn, or null while the body is not; taken from the matrices that the renderer uses. */
  drawnPose(body: number): { p: [number, number, number]; quat_wxyz: [number, number, number, number] } | null {
    const i = this.instanceOf_.get(body);
    if (i === undefined) return null;
    this.mesh.updateWorldMatrix(true, false);
    this.mesh.getMatrixAt(i, this.matrix_);
    this.matrix_.premultiply(this.mesh.matrixWorld);
    const h = this.half_[i]!;
    if (this.matrix_.getMaxScaleOnAxis() < 1e-9) return null;
    this.matrix_.scale(new Vector3(1 / h.x, 1 / h.y, 1 / h.z)).multiply(this.shapePose_[i]!.clone().invert());
    const p = new Vector3();
    const q = new Quaternion();
    this.matrix_.decompose(p, q, new Vector3());
    return { p: [p.x, p.y, p.z], quat_wxyz: [q.w, q.x, q.y, q.z] };
  }

  halfOf(body: number): Vector3 | null {
    const i = this.instanceOf_.get(body);
    return i === undefined ? null : this.half_[i]!;
  }

  shapePoseOf(body: number): Matrix4 | null {
    const i = this.instanceOf_.get(body);
    return i === undefined ? null : this.shapePose_[i]!;
  }

  cornerPoint(body: number, name: string, corner: number): TracePoint | null {
    const [half, X, c] = [this.halfOf(body), this.shapePoseOf(body), CORNERS[corner]];
    if (!half || !X || !c) return null;
    const local = new Vector3(c[0] * half.x, c[1] * half.y, c[2] * half.z).applyMatrix4(X);
    const sign = (v: number): string => (v < 0 ? "−" : "+");
    return { kind: "body", body, local, label: `${name} corner ${sign(c[0])}x ${sign(c[1])}y ${sign(c[2])}z` };
  }

  shortNameOf(body: number): string {
    const i = this.instanceOf_.get(body);
    return i === undefined ? "" : this.names[i]!;
  }
}

