// Compare: runs as columns, what they cost by figures that one enters, the worst ones to open; as CSV, workbook and page.

import { api, isGoingOn, type RunStatus } from "./api";
import { action, field, later, link, make, numberInput, scrollable, setChoices, table } from "./dom";
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

const sum = (runs: RunStatus[], of: (run: RunStatus) => number): number => runs.reduce((total, run) => total + of(run), 0);

/** Of one packed box: the cell's time, and what is lost or left on the way. */
export function costOfABox(runs: RunStatus[], costs: Costs): number | null {
  const packed = sum(runs, (run) => run.packed);
  if (packed === 0 || (costs.hour === 0 && costs.lost === 0 && costs.left === 0)) return null;
  const left = sum(runs, (run) => Math.max(0, run.done - run.packed - run.lost));
  return (costs.hour * (sum(runs, (run) => run.time) / HOURS) + costs.lost * sum(runs, (run) => run.lost) + costs.left * left) / packed;
}

const orDash = (value: number | null, digits: number): string => (value === null || !Number.isFinite(value) ? "–" : value.toFixed(digits));
const perHour = (...runs: RunStatus[]): number | null => (sum(runs, (run) => run.time) > 0 ? (HOURS * sum(runs, (run) => run.packed)) / sum(runs, (run) => run.time) : null);
const mean = (runs: RunStatus[], of: (run: RunStatus) => number): number | null => (runs.length > 0 ? sum(runs, of) / runs.length : null);

/** The different words, the first few of them. */
function words(runs: RunStatus[], of: (run: RunStatus) => string): string {
  const all = [...new Set(runs.map(of))];
  return all.slice(0, 3).join("; ") + (all.length > 3 ? ` and ${all.length - 3} more` : "");
}

/** What a run was packed with, by its command. */
function optionOf(run: RunStatus, option: string): string {
  const found = new RegExp(` ${option} (?:'([^']*)'|(\\S+))`).exec(run.command);
  return found?.[1] ?? found?.[2] ?? "";
}
const cellOf = (run: RunStatus): string => /^snug pack (\S+)/.exec(run.command)?.[1] ?? "–";
const tempoOf = (run: RunStatus): string => optionOf(run, "--tempo") || "1";

/** A column of the table: one run, or all of one variant. */
export interface Variant {
  name: string;
  runs: RunStatus[];
}

/** Runs of the same cell, items and tempo, whatever their orders and plants. */
export function variantsOf(runs: RunStatus[]): Variant[] {
  const found = new Map<string, RunStatus[]>();
  for (const run of runs.filter((one) => one.state === "done" || one.state === "failed")) {
    const name = [cellOf(run), optionOf(run, "--items"), optionOf(run, "--plant"), optionOf(run, "--tempo") && `tempo ${tempoOf(run)}`].filter(Boolean).join(", ");
    found.set(name, [...(found.get(name) ?? []), run]);
  }
  return [...found].map(([name, members]) => ({ name, runs: members }));
}

/** Whether all columns packed the same orders in the same plants: else their numbers say little about the variants. */
export function isFair(variants: Variant[]): boolean {
  const tasks = variants.map(({ runs }) => runs.map((run) => `${run.sequence}\n${run.plant}`).sort().join("\n\n"));
  return tasks.every((one) => one === tasks[0]);
}

type Row = [label: string, of: (runs: RunStatus[], costs: Costs) => string];
const ROWS: Row[] = [
  ["State", (runs) => words(runs, (run) => run.state)],
  ["Cell", (runs) => words(runs, cellOf)],
  ["Tempo", (runs) => words(runs, tempoOf)],
  ["Order", (runs) => words(runs, (run) => run.sequence)],
  ["Plant", (runs) => words(runs, (run) => run.plant)],
  ["Boxes", (runs) => String(sum(runs, (run) => run.items))],
  ["Packed", (runs) => String(sum(runs, (run) => run.packed))],
  ["Lost", (runs) => String(sum(runs, (run) => run.lost))],
  ["Filling in %", (runs) => orDash(mean(runs, (run) => run.percent), 1)],
  ["Time in s", (runs) => orDash(mean(runs, (run) => run.time), 1)],
  ["Boxes an hour", (runs) => orDash(perHour(...runs), 0)],
  ["Cost of a packed box", (runs, costs) => orDash(costOfABox(runs, costs), 3)],
];
const OF_VARIANTS: Row[] = [
  ["Runs", (runs) => String(runs.length)],
  ["Least filling in %", (runs) => orDash(runs.length > 0 ? Math.min(...runs.map((run) => run.percent)) : null, 1)],
];

