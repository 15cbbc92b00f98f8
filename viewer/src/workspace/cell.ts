// Cell: a scenario as text, with a form beside it for its main numbers; mistakes shown with their line.

import { api, type Checked, type Facts } from "./api";
import { action, field, later, make, numberInput, setChoices, textInput } from "./dom";
import type { Shell } from "./shell";
import { canEditCup, canEditSize, setCupRadius, setInnerSize } from "./yaml_edit";

export function makeCell(shell: Shell): { element: HTMLElement; refresh(): void } {
  const template = make("select");
  const saved = make("select");
  const name = textInput("cell");
  const text = make("textarea", "source tall");
  text.spellcheck = false;
  text.wrap = "off";
  const verdict = make("p", "verdict");
  verdict.setAttribute("role", "status");
  const goTo = action("", () => undefined);
  goTo.hidden = true;
  const sizes = ["length", "width", "height"].map(() => numberInput("", 10, 20000, "any"));
  const radius = numberInput("", 1, 200, "any");
  let facts: Facts | null = null;

  const fileName = (): string => `${name.value.trim()}.yaml`;
  const target = (): number => (facts?.containers ?? []).findIndex((one) => one.name === facts!.target);

  function showForm(): void {
    const container = facts?.containers?.[target()];
    const canSize = container !== undefined && canEditSize(text.value, facts!.containers!.length);
    sizes.forEach((input, k) => {
      input.disabled = !canSize;
      if (container && document.activeElement !== input) input.value = String(Number(container.inner_size_mm[k]!.toFixed(3)));
    });
    radius.disabled = facts?.cup_radius_mm === undefined || !canEditCup(text.value);
    if (facts?.cup_radius_mm !== undefined && document.activeElement !== radius) radius.value = String(Number(facts.cup_radius_mm.toFixed(3)));
  }

  function goToLine(line: number): void {
    const before = text.value.split("\n").slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0);
    const end = text.value.indexOf("\n", before);
    text.focus();
    text.setSelectionRange(before, end < 0 ? text.value.length : end);
    text.scrollTop = Math.max(0, (line - 5) * parseFloat(getComputedStyle(text).lineHeight));
  }

  function show(checked: Checked): void {
    const mistake = checked.mistake;
    verdict.className = mistake ? "verdict bad" : "verdict good";
    verdict.textContent = mistake ? mistake.text : `This cell can be used. Its own orders: ${checked.facts!.sequences.slice(0, 12).join(", ") || "none"}`;
    goTo.hidden = !mistake?.line;
    goTo.textContent = `Show line ${mistake?.line ?? ""}`;
    goTo.onclick = () => goToLine(mistake!.line!);
    if (checked.facts) facts = checked.facts;
    if (!mistake) showForm();
  }

  async function check(): Promise<void> {
    if (text.value.trim() === "") return void (verdict.textContent = "Begin from a template, or open a cell of the folder.");
    try {
      const asked = text.value;
      const checked = await api.check(fileName(), asked);
      if (asked === text.value) show(checked);
    } catch (error) {
      verdict.className = "verdict bad";
      verdict.textContent = shell.say(error);
      goTo.hidden = true;
    }
  }

  async function edit(): Promise<void> {
    const size = sizes.map((input) => input.valueAsNumber);
    if (!sizes[0]!.disabled && size.every((edge) => edge >= 10 && edge <= 20000)) text.value = setInnerSize(text.value, target(), size);
    if (!radius.disabled && radius.valueAsNumber >= 1 && radius.valueAsNumber !== facts?.cup_radius_mm) text.value = setCupRadius(text.value, radius.valueAsNumber);
    await check();
  }

  async function begin(): Promise<void> {
    const found = await shell.attempt(() => api.template(template.value));
    if (!found) return;
    name.value = template.value;
    text.value = found.text;
    await check();
  }

  async function open(): Promise<void> {
    if (!saved.value) return;
    const checked = await shell.attempt(() => api.facts(saved.value));
    if (!checked) return;
    name.value = saved.value.replace(/\.yaml$/, "");
    text.value = checked.text;
    show(checked);
  }

  async function save(): Promise<void> {
    const done = await shell.attempt(() => api.write(fileName(), text.value));
    if (!done) return check();
    shell.tell(`${fileName()} is saved.`);
    shell.remember({ scenario: fileName() });
    await shell.refresh();
  }

  const changed = later(300, () => void edit());
  for (const input of [...sizes, radius]) input.addEventListener("input", changed);
  text.addEventListener("input", later(300, () => void check()));
  saved.addEventListener("change", () => void open());
  showForm();
  void check();
  const element = make("section", "page",
    make("div", "bar", field("Template", template), action("Begin from the template", begin), field("Open a cell of the folder", saved)),
    make("div", "bar", field("Name of the cell", name), action("Save cell", save, "main")),
    make("div", "bar", verdict, goTo),
    make("div", "two",
      make("fieldset", "", make("legend", "", "Main numbers"),
        field("Container length in mm", sizes[0]!), field("Container width in mm", sizes[1]!), field("Container height in mm", sizes[2]!),
        field("Cup radius in mm", radius), make("p", "", "The tempo is chosen with the run. Everything else is in the text.")),
      field("Text of the cell (YAML)", text, "wide")));
  return {
    element,
    refresh: () => {
      setChoices(template, shell.folder.templates.map((one): [string, string] => [one.name, `${one.name}: ${one.description}`]));
      setChoices(saved, [["", "–"], ...shell.folder.scenarios.map((one): [string, string] => [one.name, one.name])]);
    },
  };
}
