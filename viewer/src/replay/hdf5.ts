// Hdf5: a recording (.h5) as what the page draws from, read in the page itself: for files that are dropped onto it. What only the scenario
// tells (the reported results, named frames) is left out; `snug report` has it.

import { File, type Dataset } from "jsfive";
import { Vector3 } from "three";
import { ConvexHull } from "three/examples/jsm/math/ConvexHull.js";
import type { Column, Decoded, DecodedChannel } from "./decode";
import { ReplayError } from "./errors";
import { completeHeader, type Body, type Header, type PoseRow, type ReplayEvent, type ResultBox, type RunResult, type Shape } from "./header";
import type { RunResult as CellResult } from "./result";

/** Larger files would not fit into the memory of a page. */
const LARGEST = 200e6;
const POSE = ["x", "y", "z", "qw", "qx", "qy", "qz"];
const WRENCH = ["fx", "fy", "fz", "tx", "ty", "tz"];
/** Of a program's 13 columns, from 0 (docs/formats.md). */
const NAME_COLUMN = 6;
const KINDS = ["static", "kinematic", "dynamic"] as const;

const SIGNATURE = [0x89, 0x48, 0x44, 0x46];
export const isHdf5 = (bytes: Uint8Array): boolean => SIGNATURE.every((byte, k) => bytes[k] === byte);

/** The datasets of a file by path; what is not there has no numbers. */
class Source {
  private readonly file_: File;
  constructor(bytes: ArrayBuffer, name: string) {
    this.file_ = new File(bytes, name);
  }

  private dataset(path: string): Dataset | null {
    try {
      return (this.file_.get(path) as Dataset | null) ?? null;
    } catch {
      return null;
    }
  }
  shape(path: string): number[] {
    return this.dataset(path)?.shape ?? [];
  }
  numbers(path: string): Float64Array {
    const value = this.dataset(path)?.value;
    if (value === undefined || typeof value === "string") return new Float64Array();
    return Float64Array.from(value as ArrayLike<number>, Number);
  }
  texts(path: string): string[] {
    const value = this.dataset(path)?.value;
    if (value === undefined) return [];
    return (typeof value === "string" ? [value] : Array.from(value as ArrayLike<string>)).map((text) => asUtf8(String(text)));
  }
  text(path: string): string {
    return this.texts(path)[0] ?? "";
  }
  /** An attribute of the root; older recordings have them where they cannot be read here. */
  attribute(name: string): unknown {
    return this.file_.attrs[name];
  }
}

/** Texts come as one character a byte, padded with zeros. */
function asUtf8(text: string): string {
  const end = text.indexOf("\0");
  const bytes = Uint8Array.from(end < 0 ? text : text.slice(0, end), (c) => c.charCodeAt(0));
  return [...bytes].some((byte) => byte > 127) ? new TextDecoder().decode(bytes) : (end < 0 ? text : text.slice(0, end));
}

const row = (values: Float64Array, width: number, k: number): number[] => Array.from(values.subarray(width * k, width * (k + 1)));

function hullShape(pose: PoseRow, points: [number, number, number][]): Shape {
  const hull = new ConvexHull().setFromPoints(points.map((p) => new Vector3(...p)));
  const vertices: [number, number, number][] = [];
  const triangles: [number, number, number][] = [];
  for (const face of hull.faces) {
    const corners: number[] = [];
    let edge = face.edge;
    do {
      corners.push(vertices.push(edge.head().point.toArray() as [number, number, number]) - 1);
      edge = edge.next;
    } while (edge !== face.edge);
    for (let i = 2; i < corners.length; ++i) triangles.push([corners[0]!, corners[i - 1]!, corners[i]!]);
  }
  return { kind: "hull", pose, vertices, triangles };
}

