// Ghost: where the command has the tool and the held box, and where the command would have put a box when it was released.

import { BoxGeometry, Group, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial, Vector3 } from "three";
import type { Replay } from "../replay/replay";
import type { Boxes } from "./boxes";
import { CupState } from "./cup";
import { matrixOf } from "./maths";
import { meshOfShapes, toolShapes } from "./movers";
import { Outlines } from "./outlines";
import type { Palette } from "./palette";

/** X_WP that the command asked for when the vacuum was switched off, with the cup undeformed. */
export interface PlannedPlace {
  /** When the cup let go, s: the lip stays on the box for a while, and the command moves on. */
  time: number;
  X_WP: Matrix4;
}

/** How far a pose is from a planned one, in W. */
export interface Offset {
  millimetres: [number, number, number];
  degrees: number;
}

/** The planned places of every box, one for each time it was let go; empty without tool, cup or commanded poses. */
export class Plans {
  private readonly places_ = new Map<number, PlannedPlace[]>();
  private readonly cup_: CupState;
  private readonly pose_ = new Float64Array(7);
  private events_ = 0;

  constructor(private readonly replay: Replay) {
    this.cup_ = new CupState(replay);
  }

  /** X_WP of a held box if the tool were at its command and the cup undeformed; null when it is not held. */
  commanded(body: number, frame: number): Matrix4 | null {
    const { replay, pose_: pose } = this;
    const { cup } = replay.header;
    if (!cup || body < 0 || replay.attachedBody(frame) !== body) return null;
    if (!replay.pose(replay.channel("tool.pose"), frame, pose)) return null;
    const X_WS = matrixOf(pose);
    this.cup_.poseAt(frame, pose);
    X_WS.multiply(matrixOf(pose));
    if (!replay.bodyPose(body, frame, pose)) return null;
    const X_SP = X_WS.invert().multiply(matrixOf(pose));
    if (!replay.pose(replay.channel("tool.pose_command"), frame, pose)) return null;
    return matrixOf(pose).multiply(new Matrix4().makeTranslation(0, 0, cup.hold_length)).multiply(X_SP);
  }

  private learn(): void {
    const { replay } = this;
    for (; this.events_ < replay.header.events.length; ++this.events_) {
      const event = replay.header.events[this.events_]!;
      if (event.kind !== "release") continue;
      const body = replay.bodyIndex(event.body);
      const X_WP = this.commanded(body, this.releasedAt(body, event.time));
      if (!X_WP) continue;
      if (!this.places_.has(body)) this.places_.set(body, []);
      this.places_.get(body)!.push({ time: event.time, X_WP });
    }
  }

  /** The frame whose command says where the box was to be let go: the last with vacuum, or where it was lost the last at which it was held. */
  private releasedAt(body: number, time: number): number {
    const { replay } = this;
    let held = replay.frameAt(time);
    for (let k = 0; k < 4 && held > 0 && replay.attachedBody(held) !== body; ++k) --held; // at most a few before the event
    const command = replay.channel("cup.command");
    let frame = held;
    while (command && command.at(0, frame) === 0 && replay.attachedBody(frame) === body) --frame;
    return replay.attachedBody(frame) === body ? frame : held;
  }

  /** The place that a carried box is on its way to; else the one where it was put last, or will be put first. */
  placeAt(body: number, time: number): PlannedPlace | null {
    this.learn();
    const places = this.places_.get(body) ?? [];
    const next = places.find((place) => place.time >= time);
    if (this.isCarried(body, time)) return next ?? places[places.length - 1] ?? null;
    return places.filter((place) => place.time < time).pop() ?? next ?? null;
  }

  /** Whether the cup holds the box. */
  isCarried(body: number, time: number): boolean {
    return body >= 0 && this.replay.attachedBody(this.replay.frameAt(time)) === body;
  }

  /** How far the box is at a frame from its planned place. */
  offsetAt(body: number, frame: number, place: PlannedPlace): Offset | null {
    if (!this.replay.bodyPose(body, frame, this.pose_)) return null;
    const X = matrixOf(this.pose_);
    const d = new Vector3().setFromMatrixPosition(X).sub(new Vector3().setFromMatrixPosition(place.X_WP));
    const R = place.X_WP.clone().invert().multiply(X).elements;
    const sine = Math.hypot(R[6]! - R[9]!, R[8]! - R[2]!, R[1]! - R[4]!);
    const degrees = (Math.atan2(sine, R[0]! + R[5]! + R[10]! - 1) * 180) / Math.PI;
    return { millimetres: [1000 * d.x, 1000 * d.y, 1000 * d.z], degrees };
  }

