// Stage: a cell drawn before anything is done in it; its parts can be pointed at and moved, what is reached is laid over it.

import {
  AxesHelper, BoxGeometry, Box3, Color, EdgesGeometry, Group, InstancedMesh, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial, Object3D, Plane,
  PlaneGeometry, Raycaster, Scene, SphereGeometry, Vector2, Vector3, WebGLRenderer, type Material,
} from "three";
import type { Replay } from "../replay/replay";
import { Cameras } from "../scene/cameras";
import { Cup } from "../scene/cup";
import { setLight } from "../scene/lit";
import { matrixOf } from "../scene/maths";
import { Movers } from "../scene/movers";
import { isSoftwareRenderer } from "../scene/pace";
import { BoxColours, PALETTES, type Palette } from "../scene/palette";
import { Statics } from "../scene/statics";
import { extentOf } from "../scene/viewpoint";
import type { CellPart, ReachMap } from "./api";
import { make } from "./dom";
import { moved, snapped, type Place } from "./placing";

/** Of each verdict of the map; the words beside say the same. */
export const REACH_COLOURS = ["#1f9d55", "#8a9299", "#e69f00", "#7a3fb0", "#cc79a7", "#d0342c"];
const HANDLE = 0.06; // m, half of what stands for a part without a shape
const WIDE = 3; // m: a ground is no part that is pointed at

/** A box over the cell, mm in W. */
export interface DrawnBox {
  centre: [number, number, number];
  extent: [number, number, number];
  yaw_deg: number;
  isPlanned: boolean; // lines; else solid
}

interface Handle {
  part: CellPart;
  box: Box3; // in W
}

/** The box around all that a part is drawn with. */
function boundsOf(replay: Replay, part: CellPart): Box3 {
  const box = new Box3();
  const pose = new Float64Array(7);
  const isOf = (name: string): boolean => (part.key === "robot" ? name.startsWith("robot/") : name === part.name);
  replay.bodies.forEach((body, k) => {
    if (!isOf(body.name) || !replay.bodyPose(k, 0, pose)) return;
    const X = matrixOf(pose);
    for (const shape of body.shapes) {
      const { half, centre } = extentOf(shape);
      box.union(new Box3(centre.clone().sub(half), centre.clone().add(half)).applyMatrix4(X.clone().multiply(matrixOf(shape.pose))));
    }
  });
  const at = new Vector3(...part.position_mm).multiplyScalar(1e-3);
  if (box.isEmpty()) box.setFromCenterAndSize(at, new Vector3(2, 2, 2).multiplyScalar(HANDLE));
  return box;
}

function disposeOf(object: Object3D): void {
  object.traverse((one) => {
    if (!(one instanceof Mesh) && !(one instanceof LineSegments)) return;
    one.geometry.dispose();
    for (const material of [one.material].flat() as Material[]) material.dispose();
  });
}

export class Stage {
  readonly element = make("div", "stage");
  readonly canvas: HTMLCanvasElement;
  onSelect: (key: string) => void = () => undefined;
  /** A part was let go at another place. */
  onMove: (key: string, place: Place) => void = () => undefined;
  snap = 10; // mm
  selected = "";
  private readonly renderer_: WebGLRenderer;
  private readonly scene_ = new Scene();
  private readonly palette_: Palette;
  private readonly outline_: LineSegments<EdgesGeometry, LineBasicMaterial>;
  private readonly wrong_ = new Group();
  private readonly reach_ = new Group();
  private readonly boxes_ = new Group();
  private drawn_ = new Group();
  private cameras_: Cameras | null = null;
  private handles_: Handle[] = [];
  private isScheduled_ = false;
  private drag_: { handle: Handle; from: Vector3; plane: Plane; isUp: boolean; place: Place; pointer: number } | null = null;

  constructor(label = "The cell in 3D: arrow keys move the chosen part, Page Up and Page Down lift it, brackets turn it") {
    this.palette_ = PALETTES[matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light"];
    this.renderer_ = new WebGLRenderer({ antialias: !isSoftwareRenderer() });
    this.canvas = this.renderer_.domElement;
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "application");
    this.canvas.setAttribute("aria-label", label);
    this.element.append(this.canvas);
    this.scene_.background = new Color(this.palette_.background);
    setLight(this.palette_);
    this.outline_ = new LineSegments(new EdgesGeometry(new BoxGeometry(1, 1, 1)), new LineBasicMaterial({ color: this.palette_.select, depthTest: false, transparent: true }));
    this.outline_.renderOrder = 10;
    this.outline_.visible = false;
    this.scene_.add(this.drawn_, this.reach_, this.boxes_, this.outline_, this.wrong_);
    this.listen();
    new ResizeObserver(() => this.resize()).observe(this.element);
  }

