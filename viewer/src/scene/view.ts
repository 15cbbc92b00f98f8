// View: the drawing of one frame of a recording; draws only when something has changed.

import {
  Color, DirectionalLight, Fog, HemisphereLight, MathUtils, Matrix4, Mesh, MeshLambertMaterial, OrthographicCamera, PerspectiveCamera, Quaternion,
  Scene, Vector3, WebGLRenderer,
} from "three";
import type { Replay } from "../replay/replay";
import { RestingContacts } from "../replay/resting";
import { Boxes } from "./boxes";
import { CAMERA_NAMES, Cameras, containerBox, orthoCamera, type CameraName } from "./cameras";
import { Contacts, wrenchArrows } from "./contacts";
import { Cup } from "./cup";
import { Ghost, Plans } from "./ghost";
import { Labels, type Label } from "./labels";
import { setLight } from "./lit";
import { labelsOf, triadsOf } from "./marks";
import { matrixOf } from "./maths";
import { Measure } from "./measure";
import { Movers } from "./movers";
import { availableOptions, defaultOptions, type ViewOption, type ViewOptions } from "./options";
import { isSoftwareRenderer, Pace } from "./pace";
import { BoxColours, PALETTES, type Palette, type Theme } from "./palette";
import { Robot } from "./robot";
import { Second } from "./second";
import { Section, type SectionAxis } from "./section";
import { Statics } from "./statics";
import { drawStill } from "./still";
import { pickBox, findSurface, type Picked, type Pointing } from "./pointing";
import { placeSun } from "./sun";
import { Trace, type TracePoint } from "./trace";
import { Triads } from "./triads";

export class View {
  readonly element = document.createElement("div");
  readonly canvas: HTMLCanvasElement;
  readonly options: ViewOptions;
  readonly cameras: Cameras;
  readonly colours = new BoxColours();
  readonly isSoftware: boolean;
  arrowScale = 0.008; // m/N
  onAfterRender: (() => void) | null = null;
  readonly plans: Plans;
  private readonly renderer_: WebGLRenderer;
  private readonly scene_ = new Scene();
  private readonly labels_ = new Labels();
  private readonly hemisphere_ = new HemisphereLight();
  private readonly sun_ = new DirectionalLight();
  private readonly statics_: Statics;
  private readonly boxes_: Boxes;
  private readonly movers_: Movers;
  private readonly cup_: Cup | null;
  private readonly robot_: Robot | null;
  private readonly contacts_: Contacts;
  private readonly triads_ = new Triads();
  private readonly resting_: RestingContacts;
  private readonly ghost_: Ghost;
  private readonly second_: Second;
  private readonly trace_: Trace;
  readonly measure: Measure;
  readonly section: Section;
  tracePoint: TracePoint | null = null;
  private palette_: Palette;
  private frame_ = 0;
  private at_ = 0; // the frame, and the part of the way to the next
  private selected_ = -1;
  private isScheduled_ = false;
  private isDisposed_ = false;
  private sharpTimer_ = 0;
  private readonly pace_ = new Pace();
  private width_ = 1;
  private height_ = 1;
  private readonly pose_ = new Float64Array(7);
  private readonly X_WE_ = new Matrix4();
  private readonly X_WS_ = new Matrix4();
  private readonly X_ES_ = new Matrix4();
  private hasTool_ = false;
  private drawn_: number[] = [];
  private copy_: HTMLCanvasElement | null = null;