  /** The same in words, as short as a legend has it, or with its parts along the axes of W; of a box that has not been put there yet only
   * that it will be; empty while no place is known. */
  textAt(body: number, name: string, frame: number, isLong = false): string {
    const time = this.replay.timeOf(frame);
    const place = this.placeAt(body, time);
    if (!place) return "";
    if (this.isCarried(body, time) || place.time >= time) return `planned place of ${name}`;
    const offset = this.offsetAt(body, frame, place);
    if (!offset) return "";
    const degrees = `${offset.degrees.toFixed(1)}° from its planned place`;
    if (!isLong) return `${name}: ${Math.hypot(...offset.millimetres).toFixed(1)} mm, ${degrees}`;
    const [x, y, z] = offset.millimetres.map((v) => v.toFixed(1).replace(/^-(0\.0)$/, "$1"));
    return `${name} lies x ${x}, y ${y}, z ${z} mm (in W), ${degrees}`;
  }
}

export class Ghost {
  readonly group = new Group();
  private readonly boxes_: Outlines;
  private readonly place_: Outlines;
  private readonly body_: Mesh<BoxGeometry, MeshBasicMaterial>;
  private readonly tool_: Mesh | null;
  private readonly pose_ = new Float64Array(7);

  constructor(
    private readonly replay: Replay,
    private readonly plans: Plans,
    palette: Palette,
  ) {
    this.boxes_ = new Outlines(1, palette.ghost, true, 0.9);
    this.place_ = new Outlines(1, palette.select, true, 0.9);
    this.tool_ = this.makeTool(palette);
    this.body_ = new Mesh(new BoxGeometry(2, 2, 2), new MeshBasicMaterial({ color: palette.select, transparent: true, opacity: 0.16, depthWrite: false, fog: false }));
    this.body_.matrixAutoUpdate = false;
    this.body_.renderOrder = 6;
    this.group.add(this.boxes_.lines, this.place_.lines, this.body_);
    if (this.tool_) this.group.add(this.tool_);
  }

  private makeTool(palette: Palette): Mesh | null {
    const { tool, cup } = this.replay.header;
    if (!tool || !this.replay.channel("tool.pose_command")) return null;
    const material = new MeshLambertMaterial({ color: palette.ghost, transparent: true, opacity: 0.28, depthWrite: false });
    const shapes = tool.shapes.length ? tool.shapes : (this.replay.bodies[tool.body]?.shapes ?? []);
    const mesh = meshOfShapes(toolShapes(shapes, cup !== null), material);
    if (!mesh) return null;
    mesh.matrixAutoUpdate = false;
    mesh.renderOrder = 3;
    return mesh;
  }

  setPalette(palette: Palette): void {
    this.boxes_.setColour(palette.ghost);
    this.place_.setColour(palette.select);
    this.body_.material.color.set(palette.select);
    if (this.tool_) (this.tool_.material as MeshLambertMaterial).color.set(palette.ghost);
  }

  /** `marked`: the selected box or the held one, whose planned place is shown. */
  update(frame: number, marked: number, boxes: Boxes, isOn: boolean): void {
    this.boxes_.begin();
    this.place_.begin();
    const hasCommand = isOn && this.replay.pose(this.replay.channel("tool.pose_command"), frame, this.pose_);
    if (this.tool_) {
      this.tool_.visible = hasCommand;
      if (hasCommand) matrixOf(this.pose_, this.tool_.matrix);
      this.tool_.matrixWorldNeedsUpdate = true;
    }
    this.body_.visible = false;
    if (isOn) {
      const time = this.replay.timeOf(frame);
      const held = this.replay.attachedBody(frame);
      const X_WPc = this.plans.commanded(held, frame);
      if (X_WPc) addBox(this.boxes_, boxes, held, X_WPc);
      const place = marked < 0 ? null : this.plans.placeAt(marked, time);
      if (place) addBox(this.place_, boxes, marked, place.X_WP.clone());
      if (place && this.plans.isCarried(marked, time)) this.showBody(boxes, marked, place.X_WP);
    }
    this.boxes_.finish();
    this.place_.finish();
  }

  /** The box itself, seen through, where it is going to be. */
  private showBody(boxes: Boxes, body: number, X_WP: Matrix4): void {
    const half = boxes.halfOf(body);
    const X = boxes.shapePoseOf(body);
    if (!half || !X) return;
    this.body_.matrix.copy(X_WP).multiply(X).scale(half);
    this.body_.matrixWorldNeedsUpdate = true;
    this.body_.visible = true;
  }
}

function addBox(outlines: Outlines, boxes: Boxes, body: number, X_WP: Matrix4): void {
  const half = boxes.halfOf(body);
  const X = boxes.shapePoseOf(body);
  if (half && X) outlines.box(X_WP.multiply(X), half);
}
