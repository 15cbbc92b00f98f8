// Compare: runs as columns, what they cost by figures that one enters, the worst ones to open; as CSV, workbook and page.

import { api, isGoingOn, type RunStatus } from "./api";
import { action, field, later, link, make, numberInput, scrollable, table } from "./dom";
import type { Shell } from "./shell";
import { escaped, workbook } from "./spreadsheet";

const MOST_COLUMNS = 12; // of the table when nothing is chosen
const MOST_WORST = 5;
const HOURS = 3600;

/** Cost figures, in a currency of one's own. */
export interface Costs {
  hour: number; // of the cell
  lost: number; // of a box that is lost
  left: number; // of a box that is packed by hand instead
}
export const NO_COSTS: Costs = { hour: 0, lost: 0, left: 0 };

/** Of one packed box: the cell's time, and what is lost or left on the way. */
export function costOfABox(run: RunStatus, costs: Costs): number | null {
  if (run.packed === 0 || (costs.hour === 0 && costs.lost === 0 && costs.left === 0)) return null;
  const left = Math.max(0, run.done - run.packed - run.lost);
  return (costs.hour * (run.time / HOURS) + costs.lost * run.lost + costs.left * left) / run.packed;
}

const orDash = (value: number | null, digits: number): string => (value === null || !Number.isFinite(value) ? "–" : value.toFixed(digits));
const perHour = (run: RunStatus): number | null => (run.time > 0 ? (HOURS * run.packed) / run.time : null);

type Row = [label: string, of: (run: RunStatus, costs: Costs) => string];
const ROWS: Row[] = [
  ["State", (run) => run.state],
  ["Order", (run) => run.sequence],
  ["Plant", (run) => run.plant],
  ["Boxes", (run) => String(run.items)],
  ["Packed", (run) => String(run.packed)],
  ["Lost", (run) => String(run.lost)],
  ["Filling in %", (run) => run.percent.toFixed(1)],
  ["Time in s", (run) => run.time.toFixed(1)],
  ["Boxes an hour", (run) => orDash(perHour(run), 0)],
  ["Cost of a packed box", (run, costs) => orDash(costOfABox(run, costs), 3)],
];

export function rowsOf(runs: RunStatus[], costs: Costs = NO_COSTS): string[][] {
  return [["", ...runs.map((run) => run.name)], ...ROWS.map(([label, of]) => [label, ...runs.map((run) => of(run, costs))])];
}

