// Compare: runs as columns, and the same as a CSV.

import type { RunStatus } from "./api";
import { action, make, scrollable, table } from "./dom";
import type { Shell } from "./shell";

const MOST_COLUMNS = 12; // of the table when nothing is chosen

type Row = [label: string, of: (run: RunStatus) => string];
const ROWS: Row[] = [
  ["State", (run) => run.state],
  ["Order", (run) => run.sequence],
  ["Plant", (run) => run.plant],
  ["Boxes", (run) => String(run.items)],
  ["Packed", (run) => String(run.packed)],
  ["Lost", (run) => String(run.lost)],
  ["Filling in %", (run) => run.percent.toFixed(1)],
  ["Time in s", (run) => run.time.toFixed(1)],
  ["Boxes an hour", (run) => (run.time > 0 ? ((3600 * run.packed) / run.time).toFixed(0) : "–")],
];

/** RFC 4180; a word that a spreadsheet would compute is kept a word. */
export function csvOf(runs: RunStatus[]): string {
  const cell = (word: string): string => {
    const safe = /^[=+@\t\r]|^-(?![\d.])/.test(word) ? `'${word}` : word;
    return /[",\n\r]/.test(safe) ? `"${safe.replace(/"/g, '""')}"` : safe;
  };
  const lines = [["", ...runs.map((run) => run.name)], ...ROWS.map(([label, of]) => [label, ...runs.map(of)])];
  return lines.map((line) => line.map(cell).join(",")).join("\r\n") + "\r\n";
}

export function makeCompare(shell: Shell): { element: HTMLElement; refresh(): void } {
  const choices = make("fieldset", "choices");
  const place = scrollable(make("div", "scroll"));
  const left = new Set<string>(); // out

  const chosen = (): RunStatus[] => shell.folder.runs.filter((run) => run.items > 0 && !left.has(run.name));

  function show(): void {
    const runs = chosen();
    const rows = ROWS.map(([label, of]) => [make("b", "", label), ...runs.slice(0, MOST_COLUMNS).map(of)]);
    place.replaceChildren(runs.length === 0 ? make("p", "", "There is no run to compare yet.") : table(["", ...runs.slice(0, MOST_COLUMNS).map((run) => run.name)], rows, "compare"));
    if (runs.length > MOST_COLUMNS) place.append(make("p", "", `${runs.length - MOST_COLUMNS} more are in the CSV.`));
  }

  function download(): void {
    const address = URL.createObjectURL(new Blob([csvOf(chosen())], { type: "text/csv" }));
    const link = make("a");
    link.href = address;
    link.download = "compare.csv";
    link.click();
    window.setTimeout(() => URL.revokeObjectURL(address), 10_000);
  }

  const element = make("section", "page", choices, place, make("div", "bar", action("Download CSV", download, "main")));
  return {
    element,
    refresh: () => {
      choices.replaceChildren(make("legend", "", "Runs as columns"), ...shell.folder.runs.filter((run) => run.items > 0).slice(0, 300).map((run) => {
        const box = make("input");
        box.type = "checkbox";
        box.checked = !left.has(run.name);
        box.addEventListener("change", () => {
          if (box.checked) left.delete(run.name);
          else left.add(run.name);
          show();
        });
        return make("label", "check", box, run.name);
      }));
      show();
    },
  };
}
