// Header of the replay form: its types, as docs/formats.md ("Replay form") describes them.

export type PoseRow = [number, number, number, number, number, number, number];

export interface ChannelMeta {
  name: string;
  columns: string[];
  unit: string;
  frame: string;
  quantum: number;
  rows: number;
  offset: number;
  bytes: number;
  encoding: "delta" | "raw";
}

export type Shape =
  | { kind: "box"; pose: PoseRow; half: [number, number, number] }
  | { kind: "capsule"; pose: PoseRow; radius: number; half_length: number }
  | { kind: "cylinder"; pose: PoseRow; radius: number; half_length: number }
  | { kind: "hull"; pose: PoseRow; vertices: [number, number, number][]; triangles: [number, number, number][] }
  | { kind: "mesh"; pose: PoseRow; vertices: [number, number, number][]; triangles: [number, number, number][] };

/** How a link of a robot looks, in the place of the shapes that it touches with. */
export interface Look {
  /** Row of the bodies. */
  body: number;
  parts: { colour: [number, number, number]; shape: Shape }[];
}

/** What the joints may do, base to tool: rad/s, rad/s2, Nm (m for joints that slide); null where the URDF does not know. */
export interface JointLimits {
  speed: number[];
  acceleration: number;
  torque: (number | null)[];
}

export interface Body {
  name: string;
  type: string;
  kind: "static" | "kinematic" | "dynamic";
  mass: number;
  com: [number, number, number];
  shapes: Shape[];
}

export interface ReplayEvent {
  time: number;
  kind: string;
  body: string;
  text: string;
  numbers: Record<string, number>;
}

export interface ResultBox {
  id: string;
  state: string | null;
  up: string;
  pose: PoseRow | null;
  events: { kind: string; time: number; text: string }[];
}

export interface RunResult {
  boxes: ResultBox[];
  filling_degree_percent: number | null;
  packed: number | null;
  failure: string | null;
  ended_by?: string; // what ended a served run or a session
  warnings?: string[];
  report_table7: {
    filling_percent: number;
    boxes: number | null;
    same_boxes_percent: number | null;
    agent?: string; // whose these are
    agents?: { agent: string; about?: string; filling_percent: number }[];
  } | null;
}

export interface Header {
  format: string;
  version: number;
  name: string;
  snug_version: string;
  seed: string;
  sequence: string;
  dt: number;
  record_period: number;
  complete: boolean;
  interrupted: boolean;
  frames: number;
  scenario: { name: string; text: string };
  program: { name: string; names: string[] };
  settings: Record<string, unknown> | null;
  speed: { duration_s: number; wall_s: number; real_time_factor: number } | null;
  bodies: Body[];
  container: { name: string; pose: [PoseRow, PoseRow]; inner_size: [number, number, number] } | null;
  tool: { body: number; shapes: Shape[] } | null;
  robot: { links: number[]; looks?: Look[]; limits?: JointLimits | null } | null;
  cup: { lip_radius: number; free_length: number; hold_length: number } | null;
  frames_named: { name: string; letter: string; X_W: PoseRow }[];
  events: ReplayEvent[];
  result: RunResult | null;
  channels: ChannelMeta[];
}

/** Fills what a header leaves out, so that readers need no checks. */
export function completeHeader(h: Partial<Header>): Header {
  return {
    format: h.format ?? "",
    version: h.version ?? 0,
    name: h.name ?? "",
    snug_version: h.snug_version ?? "",
    seed: h.seed ?? "",
    sequence: h.sequence ?? "",
    dt: h.dt ?? 0,
    record_period: h.record_period ?? 0,
    complete: h.complete ?? true,
    interrupted: h.interrupted ?? false,
    frames: h.frames ?? 0,
    scenario: h.scenario ?? { name: "", text: "" },
    program: h.program ?? { name: "", names: [] },
    settings: h.settings ?? null,
    speed: h.speed ?? null,
    bodies: h.bodies ?? [],
    container: h.container ?? null,
    tool: h.tool ?? null,
    robot: h.robot ?? null,
    cup: h.cup ?? null,
    frames_named: h.frames_named ?? [],
    events: h.events ?? [],
    result: h.result ?? null,
    channels: h.channels ?? [],
  };
}
