// Options: what of the drawing can be switched on and off, and which switches mean something for a recording.

import type { Replay } from "../replay/replay";

export interface ViewOptions {
  names: boolean;
  contacts: boolean;
  forces: boolean;
  wrenches: boolean;
  ghost: boolean;
  frames: boolean;
  trace: boolean;
  xray: boolean;
  robot: boolean;
  walls: boolean;
  second: boolean;
  shadows: boolean;
}
export type ViewOption = keyof ViewOptions;

/** Shadows cost a processor most of its time. */
export function defaultOptions(isSoftware: boolean): ViewOptions {
  return {
    names: true, contacts: true, forces: true, wrenches: false, ghost: true, frames: false, trace: false, xray: false,
    robot: true, walls: true, second: true, shadows: !isSoftware,
  };
}

export function availableOptions(replay: Replay, second: Replay | null, hasBoxes: boolean, hasRobot: boolean): ViewOption[] {
  const rules: ViewOptions = {
    names: hasBoxes,
    contacts: replay.contacts !== null,
    forces: replay.contacts !== null,
    wrenches: replay.channel("cup.wrench") !== undefined || replay.channel("flange.wrench") !== undefined,
    ghost: replay.channel("tool.pose_command") !== undefined,
    frames: true,
    trace: replay.bodies.some((b) => b.kind !== "static"),
    xray: hasBoxes,
    robot: hasRobot,
    walls: replay.header.container !== null,
    second: second !== null,
    shadows: true,
  };
  return (Object.keys(rules) as ViewOption[]).filter((key) => rules[key]);
}
