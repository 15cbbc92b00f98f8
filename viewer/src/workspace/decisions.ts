// Decisions: a run step by step: what was tried for each box and why it lost, predicted beside what happened, the plan beside
// what is perceived; and the lines by which who operates steps in.

import { api, isGoingOn, type Decision, type Decisions, type RunStatus } from "./api";
import { action, field, make, scrollable, setChoices, table } from "./dom";
import { drawPlan } from "./plan_drawing";
import { PlanStage } from "./plan_stage";
import type { Shell } from "./shell";

/** An id as a word of `snug pack --operator`. */
export function quoted(id: string): string {
  const isPlain = id !== "" && id !== "next" && !/^[#"]|[ \t\r]/.test(id);
  return isPlain ? id : `"${id.replace(/["\\]/g, "\\$&")}"`;
}

const at = (position: [number, number, number] | null | undefined): string => (position ? position.map((x) => x.toFixed(0)).join(", ") : "–");
const number = (value: number | null | undefined, digits: number): string => (value === null || value === undefined ? "–" : value.toFixed(digits));

/** Predicted beside what happened, as rows of a table. */
export function outcomeRows(one: Decision): string[][] {
  const { planned, predicted, happened } = one;
  return [
    ["Place in mm (x, y, z)", at(planned?.position_mm), at(happened?.position_mm)],
    ["Success", planned ? `${(100 * planned.predicted_success).toFixed(0)} % expected` : "–", one.end || "–"],
    ["Largest force in N", planned && planned.samples > 0 ? number(predicted?.force_N, 0) : "–", number(happened?.force_N, 0)],
    ["Largest torque in Nm", planned && planned.samples > 0 ? number(predicted?.torque_Nm, 1) : "–", number(happened?.torque_Nm, 1)],
    ["Others moved by, mm", planned && planned.samples > 0 ? number(predicted?.displacement_mm, 1) : "–", number(happened?.displacement_mm, 1)],
    ["Off its place by, mm", "0", number(happened?.position_error_mm, 1)],
    ["Turned by, degrees", "0", number(happened?.angle_error_deg, 1)],
  ];
}

const TRIED = ["best", "less utility", "too rarely", "failed"]; // verdicts of what was rehearsed
const BETWEEN_LOOKS = 700; // ms, at decisions of a run that is held

export class DecisionView {
  readonly element = make("section", "decisions");
  private readonly which_ = make("select");
  private readonly place_ = make("div");
  private readonly stage_ = new PlanStage();
  /** What may be said to a run that goes on: beside its Stop. */
  readonly operator = make("fieldset", "operator");
  private readonly takeOut_ = make("select");
  private readonly said_ = make("p", "hint");
  private run_: RunStatus | null = null;
  private shown_: Decisions | null = null;
  private size_: [number, number, number] | null = null;
  private sizeOf_ = "";
  private isFollowing_ = true; // the last decision is shown
  private known_ = "";
  private timer_ = 0;

  constructor(private readonly shell_: Shell) {
    const step = (by: number) => (): void => {
      this.which_.selectedIndex = Math.max(0, Math.min(this.which_.options.length - 1, this.which_.selectedIndex + by));
      this.choose();
    };
    this.which_.addEventListener("change", () => this.choose());
    this.said_.setAttribute("role", "status");
    this.operator.hidden = true;
    this.element.append(make("h2", "", "Decisions"),
      make("div", "bar", action("Previous decision", step(-1)), field("Decision", this.which_), action("Next decision", step(1))), this.stage_.element, this.place_);
    this.element.hidden = true;
  }

  /** Shows this run; asks for what is new. */
  async follow(run: RunStatus): Promise<void> {
    if (run.name !== this.run_?.name) {
      this.shown_ = null;
      this.isFollowing_ = true;
      this.known_ = "";
      this.said_.textContent = "";
    }
    this.run_ = run;
    const known = [run.name, run.state, run.done, run.now, run.held].join("\n");
    if (known === this.known_) return;
    this.known_ = known;
    this.showOperator();
    try {
      const found = await api.decisions(run.name);
      if (this.run_.name !== run.name) return;
      this.shown_ = found;
    } catch {
      this.known_ = ""; // it has no log yet
      return;
    }
    await this.loadSize(run);
    this.element.hidden = this.shown_.decisions.length === 0;
    // What is said to a run that is held changes its decisions, not its progress.
    window.clearTimeout(this.timer_);
    if (isGoingOn(run) && run.held) {
      this.timer_ = window.setTimeout(() => {
        this.known_ = "";
        void this.follow(this.run_!);
      }, BETWEEN_LOOKS);
    }
    const before = this.which_.selectedIndex;
    const last = this.shown_.decisions.length - 1;
    setChoices(this.which_, this.shown_.decisions.map((one, k): [string, string] => [String(k), `${k + 1}: ${one.item}, ${one.end || one.outcome}`]));
    this.which_.selectedIndex = this.isFollowing_ ? last : Math.min(before, last);
    this.showOperator();
    this.show();
  }

  private async loadSize(run: RunStatus): Promise<void> {
    const scenario = /^snug pack (\S+)/.exec(run.command)?.[1] ?? "";
    if (scenario === this.sizeOf_) return;
    this.sizeOf_ = scenario;
    try {
      const { facts } = await api.facts(scenario);
      this.size_ = facts?.containers?.find(({ name }) => name === facts.target)?.inner_size_mm ?? null;
    } catch {
      this.size_ = null;
    }
  }

  private choose(): void {
    this.isFollowing_ = this.which_.selectedIndex === this.which_.options.length - 1;
    this.show();
  }

  private async say(order: string): Promise<void> {
    const done = await this.shell_.attempt(() => api.operate(this.run_!.name, order));
    if (done) this.said_.textContent = `Sent. As a command in the folder: ${done.command}`;
  }

  /** What may be said now. */
  private showOperator(): void {
    const run = this.run_!;
    this.operator.hidden = !isGoingOn(run);
    if (this.operator.hidden) return;
    const isHeld = run.held !== "";
    const who = isHeld ? quoted(run.held) : "next";
    const packed = (run.boxes ?? []).filter((box) => box.packed).map((box): [string, string] => [box.id, box.id]);
    setChoices(this.takeOut_, packed);
    const buttons = isHeld
      ? [action("Go on", () => this.say(`${who} go`), "main"), action("Another place", () => this.say(`${who} elsewhere`)), action("Skip this box", () => this.say(`${who} skip`))]
      : [action("Hold the next box", () => this.say("next hold"), "main"), action("Next box elsewhere", () => this.say("next elsewhere")), action("Skip the next box", () => this.say("next skip"))];
    const out = packed.length > 0
      ? [field("Packed box", this.takeOut_), action("Take it out", () => this.say(`next take-out ${quoted(this.takeOut_.value)}`))]
      : [];
    const focused = this.operator.contains(document.activeElement) ? document.activeElement!.textContent : null;
    this.operator.replaceChildren(make("legend", "", "Step in"),
      make("p", "", isHeld ? `${run.held} is planned and waits for your order.` : "The run continues by itself and follows your order at the next box."),
      make("div", "bar", ...buttons, ...out), this.said_);
    if (focused) [...this.operator.querySelectorAll("button")].find((one) => one.textContent === focused)?.focus();
  }

  private show(): void {
    const one = this.shown_?.decisions[this.which_.selectedIndex];
    if (!one) return this.place_.replaceChildren(make("p", "", "Nothing was decided yet."));
    const run = this.run_!;
    // Another program's cell leaves no recording here: it is drawn as it is believed to be.
    if (/ --plant /.test(run.command)) this.stage_.show(this.sizeOf_, this.shown_!, this.which_.selectedIndex).catch(() => this.stage_.hide());
    else this.stage_.hide();
    const isHeld = isGoingOn(run) && run.held === one.item;
    const rows = one.candidates.map((candidate, k) => [
      String(k + 1), at(candidate.position_mm), TRIED.includes(candidate.verdict) ? candidate.insertion : "–", number(candidate.expected_percent, 1), number(candidate.cost, 1), number(candidate.utility, 1),
      candidate.samples > 0 ? `${(100 * candidate.success_rate).toFixed(0)} %` : "–",
      make("span", "", candidate.verdict + (candidate.reason ? `: ${candidate.reason}` : "")),
      ...(isHeld ? [action("Choose", () => this.say(`${quoted(one.item)} place ${k + 1}`))] : []),
    ]);
    const head = ["No.", "Place in mm", "Insertion", "Expected %", "Cost %", "Utility %", "Samples", "Verdict", ...(isHeld ? ["Choice"] : [])];
    const words: Node[] = [];
    for (const trouble of one.troubles) words.push(make("p", "bad", `At ${trouble.time.toFixed(1)} s ${trouble.trouble}: ${trouble.remedy}${trouble.detail ? ` (${trouble.detail})` : ""}`));
    // What was said of the box before it was planned anew, too: that is why it was.
    const before = this.shown_!.decisions.slice(0, this.which_.selectedIndex + 1).filter(({ item }) => item === one.item);
    for (const said of before.flatMap(({ operator }) => operator)) words.push(make("p", "", `At ${said.time.toFixed(1)} s the operator: ${said.order}${said.was_followed ? "" : ", not followed"}${said.text ? `: ${said.text}` : ""}`));
    const more = one.candidates_in_all - one.candidates.length;
    this.place_.replaceChildren(
      make("p", "", make("b", "", one.item), ` at ${one.time.toFixed(1)} s: ${one.outcome}${one.reason ? `: ${one.reason}` : ""}; planned in ${one.planning_seconds.toFixed(1)} s.${one.end_reason ? ` ${one.end}: ${one.end_reason}.` : ""}`),
      ...words,
      make("div", "outcome", table(["", "Planned, predicted", "What happened"], outcomeRows(one), "compare"), drawPlan(this.shown_!.decisions.slice(0, this.which_.selectedIndex + 1), this.size_)),
      make("h3", "", `Candidates (${one.candidates_in_all})`),
      scrollable(make("div", "scroll", table(head, rows, "rows"))));
    if (more > 0) this.place_.append(make("p", "hint", `${more} more are in the log.`));
  }
}
