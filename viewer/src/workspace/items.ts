// Items: orders of boxes from a CSV: chosen, dropped or typed; mistakes marked where they are; boxes drawn to scale.

import { api, Refused, type Checked, type ItemLine } from "./api";
import { action, field, later, make, numberInput, plainName, scrollable, setChoices, textInput } from "./dom";
import type { Shell } from "./shell";
import { drawSpreads, typicalOrders } from "./typical";

const EXAMPLE = `order,article,length_mm,width_mm,height_mm,mass_kg,count
mine,coffee,200,150,100,0.5,1
mine,tea,180,120,90,0.4,2
`;
const LARGEST = 4 * 1024 * 1024; // bytes, as the program takes
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

export function makeItems(shell: Shell): { element: HTMLElement; refresh(): void } {
  const file = make("input");
  file.type = "file";
  file.accept = ".csv,text/csv";
  const saved = make("select");
  const name = textInput("items");
  const text = make("textarea", "source");
  text.rows = 8;
  text.spellcheck = false;
  text.wrap = "off";
  const verdict = make("p", "verdict");
  verdict.setAttribute("role", "status");
  const rows = scrollable(make("div", "scroll"));
  const boxes = make("div", "boxes");
  const spreads = make("div", "spreads");
  const orders = numberInput(3, 1, 100, 1), perOrder = numberInput(20, 1, 200, 1), drawn = numberInput(1, 0, 1e9, 1);

  const fileName = (): string => `${name.value.trim()}.csv`;

  function showRows(mistake: Checked["mistake"]): void {
    const lines = text.value.split(/\r?\n/);
    const table = make("table", "rows");
    let shown = 0;
    lines.forEach((line, k) => {
      if (line.trim() === "") return;
      const isBad = mistake?.line === k + 1;
      if (++shown > MOST_ROWS && !isBad) return;
      const row = make("tr", isBad ? "bad" : "", make("th", "", String(k + 1)));
      for (const cell of line.split(",")) row.append(make(shown === 1 ? "th" : "td", "", cell.trim()));
      if (isBad) row.append(make("td", "why", mistake.text));
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
      verdict.textContent = "Choose a CSV, drop one here, or begin with the example.";
      verdict.className = "verdict";
      rows.replaceChildren();
      boxes.replaceChildren();
      spreads.replaceChildren();
      return;
    }
    try {
      const asked = text.value;
      const checked = await api.check(fileName(), asked);
      if (asked !== text.value) return; // another check is under way
      showRows(checked.mistake);
      showBoxes(checked.facts?.lines ?? []);
      const count = (checked.facts?.lines ?? []).reduce((sum, line) => sum + line.count, 0);
      verdict.className = checked.mistake ? "verdict bad" : "verdict good";
      verdict.textContent = checked.mistake ? checked.mistake.text : `${count} boxes; orders: ${checked.facts!.sequences.slice(0, 8).join(", ")}`;
    } catch (error) {
      verdict.className = "verdict bad";
      verdict.textContent = shell.say(error);
    }
  }

  async function take(from: File | undefined): Promise<void> {
    if (!from) return;
    if (from.size > LARGEST) return void (verdict.textContent = `${from.name} has ${from.size} bytes; at most ${LARGEST} can be taken.`);
    name.value = plainName(from.name, "items");
    text.value = await from.text();
    await check();
  }

  async function open(): Promise<void> {
    if (!saved.value) return;
    const checked = await shell.attempt(() => api.facts(saved.value));
    if (!checked) return;
    name.value = saved.value.replace(/\.csv$/, "");
    text.value = checked.text;
    await check();
  }

  async function save(): Promise<void> {
    try {
      await api.write(fileName(), text.value);
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
      field("Choose a CSV", file),
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
        name.value = `typical-${drawn.value}`;
        text.value = typicalOrders({ orders: orders.valueAsNumber, boxes: perOrder.valueAsNumber, seed: drawn.valueAsNumber });
        return check();
      })),
    make("div", "bar", field("Name of the items", name), action("Save items", save, "main")),
    verdict, rows, spreads, boxes, field("Text of the items", text, "wide"));
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
