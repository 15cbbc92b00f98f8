// Api: the addresses of `snug ui` (docs/ui.md) as functions, their answers as types.

export interface Mistake {
  where: string;
  line: number | null;
  key: string;
  got: string;
  expected: string;
  text: string;
}

export interface ItemLine {
  line: number;
  order: string;
  article: string;
  size_mm: [number, number, number];
  mass_kg: number;
  count: number;
}

/** Of a scenario (containers, target, cup) or of items (lines). */
export interface Facts {
  sequences: string[];
  lines?: ItemLine[];
  containers?: { name: string; inner_size_mm: [number, number, number] }[];
  target?: string;
  cup_radius_mm?: number;
}

export interface Checked {
  text: string;
  mistake: Mistake | null;
  facts: Facts | null;
}

/** Something that stands in a cell and can be moved. */
export interface CellPart {
  key: string;
  name: string;
  position_mm: [number, number, number];
  yaw_deg: number;
}

export interface CellScene {
  parts: CellPart[];
  has_robot: boolean;
  form: string; // replay form, base64
}

export interface CellMove {
  key: string;
  position_mm: [number, number, number];
  yaw_deg: number;
}

/** Where over the container and at the picks the tool can stand; metres. */
export interface ReachMap {
  robot: string;
  container: string;
  pose: [number, number, number, number, number, number, number];
  inner_size: [number, number, number];
  columns: number;
  rows: number;
  verdicts: string[];
  whats: string[];
  counts: Record<string, number>;
  layers: { name: string; height: number; verdicts: number[]; whats: number[] }[];
  picks: { item: string; count: number; position: [number, number, number]; verdict: number; what: number }[];
}

export interface BoxEnd {
  id: string;
  end: string;
  reason: string;
  packed: boolean;
}

export interface RunStatus {
  name: string;
  state: "waiting" | "running" | "done" | "failed" | "ended early" | "not started" | "being read";
  can_be_stopped: boolean;
  command: string;
  message: string;
  sequence: string;
  plant: string;
  items: number;
  done: number;
  packed: number;
  lost: number;
  percent: number;
  time: number;
  stopped: string;
  boxes?: BoxEnd[];
  files: string[];
}

export interface FolderList {
  folder: string;
  version: string;
  scenarios: { name: string; bytes: number }[];
  items: { name: string; bytes: number }[];
  runs: RunStatus[];
  templates: { name: string; description: string }[];
}

export interface RunRequest {
  name: string;
  scenario: string;
  items: string;
  sequence: string;
  plants: number;
  plant_seed: number;
  tempo: number | null;
  resumes: string;
}

/** What the program says no to. */
export class Refused extends Error {
  constructor(
    message: string,
    readonly status: number,
    readonly mistake: Mistake | null,
  ) {
    super(message);
  }
}

async function ask<T>(method: string, path: string, body?: string): Promise<T> {
  const headers: Record<string, string> = method === "GET" ? {} : { "X-Snug": "1" };
  if (body !== undefined) headers["Content-Type"] = "text/plain; charset=utf-8";
  const response = await fetch(`/api/1/${path}`, { method, headers, body });
  const text = await response.text();
  if (response.ok) return JSON.parse(text) as T;
  let said: { error?: string; mistake?: Mistake } = {};
  try {
    said = JSON.parse(text) as typeof said;
  } catch {
    said = { error: text.trim() };
  }
  throw new Refused(said.error || `refused (${response.status})`, response.status, said.mistake ?? null);
}

const as = encodeURIComponent;

export const api = {
  folder: () => ask<FolderList>("GET", "folder"),
  template: (name: string) => ask<{ text: string }>("GET", `templates/${as(name)}`),
  facts: (name: string) => ask<Checked>("GET", `facts/${as(name)}`),
  check: (name: string, text: string) => ask<Checked>("POST", `check/${as(name)}`, text),
  write: (name: string, text: string) => ask<{ facts: Facts }>("PUT", `files/${as(name)}`, text),
  scene: (name: string, text: string) => ask<CellScene>("POST", `scene/${as(name)}`, text),
  reach: (name: string, text: string) => ask<ReachMap>("POST", `reach/${as(name)}`, text),
  move: (name: string, text: string, moves: CellMove[]) => ask<{ text: string }>("POST", `move/${as(name)}`, JSON.stringify({ text, moves })),
  removeFile: (name: string) => ask<object>("DELETE", `files/${as(name)}`),
  commands: (run: RunRequest) => ask<{ runs: { name: string; command: string }[] }>("POST", "commands", JSON.stringify(run)),
  start: (run: RunRequest) => ask<{ runs: { name: string; command: string }[] }>("POST", "runs", JSON.stringify(run)),
  stop: (name: string) => ask<object>("POST", `runs/${as(name)}/stop`),
  removeRun: (name: string) => ask<object>("DELETE", `runs/${as(name)}`),
  fileAddress: (name: string) => `/api/1/files/${as(name)}`,
  reportAddress: (name: string) => `/api/1/runs/${as(name)}/report`,
  frames: (name: string) => new EventSource(`/api/1/runs/${as(name)}/live`),
  events: (name: string) => new EventSource(`/api/1/runs/${as(name)}/events`),
};

export const isGoingOn = (run: RunStatus): boolean => run.state === "running" || run.state === "waiting";
