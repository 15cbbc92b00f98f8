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
  containers?: { name: string; inner_size_mm: [number, number, number]; walls: boolean }[];
  target?: string;
  cup_radius_mm?: number;
  links?: string[]; // of an arm: that can carry the tool
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
  now: string; // item under way
  held: string; // item at which who operates is waited for
  boxes?: BoxEnd[];
  files: string[];
}

export interface FolderList {
  folder: string;
  version: string;
  scenarios: { name: string; bytes: number }[];
  items: { name: string; bytes: number }[];
  arms: { name: string; bytes: number }[];
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
  plant?: string; // of another program: click://HOST:PORT, ur://HOST
  observe?: string;
  perception?: string;
  moves_a_robot?: boolean;
  holds?: boolean; // the operator is waited for at the first box
}

export interface Catalogue {
  containers: { name: string; pallet: boolean; inner_size_mm: [number, number, number]; source: string }[];
  cups: { key: string; diameter_mm: number; bellows: number; lip: string; pull_off_N: [number, number, number]; command: string }[];
}

export interface Candidate {
  position_mm: [number, number, number];
  verdict: string;
  insertion: string;
  expected_percent: number;
  cost: number;
  utility: number;
  samples: number;
  success_rate: number;
  failure: string;
  reason: string;
}

interface Forces {
  force_N: number;
  torque_Nm: number;
  displacement_mm: number | null;
}

/** One decision on one item: what was tried, what was expected, what came of it. Positions are in the container's frame. */
export interface Decision {
  item: string;
  time: number;
  outcome: string;
  reason: string;
  planning_seconds: number;
  candidates: Candidate[];
  candidates_in_all: number;
  extent_mm: [number, number, number] | null;
  planned?: { position_mm: [number, number, number]; insertion: string; reorientation: string; predicted_success: number; samples: number };
  predicted?: Forces;
  happened: (Forces & { position_mm: [number, number, number] | null; position_error_mm: number | null; angle_error_deg: number | null }) | null;
  end: string;
  end_reason: string;
  troubles: { time: number; trouble: string; remedy: string; detail: string }[];
  operator: { time: number; order: string; was_followed: boolean; text: string }[];
}

export interface Decisions {
  items: string[];
  decisions: Decision[];
  standing: { item: string; position_mm: [number, number, number]; extent_mm: [number, number, number] }[];
  held: string;
  now: string;
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

async function ask<T>(method: string, path: string, body?: string | Blob): Promise<T> {
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
  catalogue: () => ask<Catalogue>("GET", "catalogue"),
  upload: (name: string, bytes: Blob) => ask<{ facts: Facts }>("PUT", `files/${as(name)}`, bytes),
  putCup: (name: string, text: string, cup: string) => ask<{ text: string }>("POST", `cup/${as(name)}`, JSON.stringify({ text, cup })),
  putArm: (name: string, text: string, arm: string, tool?: string) => ask<{ text: string; links: string[]; tool: string }>("POST", `arm/${as(name)}`, JSON.stringify({ text, arm, tool })),
  removeFile: (name: string) => ask<object>("DELETE", `files/${as(name)}`),
  commands: (run: RunRequest) => ask<{ runs: { name: string; command: string }[] }>("POST", "commands", JSON.stringify(run)),
  start: (run: RunRequest) => ask<{ runs: { name: string; command: string }[] }>("POST", "runs", JSON.stringify(run)),
  stop: (name: string) => ask<object>("POST", `runs/${as(name)}/stop`),
  stopNow: (name: string) => ask<object>("POST", `runs/${as(name)}/stop-now`),
  operate: (name: string, order: string) => ask<{ command: string }>("POST", `runs/${as(name)}/operator`, JSON.stringify({ order })),
  decisions: (name: string) => ask<Decisions>("GET", `runs/${as(name)}/decisions`),
  make: (name: string, what: string) => ask<{ command: string }>("POST", `runs/${as(name)}/make`, JSON.stringify({ what })),
  removeRun: (name: string) => ask<object>("DELETE", `runs/${as(name)}`),
  fileAddress: (name: string) => `/api/1/files/${as(name)}`,
  reportAddress: (name: string) => `/api/1/runs/${as(name)}/report`,
  frames: (name: string) => new EventSource(`/api/1/runs/${as(name)}/live`),
  events: (name: string) => new EventSource(`/api/1/runs/${as(name)}/events`),
};

export const isGoingOn = (run: RunStatus): boolean => run.state === "running" || run.state === "waiting";