/** The table with its head; `isGrouped`: variants as columns. */
export function rowsOf(runs: RunStatus[], costs: Costs = NO_COSTS, isGrouped = false): string[][] {
  const columns = isGrouped ? variantsOf(runs) : runs.map((run) => ({ name: run.name, runs: [run] }));
  const rows = isGrouped ? [...OF_VARIANTS.slice(0, 1), ...ROWS, ...OF_VARIANTS.slice(1)] : ROWS;
  return [["", ...columns.map(({ name }) => name)], ...rows.map(([label, of]) => [label, ...columns.map((one) => of(one.runs, costs))])];
}

/** RFC 4180; a word that a spreadsheet would compute is kept a word. */
export function csvOf(runs: RunStatus[], costs: Costs = NO_COSTS, isGrouped = false): string {
  const cell = (word: string): string => {
    const safe = /^[=+@\t\r]|^-(?![\d.])/.test(word) ? `'${word}` : word;
    return /[",\n\r]/.test(safe) ? `"${safe.replace(/"/g, '""')}"` : safe;
  };
  return rowsOf(runs, costs, isGrouped).map((line) => line.map(cell).join(",")).join("\r\n") + "\r\n";
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
  const middle = values.reduce((total, x) => total + x, 0) / values.length;
  const tail = unit ? ` ${unit}` : "";
  return `mean ${middle.toFixed(1)}${tail}, ${Math.min(...values).toFixed(1)} to ${Math.max(...values).toFixed(1)}${tail} (${values.length} ${values.length === 1 ? "run" : "runs"})`;
}

/** A point for each run on a line, as text of SVG; `all`: of all lines that are compared. */
function strip({ label, values, unit }: Spread, all: number[] = values): string {
  const low = Math.min(...all), high = Math.max(...all);
  const x = (value: number): number => (high > low ? 10 + (280 * (value - low)) / (high - low) : 150);
  const points = values.map((value) => `<circle cx="${x(value).toFixed(1)}" cy="20" r="5"/>`).join("");
  return `<svg class="strip" viewBox="0 0 300 52" width="300" role="img" aria-label="${escaped(`${label}: ${describeSpread({ label, values, unit })}`)}"><line x1="10" x2="290" y1="20" y2="20"/>${points}<text x="${high > low ? 10 : 150}" y="46" text-anchor="${high > low ? "start" : "middle"}">${low.toFixed(1)}</text>${high > low ? `<text x="290" y="46" text-anchor="end">${high.toFixed(1)}</text>` : ""}</svg>`;
}

/** Each spread with a strip for each variant, on one scale. */
export function stripsOf(runs: RunStatus[], isGrouped: boolean): { label: string; strips: { name: string; text: string; svg: string }[] }[] {
  const groups = isGrouped ? variantsOf(runs) : [{ name: "", runs }];
  const parts = groups.map((group) => ({ name: group.name, spreads: spreadsOf(group.runs) }));
  return spreadsOf(runs).map(({ label, values }) => ({
    label,
    strips: parts.flatMap(({ name, spreads }) => spreads.filter((one) => one.label === label).map((one) => ({ name, text: describeSpread(one), svg: strip(one, values) }))),
  }));
}

/** One self-contained page. */
export function pageOf(runs: RunStatus[], costs: Costs, title: string, isGrouped = false): string {
  const rows = rowsOf(runs, costs, isGrouped);
  const cells = (row: string[], tag: string): string => `<tr>${row.map((word, k) => `<${k === 0 ? "th" : tag}>${escaped(word)}</${k === 0 ? "th" : tag}>`).join("")}</tr>`;
  const used = costs.hour || costs.lost || costs.left ? `<p>Cost figures: ${costs.hour} an hour of the cell, ${costs.lost} of a lost box, ${costs.left} of a box that is packed by hand.</p>` : "";
  return `<!doctype html>
<html lang="en"><head><meta charset="utf-8"><meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'"><title>${escaped(title)}</title>
<style>body{font:15px/1.45 sans-serif;margin:24px;color:#1c242b}table{border-collapse:collapse}th,td{border:1px solid #c9d1d8;padding:3px 9px;text-align:left}.strip line{stroke:#8a9299}.strip circle{fill:#0b62c4;fill-opacity:.5}.strip text{font-size:13px;fill:#4f5b66}pre{white-space:pre-wrap}</style></head>
<body><h1>${escaped(title)}</h1><table><thead>${cells(rows[0]!, "th")}</thead><tbody>${rows.slice(1).map((row) => cells(row, "td")).join("")}</tbody></table>${used}
${stripsOf(runs, isGrouped).map((one) => `<h2>${escaped(one.label)}</h2>${one.strips.map(({ name, text, svg }) => `<p>${name ? `<b>${escaped(name)}</b>: ` : ""}${escaped(text)}</p>${svg}`).join("")}`).join("\n")}
<h2>Commands</h2><pre>${escaped(runs.map((run) => run.command).filter(Boolean).join("\n"))}</pre></body></html>
`;
}

export function makeCompare(shell: Shell): { element: HTMLElement; refresh(): void } {
  const choices = make("fieldset", "choices");
  const place = scrollable(make("div", "scroll"));
  const spreads = make("div", "spreads");
  const worst = make("div", "worst");
  const left = new Set<string>(); // out
  const columns = make("select");
  setChoices(columns, [["runs", "runs"], ["variants", "variants: cell, items, tempo"]]);
  const isByVariant = (): boolean => columns.value === "variants";
  const hour = numberInput("", 0, 1e6, "any"), lost = numberInput("", 0, 1e6, "any"), byHand = numberInput("", 0, 1e6, "any");
  const figure = (input: HTMLInputElement): number => (input.valueAsNumber >= 0 ? input.valueAsNumber : 0);
  const costs = (): Costs => ({ hour: figure(hour), lost: figure(lost), left: figure(byHand) });

  const chosen = (): RunStatus[] => shell.folder.runs.filter((run) => run.items > 0 && !left.has(run.name));

  function show(): void {
    const runs = chosen(), isGrouped = isByVariant();
    const rows = rowsOf(runs, costs(), isGrouped);
    const count = rows[0]!.length - 1;
    const shown = rows.map((row) => row.slice(0, MOST_COLUMNS + 1));
    place.replaceChildren(count === 0 ? make("p", "", "There is no run to compare yet.") : table(shown[0]!, shown.slice(1).map(([label, ...cells]) => [make("b", "", label), ...cells]), "compare"));
    if (count > MOST_COLUMNS) place.append(make("p", "", `${count - MOST_COLUMNS} more are in the files.`));
    if (isGrouped && !isFair(variantsOf(runs))) place.append(make("p", "", "These columns packed other orders or plants than one another: pack the same ones with each to compare the cells alone."));
    spreads.replaceChildren(...stripsOf(runs, isGrouped).map((one) => make("div", "spread", ...one.strips.map(({ name, text, svg }, k) => {
      const drawn = make("figure", "", make("figcaption", "", make("b", "", k === 0 ? `${one.label}: ` : ""), name ? make("small", "", `${name}: ${text}`) : text));
      drawn.append(new DOMParser().parseFromString(svg.replace("<svg ", '<svg xmlns="http://www.w3.org/2000/svg" '), "image/svg+xml").documentElement);
      return drawn;
    }))));
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
  columns.addEventListener("change", show);
  for (const input of [hour, lost, byHand]) input.addEventListener("input", changed);
  const element = make("section", "page", choices,
    make("fieldset", "numbers", make("legend", "", "Cost figures, in a currency of yours"),
      field("An hour of the cell", hour), field("A lost box", lost), field("A box that is packed by hand instead", byHand)),
    make("div", "bar", field("Columns", columns)), place,
    make("div", "bar",
      action("Download CSV", () => download(csvOf(chosen(), costs(), isByVariant()), "text/csv", "compare.csv"), "main"),
      action("Download workbook (.xlsx)", () => download(workbook(rowsOf(chosen(), costs(), isByVariant()), "compare") as BlobPart, "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet", "compare.xlsx")),
      action("Download page (.html)", () => download(pageOf(chosen(), costs(), `Runs of ${shell.folder.folder}`, isByVariant()), "text/html", "compare.html"))),
    spreads, worst);
  let named: string | null = null, known = "";
  return {
    element,
    // Only what has changed: where the keys are stays.
    refresh: () => {
      const now = JSON.stringify(shell.folder.runs);
      if (now === known) return;
      known = now;
      const names = shell.folder.runs.filter((run) => run.items > 0).map((run) => run.name).join("\n");
      if (names === named) return show();
      named = names;
      choices.replaceChildren(make("legend", "", "Runs"), ...shell.folder.runs.filter((run) => run.items > 0).slice(0, 300).map((run) => {
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
