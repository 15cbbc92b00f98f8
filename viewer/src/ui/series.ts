// Series: what is plotted, out of the channels of a recording, in the units people read.

import type { Channel, Replay } from "../replay/replay";
import { rotationVector } from "../scene/maths";

export interface Figure {
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

/** Everything that can be plotted, in the order of the column; `box` adds the pose of one box. */
export function figuresOf(box: string): Figure[] {
  const figures: Figure[] = [
    { title: "Tool position, E in W", unit: "m", names: XYZ, values: columns("tool.pose", 0, 3) },
    {
      title: "Tool speed", unit: "m/s", names: ["speed"],
      values: (replay) => {
        const twist = replay.channel("tool.twist");
        return twist ? [speed(twist)] : null;
      },
    },
    { title: "Cup length, E to S", unit: "mm", names: ["length"], values: columns("cup.deformation", 0, 1, 1000) },
    { title: "Cup bending", unit: "deg", names: ["bend"], values: columns("cup.deformation", 1, 1, DEGREES) },
    { title: "Vacuum, gauge", unit: "kPa", names: ["pressure"], values: columns("cup.pressure_gauge", 0, 1, 1e-3) },
    { title: "Force of the cup on the box, in S", unit: "N", names: XYZ, values: columns("cup.wrench", 0, 3) },
    { title: "Torque of the cup on the box, about S", unit: "Nm", names: XYZ, values: columns("cup.wrench", 3, 3) },
    { title: "Force on the flange, in F", unit: "N", names: XYZ, values: columns("flange.wrench", 0, 3) },
    { title: "Torque on the flange, about F", unit: "Nm", names: XYZ, values: columns("flange.wrench", 3, 3) },
  ];
  if (box) {
    figures.unshift(
      {
        title: `Position of ${box} in W`, unit: "m", names: XYZ,
        values: (replay) => {
          const body = replay.bodyIndex(box);
          const channel = body < 0 ? undefined : replay.poseChannelOfBody(body);
          if (!channel || channel.rows < 2) return null;
          return [0, 1, 2].map((k) => (frame: number) => channel.at(k, frame));
        },
      },
      {
        title: `Rotation vector of ${box} in W`, unit: "deg", names: XYZ,
        values: (replay) => {
          const body = replay.bodyIndex(box);
          const channel = body < 0 ? undefined : replay.poseChannelOfBody(body);
          if (!channel || channel.rows < 2) return null;
          const vector = (frame: number): number[] => {
            const [w, x, y, z] = [3, 4, 5, 6].map((c) => channel.at(c, frame));
            return Number.isFinite(w) ? rotationVector(w!, x!, y!, z!) : [NaN, NaN, NaN];
          };
          return [0, 1, 2].map((k) => (frame: number) => DEGREES * vector(frame)[k]!);
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
    for (let frame = first; frame < end; ++frame) {
      const v = value(frame);
      if (!Number.isFinite(v)) continue;
      if (low < 0 || v < value(low)) low = frame;
      if (high < 0 || v > value(high)) high = frame;
    }
    if (low < 0) add(first);
    else for (const frame of low === high ? [low] : [Math.min(low, high), Math.max(low, high)]) add(frame);
  }
  return [times, values];
}
