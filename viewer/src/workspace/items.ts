// Items: orders of boxes from a sheet: chosen, dropped or typed; units asked for where they are unclear; mistakes marked where
// they are; boxes drawn to scale.

import { api, Refused, type ItemLine, type Mistake, type SheetAnswers } from "./api";
import { choiceOf } from "./ask";
import { BookError, csvOfBook } from "./book";
import { action, field, later, make, numberInput, plainName, scrollable, setChoices, textInput } from "./dom";
import type { Shell } from "./shell";
import { drawSpreads } from "./spreads";

const EXAMPLE = `order,article,length_mm,width_mm,height_mm,mass_kg,count
mine,coffee,200,150,100,0.5,1
mine,tea,180,120,90,0.4,2
`;
const LARGEST = 4 * 1024 * 1024; // bytes of text, as the program takes
const LARGEST_FILE = 8 * 1024 * 1024; // of a workbook
const ABOUT: Record<string, string> = {
  length: "In which unit are the lengths of this sheet?", mass: "In which unit are the masses of this sheet?", decimal: "What does the comma in this sheet's numbers stand before?",
};
const MOST_ROWS = 500; // shown; all are read
const MOST_DRAWN = 60;

const SVG = "http://www.w3.org/2000/svg";

/** A box in isometric view, three faces; `scale`: units a mm. */
function drawBox(line: ItemLine, scale: number): SVGSVGElement {
  const [l, w, h] = line.size_mm.map((edge) => edge * scale) as [number, number, number];
  const c = Math.cos(Math.PI / 6);
  const point = (x: number, y: number, z: number): string => `${((x - y) * c + w * c).toFixed(1)},${((x + y) / 2 - z + h).toFixed(1)}`;
  const face = (className: string, ...corners: [number, number, number][]): SVGPolygonElement => {
    const polygon = document.createElementNS(SVG, "polygon");
    polygon.setAttribute("points", corners.map((corner) => point(...corner)).join(" "));
    polygon.setAttribute("class", className);
    return polygon;
  };
  const svg = document.createElementNS(SVG, "svg");
  const width = (l + w) * c, height = (l + w) / 2 + h;
  svg.setAttribute("viewBox", `-1 -1 ${width + 2} ${height + 2}`);
  svg.setAttribute("width", String(width + 2));
  svg.setAttribute("height", String(height + 2));
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", `${line.article}: ${line.size_mm.join(" x ")} mm`);
  svg.append(
    face("top", [0, 0, h], [l, 0, h], [l, w, h], [0, w, h]),
    face("left", [0, w, 0], [l, w, 0], [l, w, h], [0, w, h]),
    face("right", [l, 0, 0], [l, w, 0], [l, w, h], [l, 0, h]),
  );
  return svg;
}

/** The fields of a line: commas within quotes are part of them. */
export function fieldsOf(line: string): string[] {
  const fields: string[] = [];
  for (const found of `,${line}`.matchAll(/,\s*(?:"((?:[^"]|"")*)"|([^,]*))/g)) fields.push((found[1]?.replace(/""/g, '"') ?? found[2] ?? "").trim());
  return fields;
}