  constructor(
    readonly replay: Replay,
    readonly second: Replay | null,
    theme: Theme,
    private readonly isPicture = false,
  ) {
    this.palette_ = PALETTES[theme];
    this.isSoftware = isSoftwareRenderer();
    // Smooth edges cost a processor four times the pixels; pictures have them anyway.
    this.renderer_ = new WebGLRenderer({ antialias: isPicture || !this.isSoftware, powerPreference: "high-performance" });
    this.canvas = this.renderer_.domElement;
    this.element.className = "view";
    this.element.append(this.canvas, this.labels_.host);
    this.options = defaultOptions(this.isSoftware);
    const has = (name: string): boolean => replay.channel(name) !== undefined;
    this.statics_ = new Statics(replay, this.palette_);
    this.boxes_ = new Boxes(replay, this.palette_, this.colours);
    this.movers_ = new Movers(replay, this.palette_, this.colours, this.boxes_.bodies);
    this.cup_ = replay.header.cup && has("tool.pose") ? new Cup(replay, this.palette_) : null;
    this.robot_ = Robot.make(replay, this.palette_);
    this.contacts_ = new Contacts(this.palette_);
    this.resting_ = new RestingContacts(replay);
    this.plans = new Plans(replay);
    this.ghost_ = new Ghost(replay, this.plans, this.palette_);
    this.second_ = new Second(second, this.palette_);
    this.trace_ = new Trace(this.palette_.trace);
    this.measure = new Measure(this.palette_);
    this.section = new Section(replay, this.boxes_, this.colours, this.palette_);
    this.scene_.add(
      this.measure.group, this.section.group,
      this.hemisphere_, this.sun_, this.sun_.target, this.statics_.group, this.boxes_.group, this.movers_.group, this.trace_.group,
      this.second_.outlines.lines, this.ghost_.group, this.contacts_.group, this.triads_.group,
    );
    if (this.cup_) this.scene_.add(this.cup_.group);
    if (this.robot_) this.scene_.add(this.robot_.group);
    // Near things first: what they hide need not be drawn.
    this.boxes_.mesh.renderOrder = -2;
    this.movers_.group.traverse((object) => (object.renderOrder = -1));
    this.boxes_.mesh.castShadow = true;
    this.boxes_.mesh.receiveShadow = true;
    this.hemisphere_.position.set(0, 0, 1);
    this.cameras = new Cameras(replay, this.canvas, () => this.invalidate());
    placeSun(this.sun_, containerBox(replay));
    this.setTheme(theme);
    this.setShadows();
  }

  /** Toggles that mean something for this recording. */
  get available(): ViewOption[] {
    const hasRobot = this.robot_ !== null || this.replay.header.robot !== null;
    return availableOptions(this.replay, this.second, this.boxes_.bodies.length > 0, hasRobot);
  }

  private setShadows(): void {
    this.renderer_.shadowMap.enabled = this.options.shadows;
    this.sun_.castShadow = this.options.shadows;
    for (const part of [this.statics_, this.boxes_, this.movers_, this.cup_, this.robot_]) part?.setShadows(this.options.shadows);
    this.scene_.traverse((object) => {
      if (object instanceof Mesh && object.material instanceof MeshLambertMaterial) object.material.needsUpdate = true;
    });
  }

  get palette(): Palette {
    return this.palette_;
  }

  setTheme(theme: Theme): void {
    const p = (this.palette_ = PALETTES[theme]);
    setLight(p);
    const background = new Color(p.background);
    this.scene_.background = background;
    this.scene_.fog = new Fog(background, 4, 9);
    this.hemisphere_.color.set(p.skyLight);
    this.hemisphere_.groundColor.set(p.groundLight);
    this.hemisphere_.intensity = p.ambient;
    this.sun_.intensity = p.sun;
    for (const part of [this.statics_, this.boxes_, this.movers_, this.cup_, this.contacts_, this.robot_, this.ghost_, this.measure, this.section]) part?.setPalette(p);
    this.second_.outlines.setColour(p.second);
    this.trace_.setColour(p.trace);
    this.invalidate();
  }

  setOption(option: ViewOption, on: boolean): void {
    this.options[option] = on;
    if (option === "names") this.boxes_.setNames(on);
    if (option === "xray") this.boxes_.setTranslucent(on);
    if (option === "walls") this.statics_.walls.visible = on;
    if (option === "shadows") this.setShadows();
    if (option === "trace" && on && !this.tracePoint) this.setTracePoint({ kind: "tool" });
    this.invalidate();
  }

  setTracePoint(point: TracePoint | null): void {
    this.tracePoint = point;
    this.trace_.build(this.replay, point);
    this.invalidate();
  }

  /** The corner of a box as a point to trace. */
  cornerPoint(body: number, corner: number): TracePoint | null {
    return this.boxes_.cornerPoint(body, this.replay.bodies[body]?.name ?? "", corner);
  }

  setSelected(body: number): void {
    this.selected_ = body;
    this.boxes_.setSelected(body);
    this.invalidate();
  }

  /** The box that is selected, else the one that the cup holds; -1 for none. */
  get marked(): number {
    return this.selected_ >= 0 ? this.selected_ : this.replay.attachedBody(this.frame_);
  }

  /** Moves everything to a frame of the recording, exactly as recorded (Replay.pose between two frames); draws later. */
  setFrame(frame: number): void {
    this.frame_ = Math.floor(frame);
    this.at_ = frame;
    const { replay } = this;
    this.boxes_.update(replay, frame);
    this.movers_.update(replay, frame);
    this.robot_?.update(replay, frame);
    this.hasTool_ = replay.pose(replay.channel("tool.pose"), frame, this.pose_);
    if (this.hasTool_) matrixOf(this.pose_, this.X_WE_);
    if (this.cup_) {
      this.cup_.group.visible = this.hasTool_;
      if (this.hasTool_) matrixOf(this.cup_.update(frame, this.X_WE_), this.X_ES_);
    } else {
      this.X_ES_.identity();
    }
    this.X_WS_.copy(this.X_WE_).multiply(this.X_ES_);
    if (this.hasTool_) this.cameras.follow(new Vector3().setFromMatrixPosition(this.X_WE_));
    this.invalidate();
  }