  /** Takes the place of what was drawn; the eye stays where it was, unless it is another cell. */
  show(replay: Replay, parts: CellPart[], isOther: boolean): void {
    disposeOf(this.drawn_);
    this.scene_.remove(this.drawn_);
    this.drawn_ = new Group();
    const statics = new Statics(replay, this.palette_);
    const movers = new Movers(replay, this.palette_, new BoxColours(), []);
    movers.update(replay, 0);
    this.drawn_.add(statics.group, movers.group);
    const pose = new Float64Array(7);
    if (replay.header.cup && replay.pose(replay.channel("tool.pose"), 0, pose)) {
      const cup = new Cup(replay, this.palette_);
      cup.update(0, matrixOf(pose));
      this.drawn_.add(cup.group);
    }
    const aligner = parts.find(({ key }) => key === "aligner"); // it may have no plates
    if (aligner) {
      const axes = new AxesHelper(0.12);
      axes.position.set(...aligner.position_mm).multiplyScalar(1e-3);
      axes.rotation.z = (aligner.yaw_deg * Math.PI) / 180;
      this.drawn_.add(axes);
    }
    this.scene_.add(this.drawn_);
    this.handles_ = parts.map((part) => ({ part, box: boundsOf(replay, part) }));
    if (!this.cameras_ || isOther) {
      this.cameras_?.controls.dispose();
      this.cameras_ = new Cameras(replay, this.canvas, () => this.invalidate());
      this.resize();
      this.cameras_.use("cell", null);
    }
    this.select(this.selected);
    this.invalidate();
  }

  select(key: string): void {
    this.selected = key;
    const handle = this.handles_.find(({ part }) => part.key === key);
    this.outline_.visible = handle !== undefined;
    if (handle) this.outline(handle, { position: [...handle.part.position_mm], yaw: handle.part.yaw_deg });
    this.invalidate();
  }

  /** Where the selected part would be. */
  preview(place: Place): void {
    const handle = this.handles_.find(({ part }) => part.key === this.selected);
    if (handle) this.outline(handle, place);
    this.invalidate();
  }

  /** Marks parts that a mistake is about. */
  markWrong(names: string[]): void {
    disposeOf(this.wrong_);
    this.wrong_.clear();
    for (const { part, box } of this.handles_.filter(({ part }) => names.includes(part.name))) {
      const lines = new LineSegments(this.outline_.geometry.clone(), new LineBasicMaterial({ color: REACH_COLOURS[5], depthTest: false, transparent: true }));
      // Where it would be by the moves that are not in the drawing yet.
      const isMoved = part.key === this.selected && this.outline_.visible;
      lines.matrixAutoUpdate = false;
      lines.matrix.copy(isMoved ? this.outline_.matrix : this.boxMatrix(box));
      lines.renderOrder = 11;
      this.wrong_.add(lines);
    }
    this.invalidate();
  }

  /** In the place of those before. */
  showBoxes(boxes: DrawnBox[]): void {
    disposeOf(this.boxes_);
    this.boxes_.clear();
    for (const { centre, extent, yaw_deg, isPlanned } of boxes) {
      const shape = new BoxGeometry(...extent.map((edge) => edge * 1e-3));
      const lines = new LineSegments(new EdgesGeometry(shape), new LineBasicMaterial({ color: isPlanned ? this.palette_.select : 0x7a5a2e, depthTest: !isPlanned, transparent: isPlanned }));
      const drawn = new Group();
      drawn.add(lines);
      if (isPlanned) shape.dispose();
      else drawn.add(new Mesh(shape, new MeshBasicMaterial({ color: 0xd9b483, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 })));
      drawn.position.set(...centre).multiplyScalar(1e-3);
      drawn.rotation.z = (yaw_deg * Math.PI) / 180;
      this.boxes_.add(drawn);
    }
    this.invalidate();
  }