/** RFC 4180; a word that a spreadsheet would compute is kept a word. */
export function csvOf(runs: RunStatus[], costs: Costs = NO_COSTS): string {
  const cell = (word: string): string => {
    const safe = /^[=+@\t\r]|^-(?![\d.])/.test(word) ? `'${word}` : word;
    return /[",\n\r]/.test(safe) ? `"${safe.replace(/"/g, '""')}"` : safe;
  };
  return rowsOf(runs, costs).map((line) => line.map(cell).join(",")).join("\r\n") + "\r\n";
}

/** Of runs that are over: those that lost most, then those that filled least. */
export function worstOf(runs: RunStatus[]): RunStatus[] {
  return runs.filter((run) => !isGoingOn(run)).sort((a, b) => b.lost - a.lost || a.percent - b.percent || a.name.localeCompare(b.name)).slice(0, MOST_WORST);
}

export interface Spread {
  label: string;
  values: number[];
  unit: string;
}
export function spreadsOf(runs: RunStatus[]): Spread[] {
  const over = runs.filter((run) => !isGoingOn(run) && run.items > 0);
  return [
    { label: "Filling", values: over.map((run) => run.percent), unit: "%" },
    { label: "Boxes an hour", values: over.map((run) => perHour(run)).filter((x): x is number => x !== null), unit: "" },
    { label: "Lost boxes", values: over.map((run) => run.lost), unit: "" },
  ].filter(({ values }) => values.length > 0);
}

/** "mean 62.1, 55.0 to 70.2 (12 runs)". */
export function describeSpread({ values, unit }: Spread): string {
  const mean = values.reduce((sum, x) => sum + x, 0) / values.length;
  const tail = unit ? ` ${unit}` : "";
  return `mean ${mean.toFixed(1)}${tail}, ${Math.min(...values).toFixed(1)} to ${Math.max(...values).toFixed(1)}${tail} (${values.length} ${values.length === 1 ? "run" : "runs"})`;
}

/** A point for each run on a line, as text of SVG. */
function strip({ label, values, unit }: Spread): string {
  const low = Math.min(...values), high = Math.max(...values);
  const x = (value: number): number => (high > low ? 10 + (280 * (value - low)) / (high - low) : 150);
  const points = values.map((value) => `<circle cx="${x(value).toFixed(1)}" cy="20" r="5"/>`).join("");
  return `<svg class="strip" viewBox="0 0 300 52" width="300" role="img" aria-label="${escaped(`${label}: ${describeSpread({ label, values, unit })}`)}"><line x1="10" x2="290" y1="20" y2="20"/>${points}<text x="${high > low ? 10 : 150}" y="46" text-anchor="${high > low ? "start" : "middle"}">${low.toFixed(1)}</text>${high > low ? `<text x="290" y="46" text-anchor="end">${high.toFixed(1)}</text>` : ""}</svg>`;
}

/** One self-contained page. */
export function pageOf(runs: RunStatus[], costs: Costs, title: string): string {
  const rows = rowsOf(runs, costs);
  const cells = (row: string[], tag: string): string => `<tr>${row.map((word, k) => `<${k === 0 ? "th" : tag}>${escaped(word)}</${k === 0 ? "th" : tag}>`).join("")}</tr>`;
  const used = costs.hour || costs.lost || costs.left ? `<p>Cost figures: ${costs.hour} an hour of the cell, ${costs.lost} of a lost box, ${costs.left} of a box that is packed by hand.</p>` : "";
  return `<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'"><title>${escaped(title)}</title>
<style>body{font:15px/1.45 sans-serif;margin:24px;color:#1c242b}table{border-collapse:collapse}th,td{border:1px solid #c9d1d8;padding:3px 9px;text-align:left}.strip line{stroke:#8a9299}.strip circle{fill:#0b62c4;fill-opacity:.5}.strip text{font-size:13px;fill:#4f5b66}pre{white-space:pre-wrap}</style></head>
<body><h1>${escaped(title)}</h1><table><thead>${cells(rows[0]!, "th")}</thead><tbody>${rows.slice(1).map((row) => cells(row, "td")).join("")}</tbody></table>${used}
${spreadsOf(runs).map((one) => `<h2>${escaped(one.label)}</h2><p>${escaped(describeSpread(one))}</p>${strip(one)}`).join("\n")}
<h2>Commands</h2><pre>${escaped(runs.map((run) => run.command).filter(Boolean).join("\n"))}</pre></body></html>
`;
}

export function makeCompare(shell: Shell): { element: HTMLElement; refresh(): void } {
  const choices = make("fieldset", "choices");
  const place = scrollable(make("div", "scroll"));
  const spreads = make("div", "spreads");
  const worst = make("div", "worst");
  const left = new Set<string>(); // out
  const hour = numberInput("", 0, 1e6, "any"), lost = numberInput("", 0, 1e6, "any"), byHand = numberInput("", 0, 1e6, "any");
  const figure = (input: HTMLInputElement): number => (input.valueAsNumber >= 0 ? input.valueAsNumber : 0);
  const costs = (): Costs => ({ hour: figure(hour), lost: figure(lost), left: figure(byHand) });

  const chosen = (): RunStatus[] => shell.folder.runs.filter((run) => run.items > 0 && !left.has(run.name));

  function show(): void {
    const runs = chosen();
    const shown = runs.slice(0, MOST_COLUMNS);
    const rows = rowsOf(shown, costs()).slice(1).map(([label, ...words]) => [make("b", "", label), ...words]);
    place.replaceChildren(runs.length === 0 ? make("p", "", "There is no run to compare yet.") : table(["", ...shown.map((run) => run.name)], rows, "compare"));
    if (runs.length > MOST_COLUMNS) place.append(make("p", "", `${runs.length - MOST_COLUMNS} more are in the files.`));
    spreads.replaceChildren(...spreadsOf(runs).map((one) => {
      const drawn = make("figure", "", make("figcaption", "", make("b", "", one.label), `: ${describeSpread(one)}`));
      drawn.append(new DOMParser().parseFromString(strip(one).replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" '), "image/svg+xml").documentElement);
      return drawn;
    }));
    const cases = worstOf(runs);
    worst.replaceChildren(...cases.map((run) => make("p", "", make("b", "", run.name), `: ${run.percent.toFixed(1)} % full, ${run.packed} of ${run.items} packed, ${run.lost} lost `,
      ...(run.files.includes(`${run.name}.h5`) ? [link("Open in the viewer", api.reportAddress(run.name))] : []))));
    if (cases.length > 0) worst.prepend(make("h2", "", "Worst cases"));
  }

  function download(bytes: BlobPart, type: string, file: string): void {
    const address = URL.createObjectURL(new Blob([bytes], { type }));
    const anchor = make("a");
    anchor.href = address;
    anchor.download = file;
    anchor.click();
    window.setTimeout(() => URL.revokeObjectURL(address), 10_000);
  }

  const changed = later(200, show);
  for (const input of [hour, lost, byHand]) input.addEventListener("input", changed);
  const element = make("section", "page", choices,
    make("fieldset", "numbers", make("legend", "", "Cost figures, in a currency of yours"),
      field("An hour of the cell", hour), field("A lost box", lost), field("A box that is packed by hand instead", byHand)),
    place,
    make("div", "bar",
      action("Download CSV", () => download(csvOf(chosen(), costs()), "text/csv", "compare.csv"), "main"),
      action("Download workbook (.xlsx)", () => download(workbook(rowsOf(chosen(), costs()), "compare") as BlobPart, "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet", "compare.xlsx")),
      action("Download page (.html)", () => download(pageOf(chosen(), costs(), `Runs of ${shell.folder.folder}`), "text/html", "compare.html"))),
    spreads, worst);
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