export function makeItems(shell: Shell): { element: HTMLElement; refresh(): void } {
  const file = make("input");
  file.type = "file";
  file.accept = ".csv,.tsv,.txt,.xlsx,.ods,text/csv";
  const saved = make("select");
  const name = textInput("items");
  const text = make("textarea", "source");
  text.rows = 8;
  text.spellcheck = false;
  text.wrap = "off";
  const verdict = make("p", "verdict");
  verdict.setAttribute("role", "status");
  const recognise = action("Recognise the columns", () => takeSheet(text.value));
  recognise.hidden = true;
  const read = make("p", "hint"); // how the sheet was read
  read.setAttribute("role", "status");
  const rows = scrollable(make("div", "scroll"));
  const boxes = make("div", "boxes");
  const spreads = make("div", "spreads");
  const orders = numberInput(3, 1, 100, 1), perOrder = numberInput(20, 1, 200, 1), drawn = numberInput(1, 0, 1e9, 1);

  const fileName = (): string => `${name.value.trim()}.csv`;

  function showRows(mistakes: Mistake[]): void {
    const lines = text.value.split(/\r?\n/);
    const table = make("table", "rows");
    const header = fieldsOf(lines[0] ?? "");
    let shown = 0;
    lines.forEach((line, k) => {
      if (line.trim() === "") return;
      const mistake = mistakes.find((one) => one.line === k + 1);
      if (++shown > MOST_ROWS && !mistake) return;
      const row = make("tr", mistake ? "bad" : "", make("th", "", String(k + 1)));
      const wrong = mistake ? header.indexOf(mistake.key) : -1;
      fieldsOf(line).forEach((word, i) => row.append(make(shown === 1 ? "th" : "td", i === wrong ? "wrong" : "", word)));
      if (mistake) row.append(make("td", "why", mistake.text));
      table.append(row);
    });
    rows.replaceChildren(table);
    if (shown > MOST_ROWS) rows.append(make("p", "", `${shown - MOST_ROWS} more rows are not shown; all are read.`));
  }

  function showBoxes(lines: ItemLine[]): void {
    spreads.replaceChildren(...drawSpreads(lines));
    const largest = Math.max(1, ...lines.map((line) => Math.max(...line.size_mm)));
    boxes.replaceChildren(...lines.slice(0, MOST_DRAWN).map((line) =>
      make("figure", "", drawBox(line, 70 / largest), make("figcaption", "", `${line.count} × ${line.article}`, make("small", "", `${line.size_mm.join(" × ")} mm, ${line.mass_kg} kg`))),
    ));
  }

  async function check(): Promise<void> {
    if (text.value.trim() === "") {
      verdict.textContent = "Choose a sheet, drop one here, or begin with the example.";
      verdict.className = "verdict";
      rows.replaceChildren();
      recognise.hidden = true;
      boxes.replaceChildren();
      spreads.replaceChildren();
      return;
    }
    try {
      const asked = text.value;
      const checked = await api.check(fileName(), asked);
      if (asked !== text.value) return; // another check is under way
      showRows(checked.mistakes ?? []);
      recognise.hidden = !(checked.mistake && checked.mistake.line === 1);
      showBoxes(checked.facts?.lines ?? []);
      const count = (checked.facts?.lines ?? []).reduce((sum, line) => sum + line.count, 0);
      verdict.className = checked.mistake ? "verdict bad" : "verdict good";
      verdict.textContent = checked.mistake ? `${(checked.mistakes?.length ?? 1) > 1 ? `${checked.mistakes!.length} lines with mistakes. ` : ""}${checked.mistake.text}` : `${count} boxes; orders: ${(checked.facts!.sequences ?? []).slice(0, 8).join(", ")}`;
    } catch (error) {
      verdict.className = "verdict bad";
      verdict.textContent = shell.say(error);
    }
  }

  /** A sheet as people keep it becomes orders; what it does not say is asked. */
  async function takeSheet(chosen: string): Promise<void> {
    const answers: SheetAnswers = {};
    text.value = chosen;
    const sheet = text.value; // its ends of lines are those of the page now
    read.textContent = "";
    for (;;) {
      const found = await shell.attempt(() => api.sheet(fileName(), sheet, answers));
      if (!found || text.value !== sheet) break;
      const open = found.questions[0];
      if (!open) {
        text.value = found.orders;
        const taken = found.columns.filter(({ heading, column }) => column !== "" && column !== heading).map(({ heading, column }) => `${heading} as ${column}`);
        const left = found.columns.filter(({ column }) => column === "").map(({ heading }) => heading);
        if (found.orders !== sheet) read.textContent = `Read ${taken.join(", ")}${left.length > 0 ? `; passed over ${left.join(", ")}` : ""}. As a command for a CSV: ${found.command}`;
        break;
      }
      const said = await choiceOf(ABOUT[open.about] ?? open.about, open.choices.map(({ answer, meaning }): [string, string] => [answer, `${answer}: ${open.about === "decimal" ? "" : "the first box is "}${meaning}`]));
      if (said === null) break;
      answers[open.about as keyof SheetAnswers] = said;
    }
    await check();
  }

  async function take(from: File | undefined): Promise<void> {
    if (!from) return;
    const isBook = /\.(xlsx|ods)$/i.test(from.name);
    const most = isBook ? LARGEST_FILE : LARGEST;
    if (from.size > most) return shell.tell(`${from.name} has ${from.size} bytes; at most ${most} can be taken.`, true);
    shell.tell("");
    try {
      const sheet = isBook ? csvOfBook(new Uint8Array(await from.arrayBuffer())) : await from.text();
      name.value = plainName(from.name, "items");
      await takeSheet(sheet);
    } catch (error) {
      shell.tell(error instanceof BookError ? `${from.name} cannot be read. ${error.message}` : shell.say(error), true);
    }
    file.value = ""; // the same file can be chosen again
  }

  async function draw(): Promise<void> {
    const done = await shell.attempt(() => api.typical({ orders: orders.valueAsNumber, boxes: perOrder.valueAsNumber, seed: drawn.valueAsNumber }));
    if (!done) return;
    shell.tell("");
    name.value = `typical-${drawn.value}`;
    text.value = done.orders;
    read.textContent = `Drawn by a seed. As a command: ${done.command}`;
    await check();
  }

  async function open(): Promise<void> {
    if (!saved.value) return;
    const checked = await shell.attempt(() => shell.open(saved.value));
    if (!checked) return;
    name.value = saved.value.replace(/\.csv$/, "");
    text.value = checked.text;
    await check();
  }

  async function save(): Promise<void> {
    try {
      if (!(await shell.write(fileName(), text.value))) return shell.tell(`${fileName()} is left as it was: give these items another name, or open those.`);
      shell.tell(`${fileName()} is saved.`);
      shell.remember({ items: fileName() });
      await shell.refresh();
    } catch (error) {
      shell.tell(shell.say(error), true);
      if (error instanceof Refused) await check();
    }
  }

  file.addEventListener("change", () => void take(file.files?.[0]));
  saved.addEventListener("change", () => void open());
  text.addEventListener("input", later(250, () => void check()));
  name.addEventListener("input", later(250, () => void check()));
  const element = make("section", "page",
    make("div", "bar",
      field("Choose a sheet (CSV, XLSX, ODS)", file),
      field("Open items of the folder", saved),
      action("Use the example", () => {
        name.value = "items";
        text.value = EXAMPLE;
        return check();
      })),
    make("fieldset", "numbers", make("legend", "", "Typical orders"),
      field("Orders", orders), field("Boxes of an order", perOrder), field("Seed", drawn),
      action("Draw orders", () => {
        if (![orders, perOrder, drawn].every((input) => input.checkValidity() && input.value !== "")) return shell.tell("1 to 100 orders of 1 to 200 boxes.", true);
        return draw();
      })),
    make("div", "bar", field("Name of the items", name), action("Save items", save, "main"), recognise),
    verdict, read, rows, spreads, boxes, field("Text of the items", text, "wide"));
  element.addEventListener("dragover", (event) => event.preventDefault());
  element.addEventListener("drop", (event) => {
    event.preventDefault();
    void take(event.dataTransfer?.files[0]);
  });
  void check();
  return {
    element,
    refresh: () => setChoices(saved, [["", "–"], ...shell.folder.items.map((one): [string, string] => [one.name, one.name])]),
  };
}
