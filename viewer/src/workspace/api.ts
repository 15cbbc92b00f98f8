// Api: the addresses of `snug ui` (docs/ui-interface.md) as functions, their answers as the types that the program writes (api_types.ts).

import type {
  Catalogue, CellMove, CellScene, Checked, CupSheet, Decisions, EditedText, FolderList, Made, Mistake, ReachMap, Refusal, RunCommands, RunRequest, RunStatus, Said, SheetAnswers, SheetRead, TemplateText, TypicalDrawn, TypicalOrders, Written,
} from "./api_types";

export type * from "./api_types";

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
  let said: Partial<Refusal> = {};
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
  template: (name: string) => ask<TemplateText>("GET", `templates/${as(name)}`),
  facts: (name: string) => ask<Checked>("GET", `facts/${as(name)}`),
  check: (name: string, text: string) => ask<Checked>("POST", `check/${as(name)}`, text),
  sheet: (name: string, text: string, answers: SheetAnswers) => ask<SheetRead>("POST", `sheet/${as(name)}`, JSON.stringify({ text, ...answers })),
  typical: (wanted: TypicalOrders) => ask<TypicalDrawn>("POST", "typical", JSON.stringify(wanted)),
  write: (name: string, text: string) => ask<Written>("PUT", `files/${as(name)}`, text),
  scene: (name: string, text: string) => ask<CellScene>("POST", `scene/${as(name)}`, text),
  reach: (name: string, text: string) => ask<ReachMap>("POST", `reach/${as(name)}`, text),
  move: (name: string, text: string, moves: CellMove[]) => ask<EditedText>("POST", `move/${as(name)}`, JSON.stringify({ text, moves })),
  catalogue: () => ask<Catalogue>("GET", "catalogue"),
  upload: (name: string, bytes: Blob) => ask<Written>("PUT", `files/${as(name)}`, bytes),
  putCup: (name: string, text: string, cup: string | CupSheet) =>
    ask<EditedText>("POST", `cup/${as(name)}`, JSON.stringify(typeof cup === "string" ? { text, cup } : { text, sheet: cup })),
  putArm: (name: string, text: string, arm: string, tool?: string) => ask<EditedText>("POST", `arm/${as(name)}`, JSON.stringify({ text, arm, tool })),
  removeFile: (name: string) => ask<object>("DELETE", `files/${as(name)}`),
  commands: (run: RunRequest) => ask<RunCommands>("POST", "commands", JSON.stringify(run)),
  start: (run: RunRequest) => ask<RunCommands>("POST", "runs", JSON.stringify(run)),
  stop: (name: string) => ask<object>("POST", `runs/${as(name)}/stop`),
  stopNow: (name: string) => ask<object>("POST", `runs/${as(name)}/stop-now`),
  operate: (name: string, order: string) => ask<Said>("POST", `runs/${as(name)}/operator`, JSON.stringify({ order })),
  decisions: (name: string) => ask<Decisions>("GET", `runs/${as(name)}/decisions`),
  make: (name: string, what: string) => ask<Made>("POST", `runs/${as(name)}/make`, JSON.stringify({ what })),
  removeRun: (name: string) => ask<object>("DELETE", `runs/${as(name)}`),
  fileAddress: (name: string) => `/api/1/files/${as(name)}`,
  reportAddress: (name: string) => `/api/1/runs/${as(name)}/report`,
  frames: (name: string) => new EventSource(`/api/1/runs/${as(name)}/live`),
  events: (name: string) => new EventSource(`/api/1/runs/${as(name)}/events`),
};

export const isGoingOn = (run: RunStatus): boolean => run.state === "running" || run.state === "waiting";