function shapesOf(source: Source, bodies: Body[]): void {
  const [of, kinds, poses, halves] = ["body", "kind", "pose", "half"].map((name) => source.numbers(`shapes/${name}`)) as [Float64Array, Float64Array, Float64Array, Float64Array];
  const [radii, lengths, firsts, counts, vertices] = ["radius", "half_length", "vertex_first", "vertex_count", "vertex"].map((name) => source.numbers(`shapes/${name}`)) as Float64Array[];
  of.forEach((body, k) => {
    const pose = row(poses, 7, k) as PoseRow;
    const round = { pose, radius: radii![k]!, half_length: lengths![k]! };
    const points = (): [number, number, number][] =>
      Array.from({ length: counts![k]! }, (_, v) => row(vertices!, 3, firsts![k]! + v) as [number, number, number]);
    const made: Shape[] = [
      { kind: "box", pose, half: row(halves, 3, k) as [number, number, number] },
      { kind: "capsule", ...round },
      ...(kinds[k] === 2 ? [hullShape(pose, points())] : []),
    ];
    const shape: Shape | undefined = kinds[k] === 3 ? { kind: "cylinder", ...round } : made[kinds[k]!];
    if (shape) bodies[body]?.shapes.push(shape);
  });
}

function bodiesOf(source: Source): Body[] {
  const [types, kinds, masses, coms] = [source.texts("bodies/type"), source.numbers("bodies/kind"), source.numbers("bodies/mass"), source.numbers("bodies/com")];
  const bodies = source.texts("bodies/name").map((name, k): Body => ({
    name, type: types[k] ?? "", kind: KINDS[kinds[k]!] ?? "dynamic", mass: masses[k] ?? 0, com: row(coms, 3, k) as [number, number, number], shapes: [],
  }));
  shapesOf(source, bodies);
  return bodies;
}

function eventsOf(source: Source): ReplayEvent[] {
  const [kinds, bodies, texts] = ["kind", "body", "text"].map((name) => source.texts(`events/${name}`)) as [string[], string[], string[]];
  const [firsts, counts, values] = ["number_first", "number_count", "number_value"].map((name) => source.numbers(`events/${name}`)) as [Float64Array, Float64Array, Float64Array];
  const names = source.texts("events/number_name");
  return Array.from(source.numbers("events/time"), (time, k) => {
    const numbers: Record<string, number> = {};
    for (let i = firsts[k]!; i < firsts[k]! + counts[k]!; ++i) numbers[names[i]!] = values[i]!;
    return { time, kind: kinds[k] ?? "", body: bodies[k] ?? "", text: texts[k] ?? "", numbers };
  }).sort((a, b) => a.time - b.time); // a session says what it did when an item is done
}

/** Of another version, perhaps: keys may be missing. */
type StoredResult = Partial<CellResult>;

function parsed<T>(text: string): T | null {
  try {
    return JSON.parse(text) as T;
  } catch {
    return null;
  }
}

function resultOf(stored: StoredResult | null): RunResult | null {
  if (!stored) return null;
  const boxes = (stored.boxes ?? []).map((box): ResultBox => ({
    id: box.id ?? "", state: box.state ?? null, up: box.up ?? "",
    pose: box.X_TP?.p && box.X_TP.quat_wxyz ? ([...box.X_TP.p, ...box.X_TP.quat_wxyz] as PoseRow) : null,
    events: (box.events ?? []).map((e) => ({ kind: e.kind ?? "", time: e.time_s ?? 0, text: e.text ?? "" })),
  }));
  return {
    boxes, filling_degree_percent: stored.filling_degree_percent ?? null, packed: boxes.filter((box) => box.state === "packed").length,
    failure: stored.failure ?? null, ended_by: stored.ended_by ?? "", warnings: stored.warnings ?? [], report_table7: null,
  };
}

/** A number of the cup's settings as the scenario writes it, or its default (docs/scenario.md). */
function cupNumber(scenario: string, key: string, fallback: number): number {
  const block = /^cup:(.*(?:\n[ \t]+.*)*)/m.exec(scenario)?.[1] ?? "";
  const found = new RegExp(`\\b${key}:\\s*([-+.\\deE]+)`).exec(block);
  return found ? Number(found[1]) : fallback;
}