  /** Draws the axes that are asked for and tells what to write. */
  private markFrames(): Label[] {
    const { replay, options, at_: frame, selected_: selected, marked } = this;
    const at = { frame, X_WE: this.hasTool_ ? this.X_WE_ : null, X_WS: this.hasTool_ && this.cup_ ? this.X_WS_ : null, selected, marked };
    const triads = options.frames ? triadsOf(replay, at) : [];
    this.triads_.update(triads);
    return [...labelsOf(replay, this.boxes_, at, triads, options), ...this.measure.labels()];
  }

  resize(width: number, height: number): void {
    this.width_ = Math.max(1, width);
    this.height_ = Math.max(1, height);
    this.setRatio(this.isSoftware ? 1 : Math.min(2, window.devicePixelRatio || 1));
    this.cameras.setAspect(this.width_ / this.height_);
    this.invalidate();
  }

  private setRatio(ratio: number): void {
    this.renderer_.setPixelRatio(ratio);
    this.renderer_.setSize(this.width_, this.height_);
    this.boxes_.setPixelRatio(ratio);
  }

  /** Where a processor draws, edges are rough while things move: when they stand, one picture has four samples a pixel. */
  private sharpenWhenStill(): void {
    const ratio = this.pace_.ratioAfter(performance.now() - (this.drawn_[this.drawn_.length - 1] ?? 0));
    if (this.renderer_.getPixelRatio() !== ratio) this.setRatio(ratio);
    window.clearTimeout(this.sharpTimer_);
    this.sharpTimer_ = window.setTimeout(() => {
      this.setRatio(2);
      this.render();
    }, 350);
  }

  useCamera(name: CameraName): void {
    this.movers_.setLinksTranslucent(name === "top" || name === "side");
    this.cameras.use(name, this.hasTool_ ? new Vector3().setFromMatrixPosition(this.X_WE_) : null);
    this.invalidate();
  }

  invalidate(): void {
    if (this.isScheduled_) return;
    this.isScheduled_ = true;
    requestAnimationFrame(() => {
      this.isScheduled_ = false;
      if (this.isDisposed_) return;
      if (this.isSoftware && !this.isPicture) this.sharpenWhenStill();
      this.render();
    });
  }

  private readonly pixelSize_ = (point: Vector3): number => {
    const camera = this.cameras.active;
    if (camera instanceof OrthographicCamera) return (camera.top - camera.bottom) / camera.zoom / this.height_;
    const distance = camera.position.distanceTo(point);
    return (2 * distance * Math.tan(MathUtils.degToRad((camera as PerspectiveCamera).fov) / 2)) / this.height_;
  };

  render(): void {
    const { options } = this;
    this.ghost_.update(this.at_, this.marked, this.boxes_, options.ghost);
    this.second_.update(this.replay.timeOf(this.frame_), options.second);
    this.trace_.group.visible = options.trace;
    if (options.trace) this.trace_.update(this.frame_);
    if (this.robot_) this.robot_.group.visible = options.robot && this.robot_.isThere;
    this.movers_.links.visible = options.robot;
    this.contacts_.update(
      this.replay, this.resting_, this.frame_, this.options.wrenches && this.hasTool_ ? wrenchArrows(this.replay, this.frame_, this.X_WE_, this.X_WS_, this.palette_) : [],
      { points: options.contacts, forces: options.forces, wrenches: options.wrenches, scale: this.arrowScale },
      this.pixelSize_,
    );
    const labels = this.markFrames();
    this.measure.update(this.pixelSize_);
    this.renderer_.clippingPlanes = this.section.planes(this.cameras.active.position);
    this.section.update(this.frame_);
    this.renderer_.render(this.scene_, this.cameras.active);
    this.updateCopy();
    this.labels_.update(labels, this.cameras.active, this.width_, this.height_, this.renderer_.clippingPlanes);
    const now = performance.now();
    this.drawn_.push(now);
    if (this.drawn_.length > 600) this.drawn_.splice(0, 300);
    this.onAfterRender?.();
  }

  /** Pictures drawn per second over the last two seconds. */
  fps(): number {
    const since = performance.now() - 2000;
    return this.drawn_.filter((t) => t > since).length / 2;
  }

