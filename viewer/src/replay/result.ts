// What becomes of a run, as `snug simulate --json` prints it and recordings keep it (docs/formats.md, Result).
// Written by the test ResultJson.IsWhatTheViewerReads; the keys stand in runs/internal/result_fields.hpp.

export interface ResultEvent {
  time_s: number;
  kind: string;
  body: string;
  text: string;
  [number: string]: number | string;
}

export interface BoxResult {
  id: string;
  state: "waiting" | "held" | "packed" | "outside" | "dropped" | "lost";
  X_TP: { p: [number, number, number]; quat_wxyz: [number, number, number, number] };
  up: string;
  outside_mm: number;
  above_rim_mm: number;
  events: ResultEvent[];
}

export interface BodyResult {
  name: string;
  X_WB: { p: [number, number, number]; quat_wxyz: [number, number, number, number] };
  speed_m_s: number;
}

export interface Repick {
  id: string;
  offset_mm: number;
  up_before: string;
  up_after: string;
  up_intended: string;
}

export interface SolverSummary {
  steps: number;
  not_converged: number;
  worst_residual_m_s: number;
  worst_penetration_mm: number;
  worst_compliant_penetration_mm: number;
  mean_sweeps: number;
}

export interface ContactResult {
  bodies: [string, string];
  point_m: [number, number, number];
  normal: [number, number, number];
  force_N: [number, number, number];
  gap_mm: number;
  slides: boolean;
}

export interface LostBody {
  body: string;
  time_s: number;
  position_m: [number, number, number];
  velocity_m_s: [number, number, number];
}

export interface ProtectiveStop {
  what: "joint torque" | "joint speed" | "joint range" | "sensor force" | "sensor torque" | "tracking error" | "stuck";
  where: string;
  value: number;
  limit: number;
  unit: string;
  time_s: number;
  row: number;
  waypoint: string;
  touching: string;
  limited_by: string;
}

export interface RunResult {
  duration_s: number;
  wall_s: number;
  real_time_factor: number;
  filling_degree_percent: number;
  boxes: BoxResult[];
  bodies: BodyResult[];
  events: ResultEvent[];
  repick_offset_mean_mm: number;
  repick_offset_worst_mm: number;
  repicks: Repick[];
  solver: SolverSummary;
  state_hash: string;
  contacts: ContactResult[];
  lost: LostBody[];
  protective_stop: ProtectiveStop | null;
  interrupted: boolean;
  ended_by?: string;
  warnings: string[];
  failure: string;
  failure_kind: "none" | "too many pairs" | "not finite" | "lost body" | "protective stop" | "too long" | "contact depth";
}
