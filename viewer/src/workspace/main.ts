// The page of `snug ui`: items, cell, run, compare, take away; each a tab, each thing in it also a command.

import "./workspace.css";
import { makeCell } from "./cell";
import { makeCompare } from "./compare";
import { action, make } from "./dom";
import { makeItems } from "./items";
import { makeRun } from "./run";
import { Shell } from "./shell";
import { makeTakeAway } from "./take_away";

const shell = new Shell();
const tabs = [
  { name: "Items", made: makeItems(shell) },
  { name: "Cell", made: makeCell(shell) },
  { name: "Run", made: makeRun(shell) },
  { name: "Compare", made: makeCompare(shell) },
  { name: "Take away", made: makeTakeAway(shell) },
];

const slug = (name: string): string => name.toLowerCase().replace(" ", "-");
const buttons = tabs.map((tab, k) => {
  const button = action(tab.name, () => choose(k));
  button.setAttribute("role", "tab");
  button.id = `tab-${slug(tab.name)}`;
  tab.made.element.setAttribute("role", "tabpanel");
  tab.made.element.setAttribute("aria-labelledby", button.id);
  return button;
});

function choose(which: number): void {
  tabs.forEach((tab, k) => {
    tab.made.element.hidden = k !== which;
    buttons[k]!.setAttribute("aria-selected", String(k === which));
    buttons[k]!.tabIndex = k === which ? 0 : -1;
  });
  shell.tell("");
  history.replaceState(null, "", `/#${slug(tabs[which]!.name)}`); // the token is in the cookie now
}

const bar = make("div", "tabs", ...buttons);
bar.setAttribute("role", "tablist");
bar.setAttribute("aria-label", "Parts of the work");
bar.addEventListener("keydown", (event) => {
  const by = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
  if (!by) return;
  const next = (buttons.findIndex((one) => one === document.activeElement) + by + tabs.length) % tabs.length;
  choose(next);
  buttons[next]!.focus();
});

const place = make("span", "folder");
const readOnly = make("p", "trouble", "This folder can only be read: cells, items and runs can be looked at and reports opened, but nothing can be saved or run. For that, copy it and open the copy: snug ui FOLDER");
readOnly.setAttribute("role", "status");
readOnly.hidden = true;
shell.onChange = () => {
  place.textContent = shell.folder.folder;
  readOnly.hidden = shell.folder.can_be_written;
  place.title = `${shell.folder.folder}, served by snug ${shell.folder.version}`;
  for (const tab of tabs) tab.made.refresh();
};
document.getElementById("app")!.append(
  make("header", "", make("h1", "", "snug"), place, bar), make("main", "", shell.trouble, readOnly, shell.message, ...tabs.map((tab) => tab.made.element)));
choose(Math.max(0, tabs.findIndex((tab) => location.hash === `#${slug(tab.name)}`)));
void shell.refresh().then(() => ((window as unknown as { snugReady: boolean }).snugReady = true));