  /** Lays a layer of the map over the container; null: takes it away. */
  showReach(map: ReachMap | null, layer = 0): void {
    disposeOf(this.reach_);
    this.reach_.clear();
    const shown = map?.layers[layer];
    if (map && shown) {
      const [x, y] = [map.inner_size[0] / map.columns, map.inner_size[1] / map.rows];
      const cells = new InstancedMesh(new PlaneGeometry(0.82 * x, 0.82 * y), new MeshBasicMaterial({ transparent: true, opacity: 0.8, side: 2, depthWrite: false }), shown.verdicts.length);
      const X_WT = matrixOf(map.pose);
      const X = new Matrix4();
      shown.verdicts.forEach((verdict, i) => {
        const [column, row] = [i % map.columns, Math.floor(i / map.columns)];
        X.makeTranslation((column + 0.5) * x - map.inner_size[0] / 2, (row + 0.5) * y - map.inner_size[1] / 2, shown.height).premultiply(X_WT);
        cells.setMatrixAt(i, X);
        cells.setColorAt(i, new Color(REACH_COLOURS[verdict]));
      });
      cells.renderOrder = 5;
      this.reach_.add(cells);
      for (const pick of map.picks) {
        const ball = new Mesh(new SphereGeometry(0.012, 16, 12), new MeshBasicMaterial({ color: REACH_COLOURS[pick.verdict], depthTest: false }));
        ball.position.set(...pick.position);
        ball.renderOrder = 6;
        this.reach_.add(ball);
      }
    }
    this.invalidate();
  }

  /** Index of the point of the shown layer under a place of the canvas, or -1. */
  reachAt(clientX: number, clientY: number): number {
    const cells = this.reach_.children[0];
    if (!(cells instanceof InstancedMesh) || !this.cameras_) return -1;
    return this.ray(clientX, clientY).intersectObject(cells)[0]?.instanceId ?? -1;
  }

  /** Middle of a part on the page, for tests and for who points with a script; null: not seen. */
  pointOf(key: string): [number, number] | null {
    const handle = this.handles_.find(({ part }) => part.key === key);
    if (!handle || !this.cameras_) return null;
    const at = handle.box.getCenter(new Vector3()).project(this.cameras_.active);
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    return [left + ((at.x + 1) / 2) * width, top + ((1 - at.y) / 2) * height];
  }

  private boxMatrix(box: Box3): Matrix4 {
    const size = box.getSize(new Vector3()), middle = box.getCenter(new Vector3());
    return new Matrix4().makeTranslation(middle.x, middle.y, middle.z).scale(size);
  }

  private outline({ part, box }: Handle, place: Place): void {
    const p = new Vector3(...part.position_mm).multiplyScalar(1e-3);
    const to = new Vector3(...place.position).multiplyScalar(1e-3);
    const turn = new Matrix4().makeRotationZ(((place.yaw - part.yaw_deg) * Math.PI) / 180);
    const X = new Matrix4().makeTranslation(to.x, to.y, to.z).multiply(turn).multiply(new Matrix4().makeTranslation(-p.x, -p.y, -p.z));
    this.outline_.matrixAutoUpdate = false;
    this.outline_.matrix.copy(X.multiply(this.boxMatrix(box)));
    this.outline_.matrixWorldNeedsUpdate = true;
  }