  /** Draws, and from now on shows a copy that no compositor can lose in the place of the live drawing: for pictures. */
  freeze(): void {
    this.render();
    this.copy_ = document.createElement("canvas");
    [this.copy_.width, this.copy_.height] = [this.canvas.width, this.canvas.height];
    this.copy_.style.cssText = this.canvas.style.cssText;
    this.canvas.replaceWith(this.copy_);
    this.updateCopy();
  }

  private updateCopy(): void {
    this.copy_?.getContext("2d")!.drawImage(this.canvas, 0, 0);
  }

  /** Size of a pixel where the camera looks at, m. */
  get pixelAtTarget(): number {
    return this.pixelSize_(this.cameras.controls.target);
  }

  /** How far the marked box is from where the command would have put it; empty while that is not known. */
  offsetText(isLong = false): string {
    return this.marked < 0 ? "" : this.plans.textAt(this.marked, this.boxes_.shortNameOf(this.marked), this.frame_, isLong);
  }

  get contactsDrawn(): { awake: number; resting: number } {
    return this.contacts_.drawn;
  }

  get drawCalls(): number {
    return this.renderer_.info.render.calls;
  }

  /** What the drawing shows under the points of its canvas. */
  private get pointing(): Pointing {
    const { boxes_: boxes, statics_: statics, movers_: movers, section, pixelSize_: pixelSize } = this;
    return {
      camera: this.cameras.active, width: this.width_, height: this.height_, boxes, pixelSize,
      surfaces: [boxes.mesh, statics.group, movers.group, section.group], cuts: this.renderer_.clippingPlanes,
    };
  }

  /** The box under a point of the canvas (CSS pixels) and its corner nearest to that point. */
  pick(x: number, y: number): Picked | null {
    return pickBox(this.pointing, x, y);
  }

  /** The point of a surface under a point of the canvas (CSS pixels); of a box its corner, if that is near. */
  surfacePoint(x: number, y: number): Vector3 | null {
    return findSurface(this.pointing, x, y);
  }

  /** Cuts the drawing open along an axis of the container, at a part of its length. */
  setSection(axis: SectionAxis, part = this.section.part): void {
    this.section.axis = axis;
    this.section.part = Math.min(1, Math.max(0, part));
    this.invalidate();
  }

  /** Gives back what the drawing holds of the browser. */
  dispose(): void {
    window.clearTimeout(this.sharpTimer_);
    this.isDisposed_ = true;
    this.cameras.controls.dispose();
    this.renderer_.dispose();
    this.renderer_.forceContextLoss();
  }

  /** Draws the container at a frame from above or the side (report Figure 20) onto a canvas. */
  drawContainer(target: HTMLCanvasElement, from: "top" | "side", frame: number): void {
    const box = containerBox(this.replay);
    if (!box) return;
    this.renderer_.clippingPlanes = [];
    const hidden = [this.measure.group, this.section.group, this.movers_.group, this.cup_?.group, this.robot_?.group, this.trace_.group, this.contacts_.group, this.triads_.group,
      this.ghost_.group, this.second_.outlines.lines].filter((o) => o !== undefined && o !== null);
    this.boxes_.update(this.replay, frame);
    this.boxes_.setSelected(-1);
    const ratio = this.renderer_.getPixelRatio();
    drawStill({ renderer: this.renderer_, scene: this.scene_, sun: this.sun_, hidden }, orthoCamera(box, from, target.width / target.height), target);
    this.renderer_.setPixelRatio(ratio);
    this.renderer_.setSize(this.width_, this.height_);
    this.boxes_.setSelected(this.selected_);
    this.boxes_.update(this.replay, this.at_);
    this.render();
  }

  /** X_WB as drawn (from the world matrix), or null. */
  drawnPose(name: string): { p: [number, number, number]; quat_wxyz: [number, number, number, number] } | null {
    const body = this.replay.bodyIndex(name);
    const box = this.boxes_.drawnPose(body);
    if (box) return box;
    const matrix = this.movers_.drawnMatrix(body);
    if (!matrix) return null;
    const p = new Vector3();
    const q = new Quaternion();
    matrix.decompose(p, q, new Vector3());
    return { p: [p.x, p.y, p.z], quat_wxyz: [q.w, q.x, q.y, q.z] };
  }

  /** Of all that moves, as drawn: two pictures of which these differ show something else. */
  get poses(): number[] {
    return [...this.boxes_.mesh.instanceMatrix.array, ...this.X_WS_.elements];
  }

  /** Where the lip of the cup is drawn, W. */
  get lip(): [number, number, number] {
    return new Vector3().setFromMatrixPosition(this.X_WS_).toArray();
  }
}

export { CAMERA_NAMES, type ViewOption };