function headerOf(source: Source, name: string, frames: number, times: Float64Array): Header {
  const bodies = bodiesOf(source);
  const stored = parsed<StoredResult>(source.text("result"));
  const scenario = source.text("scenario");
  const tool = bodies.findIndex((body) => body.name === "tool" && body.kind === "kinematic");
  const links = bodies.flatMap((body, k) => (body.kind !== "dynamic" && body.name.startsWith("robot/") ? [k] : []));
  const [poses, size, container] = [source.numbers("container/pose"), source.numbers("container/inner_size"), source.text("container/name")];
  const steps = source.numbers("step");
  const program = source.text("program") || new TextDecoder().decode(Uint8Array.from(source.numbers("program_so_far")));  // the latter: of a run that was killed
  const rows = program.split(/\r?\n/).filter((line) => /^[^#]+,/.test(line)).map((line) => line.split(",")[NAME_COLUMN]?.trim() ?? "");
  const number = (key: string, fallback: number): number => {
    const value = Number(source.attribute(key));
    return Number.isFinite(value) && value > 0 ? value : fallback;
  };
  const isComplete = source.attribute("complete");
  return completeHeader({
    format: "snug replay", version: 1, name, frames, bodies,
    snug_version: asUtf8(String(source.attribute("snug_version") ?? "")),
    seed: String(source.attribute("seed") ?? ""),
    sequence: asUtf8(String(source.attribute("sequence") ?? "")),
    dt: number("dt", frames > 1 ? (times[1]! - times[0]!) / Math.max(1, steps[1]! - steps[0]!) : 0),
    record_period: number("record_period", frames > 1 ? times[1]! - times[0]! : 0),
    complete: isComplete === undefined ? stored !== null : Number(isComplete) === 1,
    interrupted: Number(source.attribute("interrupted") ?? 0) === 1,
    scenario: { name: /^name:\s*(.*)$/m.exec(scenario)?.[1]?.trim() ?? "", text: scenario },
    program: { name: asUtf8(String(source.attribute("program_name") ?? "")), names: rows },
    settings: parsed<Record<string, unknown>>(source.text("settings")),
    speed: stored?.wall_s === undefined ? null : { duration_s: stored.duration_s ?? 0, wall_s: stored.wall_s, real_time_factor: stored.real_time_factor ?? 0 },
    container: container && poses.length >= 14 ? { name: container, pose: [row(poses, 7, 0) as PoseRow, row(poses, 7, 1) as PoseRow], inner_size: row(size, 3, 0) as [number, number, number] } : null,
    tool: tool < 0 ? null : { body: tool, shapes: bodies[tool]!.shapes },
    robot: links.length ? { links } : null,
    cup: tool < 0 ? null : { lip_radius: cupNumber(scenario, "lip_radius", 0.035), free_length: cupNumber(scenario, "free_length", 0.072), hold_length: cupNumber(scenario, "hold_length", 0.05) },
    frames_named: [{ name: "world", letter: "W", X_W: [0, 0, 0, 1, 0, 0, 0] }],
    events: eventsOf(source),
    result: resultOf(stored),
  });
}

/** Columns of a dataset of rows as a channel. */
class Channels {
  readonly all = new Map<string, DecodedChannel>();
  constructor(private readonly source: Source) {}

  add(name: string, columns: string[], rows: number, value: (row: number, column: number) => number, isExact = false): void {
    const make = (c: number): Column => {
      const out = isExact ? new Float64Array(rows) : new Float32Array(rows);
      for (let k = 0; k < rows; ++k) out[k] = value(k, c);
      return out;
    };
    const meta = { name, columns, unit: "", frame: "", quantum: 1, rows, offset: 0, bytes: 0, encoding: "raw" as const };
    this.all.set(name, { meta, columns: columns.map((_, c) => make(c)) });
  }

  /** A dataset whose rows have as many numbers as there are columns. */
  copy(name: string, path: string, columns: string[], most = Infinity, isExact = false): void {
    const values = this.source.numbers(path);
    const rows = Math.min(most, Math.floor(values.length / columns.length));
    if (rows > 0) this.add(name, columns, rows, (k, c) => values[k * columns.length + c]!, isExact);
  }
}

function channelsOf(source: Source, header: Header): Map<string, DecodedChannel> {
  const { frames, bodies } = header;
  const channels = new Channels(source);
  channels.copy("time", "time", ["t"], frames, true);
  channels.copy("program_row", "program_row", ["row"], frames);
  if (header.tool) {
    channels.copy("tool.pose", "tool/pose", POSE, frames);
    channels.copy("tool.pose_command", "tool/pose_command", POSE, frames);
    channels.copy("tool.twist", "tool/twist", ["vx", "vy", "vz", "wx", "wy", "wz"], frames);
    channels.copy("cup.pressure_gauge", "cup/pressure_gauge", ["pressure"], frames);
    channels.copy("cup.attached_body", "cup/attached_body", ["body"], frames);
    const held = source.numbers("cup/attached_body");
    const [pose, length, bend] = [source.numbers("cup/pose"), source.numbers("cup/length"), source.numbers("cup/bend")];
    const isHeld = (k: number): boolean => held[k]! >= 0;
    channels.add("cup.pose", POSE, frames, (k, c) => (isHeld(k) ? pose[7 * k + c]! : NaN));
    channels.add("cup.deformation", ["length", "bend"], frames, (k, c) => (isHeld(k) ? (c === 0 ? length : bend)[k]! : NaN));
    channels.copy("cup.wrench", "cup/wrench", WRENCH, frames);
    channels.copy("flange.wrench", "flange/wrench", WRENCH, frames);
  }
  const [poses, present] = [source.numbers("bodies/pose"), source.numbers("bodies/present")];
  bodies.forEach((body, b) => {
    const rows = body.kind === "static" ? Math.min(1, frames) : frames;
    channels.add(`body.${b}.pose`, POSE, rows, (k, c) => poses[(k * bodies.length + b) * 7 + c]!);
    if (body.kind !== "static") channels.add(`body.${b}.present`, ["present"], frames, (k) => present[k * bodies.length + b]!);
  });
  for (const name of ["residual", "iterations", "status"]) channels.copy(`solver.${name}`, `solver/${name}`, [name === "residual" ? name : "value"], frames);
  const joints = source.texts("joints/name");
  if (joints.length) for (const name of ["position", "velocity", "torque"]) channels.copy(`joints.${name}`, `joints/${name}`, joints, frames);
  for (const name of ["frame_first", "frame_count", "frame_block", "block_first", "block_count"]) channels.copy(`contacts.${name}`, `contacts/${name}`, ["value"], Infinity, true);
  channels.copy("contacts.block_body", "contacts/block_body", ["a", "b"], Infinity, true);
  for (const name of ["point", "normal", "force"]) channels.copy(`contacts.${name}`, `contacts/${name}`, ["x", "y", "z"]);
  for (const name of ["gap", "state"]) channels.copy(`contacts.${name}`, `contacts/${name}`, [name], Infinity, name === "state");
  return channels.all;
}

/** Reads a recording. Throws ReplayError. */
export function decodeHdf5(bytes: Uint8Array, name: string): Decoded {
  if (bytes.length > LARGEST) {
    throw new ReplayError("This recording is too large for a page", `It has ${(bytes.length / 1e6).toFixed(0)} MB; the page reads up to ${LARGEST / 1e6} MB itself.`, "Show a part of it: `snug report RECORDING.h5 --from 10 --to 20 -o report.html`.");
  }
  try {
    const source = new Source(bytes.slice().buffer, name);
    const times = source.numbers("time");
    const bodies = source.texts("bodies/name").length;
    // A run that was killed between two writes has datasets of different length: the shortest counts.
    const poses = bodies > 0 ? (source.shape("bodies/pose")[0] ?? 0) : times.length;
    const frames = Math.min(times.length, poses, source.numbers("contacts/frame_count").length || Infinity, source.numbers("cup/length").length || Infinity);
    if (frames === 0) throw new ReplayError("This recording is empty", "It has no frame.", "Is it a recording of snug?");
    const header = headerOf(source, name, frames, times);
    return { header, channels: channelsOf(source, header), size: bytes.length };
  } catch (error) {
    if (error instanceof ReplayError) throw error;
    throw new ReplayError("This recording cannot be read", `${name} is no recording of snug, or broken: ${String(error)}`, "`snug report RECORDING.h5 -o report.html` reads every recording.");
  }
}
