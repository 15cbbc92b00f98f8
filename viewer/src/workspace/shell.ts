// Shell: what the tabs share: the list of the folder, messages, and what was saved last.

import { api, isGoingOn, Refused, type Checked, type FolderList } from "./api";
import { choiceOf } from "./ask";
import { make } from "./dom";

const BETWEEN_LOOKS = 1500; // ms, while a run goes on or the program does not answer

export class Shell {
  folder: FolderList = { folder: "", version: "", can_be_written: true, scenarios: [], items: [], arms: [], runs: [], templates: [] };
  chosen: { scenario?: string; items?: string } = {};
  readonly message = make("p", "message");
  readonly trouble = make("p", "trouble");
  onChange: () => void = () => undefined;
  private timer = 0;
  /** Texts of files as this page read or wrote them last. */
  private readonly known = new Map<string, string>();

  constructor() {
    this.message.setAttribute("role", "status");
    this.trouble.setAttribute("role", "alert");
    this.trouble.hidden = true;
  }

  tell(text: string, isBad = false): void {
    this.message.textContent = text;
    this.message.className = isBad ? "message bad" : "message";
  }

  /** What went wrong, for people. */
  say(error: unknown): string {
    if (error instanceof Refused) return error.message;
    this.look(1000);
    return "The program does not answer.";
  }

  remember(what: { scenario?: string; items?: string }): void {
    this.chosen = { ...this.chosen, ...what };
  }

  /** The text of a file that is opened. */
  async open(name: string): Promise<Checked> {
    const checked = await api.facts(name);
    this.known.set(name, checked.text);
    return checked;
  }

  /** Writes a file; asks first where there is one that this page does not know. False: it stays as it is. */
  async write(name: string, text: string): Promise<boolean> {
    const { can_be_written, scenarios, items } = await api.folder();
    const there = can_be_written && [...scenarios, ...items].some((one) => one.name === name) ? (await api.facts(name)).text : text;
    if (there !== text && there !== this.known.get(name)) {
      const said = await choiceOf(`The folder has another ${name}, which was not written here. Save over it?`, [["yes", "Save over it"]]);
      if (said === null) return false;
    }
    await api.write(name, text);
    this.known.set(name, text);
    return true;
  }

  async attempt<T>(call: () => Promise<T>): Promise<T | undefined> {
    try {
      return await call();
    } catch (error) {
      this.tell(this.say(error), true);
      return undefined;
    }
  }

  async refresh(): Promise<void> {
    try {
      this.folder = await api.folder();
      this.trouble.hidden = true;
      this.onChange();
      if (this.folder.runs.some((run) => isGoingOn(run) || run.state === "being read")) this.look(BETWEEN_LOOKS);
    } catch (error) {
      const isOther = error instanceof Refused && error.status === 403;
      this.trouble.textContent = isOther
        ? "The program was started again: open the address that it printed."
        : error instanceof Refused ? error.message : "The program does not answer. Is it still running? Start snug ui again in this folder: nothing that was saved is lost, runs that were begun can be resumed.";
      this.trouble.hidden = false;
      this.look(BETWEEN_LOOKS);
    }
  }

  private look(wait: number): void {
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.refresh(), wait);
  }
}