  private ray(clientX: number, clientY: number): Raycaster {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2((2 * (clientX - left)) / width - 1, 1 - (2 * (clientY - top)) / height), this.cameras_!.active);
    return ray;
  }

  /** The part whose box the ray meets first; the selected one before all others. */
  private partUnder(ray: Raycaster): { handle: Handle; at: Vector3 } | null {
    let best: { handle: Handle; at: Vector3; distance: number } | null = null;
    for (const handle of this.handles_) {
      const size = handle.box.getSize(new Vector3());
      if (handle.part.key !== this.selected && Math.max(size.x, size.y) > WIDE) continue;
      const at = ray.ray.intersectBox(handle.box, new Vector3());
      if (!at) continue;
      const distance = handle.part.key === this.selected ? -1 : at.distanceTo(ray.ray.origin);
      if (!best || distance < best.distance) best = { handle, at, distance };
    }
    return best;
  }

  private listen(): void {
    // Before the camera's own controls, which begin when they see the event.
    this.element.addEventListener("pointerdown", (event) => this.begin(event), { capture: true });
    this.element.addEventListener("pointermove", (event) => this.follow(event), { capture: true });
    for (const kind of ["pointerup", "pointercancel"] as const) this.element.addEventListener(kind, (event) => this.end(event), { capture: true });
    this.canvas.addEventListener("keydown", (event) => this.nudge(event));
  }

  private begin(event: PointerEvent): void {
    if (!this.cameras_ || event.button !== 0 || !event.isPrimary) return;
    const under = this.partUnder(this.ray(event.clientX, event.clientY));
    if (!under) return;
    if (under.handle.part.key !== this.selected) {
      this.select(under.handle.part.key);
      this.onSelect(this.selected);
    }
    const { part } = under.handle;
    const isUp = event.shiftKey;
    const away = this.cameras_.active.getWorldDirection(new Vector3());
    const normal = isUp ? new Vector3(away.x, away.y, 0).normalize() : new Vector3(0, 0, 1);
    this.drag_ = {
      handle: under.handle, from: under.at, plane: new Plane().setFromNormalAndCoplanarPoint(normal, under.at), isUp,
      place: { position: [...part.position_mm], yaw: part.yaw_deg }, pointer: event.pointerId,
    };
    this.cameras_.controls.enabled = false;
  }

  private follow(event: PointerEvent): void {
    const drag = this.drag_;
    if (!drag || event.pointerId !== drag.pointer) return;
    const at = this.ray(event.clientX, event.clientY).ray.intersectPlane(drag.plane, new Vector3());
    if (!at) return;
    const by = at.sub(drag.from).multiplyScalar(1000);
    const { position_mm: from, yaw_deg: yaw } = drag.handle.part;
    const to: Place["position"] = [...from];
    // Only what moves is snapped: the other numbers stay as they are written.
    if (drag.isUp) to[2] = snapped(from[2] + by.z, this.snap);
    else [to[0], to[1]] = [snapped(from[0] + by.x, this.snap), snapped(from[1] + by.y, this.snap)];
    drag.place = { position: to, yaw };
    this.outline(drag.handle, drag.place);
    this.onDrag(drag.handle.part.key, drag.place);
    this.invalidate();
  }

  /** Numbers while a part is dragged. */
  onDrag: (key: string, place: Place) => void = () => undefined;

  private end(event: PointerEvent): void {
    const drag = this.drag_;
    if (!drag || event.pointerId !== drag.pointer) return;
    this.drag_ = null;
    this.cameras_!.controls.enabled = true;
    const before = drag.handle.part.position_mm;
    if (event.type === "pointerup" && drag.place.position.some((x, i) => x !== before[i])) this.onMove(drag.handle.part.key, drag.place);
    else this.select(this.selected);
  }

  private nudge(event: KeyboardEvent): void {
    const handle = this.handles_.find(({ part }) => part.key === this.selected);
    const place = handle && moved({ position: handle.part.position_mm, yaw: handle.part.yaw_deg }, event.key, this.snap);
    if (!place || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    this.outline(handle, place);
    this.invalidate();
    this.onMove(this.selected, place);
  }

  /** What the parts are from now on, though the drawing does not show it yet. */
  setParts(parts: CellPart[]): void {
    for (const handle of this.handles_) {
      const now = parts.find(({ key }) => key === handle.part.key);
      if (!now || now === handle.part) continue;
      handle.box.applyMatrix4(this.change(handle.part, now));
      handle.part = now;
    }
  }

  private change(from: CellPart, to: CellPart): Matrix4 {
    const a = new Vector3(...from.position_mm).multiplyScalar(1e-3), b = new Vector3(...to.position_mm).multiplyScalar(1e-3);
    return new Matrix4().makeTranslation(b.x, b.y, b.z)
      .multiply(new Matrix4().makeRotationZ(((to.yaw_deg - from.yaw_deg) * Math.PI) / 180))
      .multiply(new Matrix4().makeTranslation(-a.x, -a.y, -a.z));
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (width === 0 || height === 0) return;
    this.renderer_.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    this.renderer_.setSize(width, height);
    this.cameras_?.setAspect(width / height);
    this.invalidate();
  }

  invalidate(): void {
    if (this.isScheduled_) return;
    this.isScheduled_ = true;
    requestAnimationFrame(() => {
      this.isScheduled_ = false;
      if (this.cameras_ && this.element.clientWidth > 0) this.renderer_.render(this.scene_, this.cameras_.active);
    });
  }
}
