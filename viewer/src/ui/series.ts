// Series: what is plotted, out of the channels of a recording, in the units people read.

import type { Channel, Replay } from "../replay/replay";
import { rotationVector } from "../scene/maths";

export type Group = "box" | "tool" | "cup" | "flange" | "limits" | "contacts" | "robot";

export interface Figure {
  group: Group;
  title: string;
  unit: string;
  names: string[];
  /** One function of the frame for each name, NaN where there is nothing. */
  values: (replay: Replay) => ((frame: number) => number)[] | null;
}

const XYZ = ["x", "y", "z"];
const DEGREES = 180 / Math.PI;

function columns(name: string, first: number, count: number, scale = 1): Figure["values"] {
  return (replay) => {
    const channel = replay.channel(name);
    if (!channel) return null;
    return Array.from({ length: count }, (_, k) => (frame: number) => scale * channel.at(first + k, frame));
  };
}

function speed(channel: Channel): (frame: number) => number {
  return (frame) => Math.hypot(channel.at(0, frame), channel.at(1, frame), channel.at(2, frame));
}

const JOINTS = ["1", "2", "3", "4", "5", "6", "7"];

const joints =
  (name: string, scale = 1): Figure["values"] =>
  (replay) => {
    const channel = replay.channel(`joints.${name}`);
    return channel ? channel.columnNames.slice(0, JOINTS.length).map((_, k) => (frame: number) => scale * channel.at(k, frame)) : null;
  };

type Use = (frame: number) => number;

/** How much of its limit each joint uses at a frame, in %, by kind of limit; null where the limits are not known. */
function jointUses(replay: Replay): Record<"speed" | "acceleration" | "torque", Use[]> | null {
  const limits = replay.header.robot?.limits;
  const [velocity, torque] = [replay.channel("joints.velocity"), replay.channel("joints.torque")];
  if (!limits || !velocity || !torque) return null;
  const change = (k: number, frame: number): number => {
    const [a, b] = [Math.max(frame - 1, 0), Math.min(frame + 1, replay.frames - 1)];
    return b > a ? (velocity.at(k, b) - velocity.at(k, a)) / (replay.timeOf(b) - replay.timeOf(a)) : NaN;
  };
  return {
    speed: limits.speed.map((most, k) => (frame) => (100 * Math.abs(velocity.at(k, frame))) / most),
    acceleration: limits.speed.map((_, k) => (frame) => (100 * Math.abs(change(k, frame))) / limits.acceleration),
    torque: limits.torque.map((most, k) => (frame) => (100 * Math.abs(torque.at(k, frame))) / (most ?? Infinity)),
  };
}

const jointUse =
  (kind: "speed" | "acceleration" | "torque"): Figure["values"] =>
  (replay) =>
    jointUses(replay)?.[kind].slice(0, JOINTS.length) ?? null;

const USES = ["speed", "acceleration", "torque", "hold"];

/** Of each kind of limit the joint that is nearest to it, and the hold of the cup. */
const nearestLimits: Figure["values"] = (replay) => {
  const uses = jointUses(replay);
  const hold = replay.channel("cup.hold_use");
  if (!uses && !hold) return null;
  const none: Use = () => NaN;
  const worst = (joints: Use[] | undefined): Use => (joints ? (frame) => Math.max(...joints.map((use) => use(frame))) : none);
  return [worst(uses?.speed), worst(uses?.acceleration), worst(uses?.torque), hold ? (frame) => 100 * hold.at(0, frame) : none];
};

const contactPoints: Figure["values"] = (replay) => {
  if (!replay.contacts) return null;
  return [
    (frame): number => {
      let points = 0;
      replay.forEachContact(frame, () => ++points);
      return points;
    },
  ];
};

const contactForce: Figure["values"] = (replay) => {
  const force = replay.contacts?.force;
  if (!force) return null;
  return [
    (frame): number => {
      let sum = 0;
      replay.forEachContact(frame, (row) => (sum += Math.hypot(force.at(0, row), force.at(1, row), force.at(2, row))));
      return sum;
    },
  ];
};

const turnsOf = new WeakMap<Channel, { rows: number; turns: Float32Array }>();

/** Rotation vectors (rad) of a channel of poses, three a row; of the two that mean the same, the one nearer to the row before. */
export function continuousTurns(channel: Channel): Float32Array {
  const known = turnsOf.get(channel);
  if (known?.rows === channel.rows) return known.turns;
  const turns = new Float32Array(3 * channel.rows).fill(NaN);
  let last: number[] | null = null;
  for (let row = 0; row < channel.rows; ++row) {
    const [w, x, y, z] = [channel.at(3, row), channel.at(4, row), channel.at(5, row), channel.at(6, row)];
    if (!Number.isFinite(w)) continue;
    let v: number[] = rotationVector(w, x, y, z);
    const angle = Math.hypot(v[0]!, v[1]!, v[2]!);
    if (last && angle > 1e-6) {
      const from = last;
      const before = from.reduce((sum, u, k) => sum + u * v[k]!, 0) / angle; // the last one along this axis
      const whole = Math.round((before - angle) / (2 * Math.PI));
      v = v.map((u) => (u * (angle + 2 * Math.PI * whole)) / angle);
    }
    last = v;
    turns.set(v, 3 * row);
  }
  turnsOf.set(channel, { rows: channel.rows, turns });
  return turns;
}

