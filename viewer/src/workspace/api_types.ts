// Requests and answers of `snug ui` (docs/ui-interface.md) as types.
// Written by the test ApiForms.AreWhatThePageReads; the forms stand in src/snug/workspace/api_forms.cpp.

/** What is wrong with a text. */
export interface Mistake {
  where: string;
  line: number | null;
  key: string;
  got: string;
  expected: string;
  text: string; // all of it, for people
}

/** What the program says no with. */
export interface Refusal {
  error: string;
  mistake?: Mistake;
}

/** A line of items. */
export interface ItemLine {
  line: number;
  order: string;
  article: string;
  size_mm: [number, number, number];
  mass_kg: number;
  count: number;
}

export interface ContainerFacts {
  name: string;
  inner_size_mm: [number, number, number];
  walls: boolean;
}

/** Of a scenario (containers, target, cup), of items (lines) or of an arm (robot, links). */
export interface Facts {
  sequences?: string[];
  lines?: ItemLine[];
  containers?: ContainerFacts[];
  target?: string;
  cup_radius_mm?: number;
  robot?: string;
  links?: string[]; // that can carry the tool
}

export interface Checked {
  text: string;
  mistake: Mistake | null;
  mistakes?: Mistake[]; // of items: one of each line that has any, the first ones
  facts: Facts | null;
}

export interface Written {
  name: string;
  facts: Facts;
}

/** Answers to what a sheet leaves open: mm, cm, m or in; kg, g or lb; point or comma. */
export interface SheetAnswers {
  length?: string;
  mass?: string;
  decimal?: string;
}

export interface SheetChoice {
  answer: string;
  meaning: string; // for the first box
}

export interface SheetQuestion {
  about: string; // a member of SheetAnswers
  choices: SheetChoice[];
}

export interface SheetColumn {
  heading: string;
  column: string; // empty: passed over
}

export interface TypicalOrders {
  orders: number;
  boxes: number; // of an order, on average
  seed: number;
}

export interface TypicalDrawn {
  orders: string; // a CSV
  command: string;
}

export interface SheetRead {
  orders: string; // empty with questions
  columns: SheetColumn[];
  questions: SheetQuestion[];
  command: string;
}

export interface TemplateArm {
  name: string;
  text: string;
}

/** A scenario to begin with. */
export interface TemplateText {
  text: string;
  arm: TemplateArm | null;
}

/** A part of a cell that can be moved. */
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

export interface EditedText {
  text: string;
  links?: string[]; // of an arm
  tool?: string;
  command?: string; // of a cup
  pull_off_N?: [number, number, number]; // of a cup: low, expected, high
}

export interface CupSheet {
  diameter_mm: number;
  bellows: number; // folds: 0, 1.5 or 2.5
  material: string;
  lip: string;
  vacuum_kPa: number; // gauge, negative
  stroke_mm?: number | null;
}

export interface ReachLayer {
  name: string;
  height: number;
  verdicts: number[];
  whats: number[];
}

export interface ReachPick {
  item: string;
  count: number;
  position: [number, number, number];
  verdict: number;
  what: number;
}

/** Where over the container and at the picks the tool can stand; metres. */
export interface ReachMap {
  robot: string;
  container: string;
  pose: [number, number, number, number, number, number, number]; // x, y, z, qw, qx, qy, qz
  inner_size: [number, number, number];
  columns: number;
  rows: number;
  tool_yaw: number;
  verdicts: string[];
  whats: string[];
  counts: Record<string, number>;
  layers: ReachLayer[];
  picks: ReachPick[];
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
  percent: number; // of the container's volume
  time: number; // s, of the plant
  stopped: string;
  files: string[];
  now: string; // item under way
  held: string; // item at which the run waits for the operator
  boxes?: BoxEnd[]; // not in the list of the folder
}

export interface FolderFile {
  name: string;
  bytes: number;
}

export interface TemplateName {
  name: string;
  description: string;
}

export interface FolderList {
  folder: string;
  version: string;
  can_be_written: boolean; // if false, nothing can be saved or run
  scenarios: FolderFile[];
  items: FolderFile[];
  arms: FolderFile[];
  runs: RunStatus[];
  templates: TemplateName[];
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
  holds?: boolean; // the run waits for the operator at the first box
}

export interface RunCommand {
  name: string;
  command: string;
}

export interface RunCommands {
  runs: RunCommand[];
}

export interface CatalogueContainer {
  name: string;
  pallet: boolean;
  inner_size_mm: [number, number, number];
  source: string;
}

export interface CatalogueCup {
  key: string;
  diameter_mm: number;
  bellows: number;
  lip: string;
  pull_off_N: [number, number, number]; // low, expected, high
  command: string;
}

export interface Catalogue {
  containers: CatalogueContainer[];
  cups: CatalogueCup[];
}

/** A place that was tried. */
export interface Candidate {
  position_mm: [number, number, number];
  verdict: string;
  insertion: string;
  expected_percent: number;
  cost: number | null;
  utility: number | null;
  samples: number;
  success_rate: number;
  failure: string;
  reason: string;
}

export interface PlannedPlace {
  position_mm: [number, number, number];
  insertion: string;
  reorientation: string;
  predicted_success: number;
  samples: number;
}

export interface Forces {
  force_N: number;
  torque_Nm: number;
  displacement_mm: number | null;
}

export interface Happened {
  force_N: number;
  torque_Nm: number;
  position_mm: [number, number, number] | null;
  position_error_mm: number | null;
  angle_error_deg: number | null;
  displacement_mm: number | null;
}

export interface Trouble {
  time: number;
  trouble: string;
  remedy: string;
  detail: string;
}

export interface OperatorOrder {
  time: number;
  order: string;
  was_followed: boolean;
  text: string;
}

/** One decision on one item: what was tried, what was expected, what came of it. Positions are in the container's frame. */
export interface Decision {
  item: string;
  time: number;
  outcome: string;
  reason: string;
  planning_seconds: number;
  waited_seconds: number;
  candidates: Candidate[];
  candidates_in_all: number;
  extent_mm: [number, number, number] | null;
  planned?: PlannedPlace;
  predicted?: Forces;
  happened: Happened | null;
  end: string;
  end_reason: string;
  troubles: Trouble[];
  operator: OperatorOrder[];
}

export interface StandingBox {
  item: string;
  position_mm: [number, number, number];
  extent_mm: [number, number, number];
}

export interface Decisions {
  items: string[];
  decisions: Decision[];
  standing: StandingBox[];
  held: string;
  now: string;
}

export interface Made {
  made: string;
  command: string;
}

export interface Said {
  said: string;
  command: string;
}