/** Everything that can be plotted, in the order of the column; `box` adds the pose of one box. */
export function figuresOf(box: string): Figure[] {
  const figures: Figure[] = [
    { group: "tool", title: "Tool position, E in W", unit: "m", names: XYZ, values: columns("tool.pose", 0, 3) },
    {
      group: "tool", title: "Tool speed", unit: "m/s", names: ["speed"],
      values: (replay) => {
        const twist = replay.channel("tool.twist");
        return twist ? [speed(twist)] : null;
      },
    },
    { group: "cup", title: "Cup length, E to S", unit: "mm", names: ["length"], values: columns("cup.deformation", 0, 1, 1000) },
    { group: "cup", title: "Cup bending", unit: "deg", names: ["bend"], values: columns("cup.deformation", 1, 1, DEGREES) },
    { group: "cup", title: "Vacuum, gauge", unit: "kPa", names: ["pressure"], values: columns("cup.pressure_gauge", 0, 1, 1e-3) },
    { group: "cup", title: "Force of the cup on the box, in S", unit: "N", names: XYZ, values: columns("cup.wrench", 0, 3) },
    { group: "cup", title: "Torque of the cup on the box, about S", unit: "Nm", names: XYZ, values: columns("cup.wrench", 3, 3) },
    { group: "flange", title: "Force on the flange, in F", unit: "N", names: XYZ, values: columns("flange.wrench", 0, 3) },
    { group: "flange", title: "Torque on the flange, about F", unit: "Nm", names: XYZ, values: columns("flange.wrench", 3, 3) },
    { group: "limits", title: "Used of the nearest joint's limit, and of the hold", unit: "%", names: USES, values: nearestLimits },
    { group: "limits", title: "Used of the joints' speeds", unit: "%", names: JOINTS, values: jointUse("speed") },
    { group: "limits", title: "Used of the joints' acceleration", unit: "%", names: JOINTS, values: jointUse("acceleration") },
    { group: "limits", title: "Used of the drives' torques", unit: "%", names: JOINTS, values: jointUse("torque") },
    { group: "robot", title: "Joint positions", unit: "deg", names: JOINTS, values: joints("position", DEGREES) },
    { group: "robot", title: "Joint velocities", unit: "deg/s", names: JOINTS, values: joints("velocity", DEGREES) },
    { group: "robot", title: "Joint torques of the drives", unit: "Nm", names: JOINTS, values: joints("torque") },
    { group: "contacts", title: "Contact points of boxes that are awake", unit: "1", names: ["points"], values: contactPoints },
    { group: "contacts", title: "Sum of contact forces", unit: "N", names: ["force"], values: contactForce },
    { group: "contacts", title: "Residual of the solver", unit: "µm/s", names: ["residual"], values: columns("solver.residual", 0, 1, 1e6) },
    { group: "contacts", title: "Iterations of the solver", unit: "1", names: ["iterations"], values: columns("solver.iterations", 0, 1) },
  ];
  if (box) {
    figures.unshift(
      {
        group: "box", title: `Position of ${box} in W`, unit: "m", names: XYZ,
        values: (replay) => {
          const body = replay.bodyIndex(box);
          const channel = body < 0 ? undefined : replay.poseChannelOfBody(body);
          if (!channel || channel.rows < 2) return null;
          return [0, 1, 2].map((k) => (frame: number) => channel.at(k, frame));
        },
      },
      {
        group: "box", title: `Rotation vector of ${box} in W`, unit: "deg", names: XYZ,
        values: (replay) => {
          const body = replay.bodyIndex(box);
          const channel = body < 0 ? undefined : replay.poseChannelOfBody(body);
          if (!channel || channel.rows < 2) return null;
          const turns = continuousTurns(channel);
          return [0, 1, 2].map((k) => (frame: number) => DEGREES * (turns[3 * frame + k] ?? NaN));
        },
      },
    );
  }
  return figures;
}

/** At most about `points` points of the frames from `begin` to before `stop`; they keep the smallest and largest value of each stretch. */
export function thin(
  replay: Replay,
  value: (frame: number) => number,
  points: number,
  begin = 0,
  stop = replay.frames,
): [number[], (number | null)[]] {
  const times: number[] = [];
  const values: (number | null)[] = [];
  const add = (frame: number): void => {
    const v = value(frame);
    times.push(replay.timeOf(frame));
    values.push(Number.isFinite(v) ? v : null);
  };
  const stride = Math.max(1, Math.floor((2 * (stop - begin)) / points));
  for (let first = begin; first < stop; first += stride) {
    const end = Math.min(first + stride, stop);
    let low = -1;
    let high = -1;
    let [lowest, highest] = [Infinity, -Infinity];
    for (let frame = first; frame < end; ++frame) {
      const v = value(frame);
      if (!Number.isFinite(v)) continue;
      if (v < lowest) [low, lowest] = [frame, v];
      if (v > highest) [high, highest] = [frame, v];
    }
    if (low < 0) add(first);
    else for (const frame of low === high ? [low] : [Math.min(low, high), Math.max(low, high)]) add(frame);
  }
  return [times, values];
}
