// Cell: a scenario as text, drawn beside it; its parts are moved in the drawing, by numbers or in the text; mistakes shown
// with their line, and what the robot reaches over the container.

import { api, type CellMove, type CellPart, type Checked, type Facts } from "./api";
import { action, field, later, make, numberInput, setChoices, textInput } from "./dom";
import { namesIn, type Place } from "./placing";
import { makeParts } from "./parts";
import { makeReach } from "./reach";
import type { Shell } from "./shell";
import { decodeBase64, decodeReplay } from "../replay/decode";
import { Replay } from "../replay/replay";
import { Stage } from "./stage";
import { canEditCup, canEditSize, metres, setCupRadius, setInnerSize } from "./yaml_edit";

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

  // The drawing, made when there is something to draw.
  const place = make("div", "stage-place", make("p", "hint", "Here the cell is drawn."));
  const part = make("select");
  const numbers = [0, 1, 2].map(() => numberInput("", -100000, 100000, "any"));
  const turn = numberInput("", -360, 360, "any");
  const snap = make("select");
  setChoices(snap, [["1", "1 mm"], ["10", "10 mm"], ["50", "50 mm"], ["100", "100 mm"]], "10");
  snap.value = "10";
  let stage: Stage | null = null;
  let parts: CellPart[] = [];
  const reach = makeReach(shell, (map, layer) => stage?.showReach(map, layer));
  /** Text that was drawn last, and what was moved since and could not be drawn. */
  let base = "";
  let moves = new Map<string, CellMove>();
  let writtenHere = ""; // text that moves made
  let isOther = true; // than the cell that is drawn

  const tradeParts = makeParts(shell, {
    name: () => fileName(),
    text: () => text.value,
    facts: () => facts,
    set: async (changed) => {
      isOther = true;
      text.value = changed;
      await check();
    },
  });

  const fileName = (): string => `${name.value.trim()}.yaml`;
  const asCommand = make("p", "hint edits");
  /** `change`: key and value of the scenario. */
  function tellCommand(change = ""): void {
    asCommand.textContent = `As a command: snug check ${fileName()} --reach${change && ` --set "${change}"`}`;
  }
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

  let numbersOf = "";
  /** A number that is being typed stays, unless another part was chosen. */
  function showNumbers(at?: Place): void {
    const one = parts.find(({ key }) => key === part.value);
    for (const input of [...numbers, turn]) input.disabled = !one;
    if (!one) return;
    const isTyped = (input: HTMLInputElement): boolean => document.activeElement === input && numbersOf === one.key;
    const shown = at ?? { position: one.position_mm, yaw: one.yaw_deg };
    numbers.forEach((input, k) => {
      if (!isTyped(input)) input.value = String(Number(shown.position[k]!.toFixed(3)));
    });
    if (!isTyped(turn)) turn.value = String(Number(shown.yaw.toFixed(4)));
    numbersOf = one.key;
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
    verdict.textContent = mistake ? mistake.text : `This cell can be used. Its own orders: ${(checked.facts!.sequences ?? []).slice(0, 12).join(", ") || "none"}`;
    goTo.hidden = !mistake?.line;
    goTo.textContent = `Show line ${mistake?.line ?? ""}`;
    goTo.onclick = () => goToLine(mistake!.line!);
    if (checked.facts) {
      facts = checked.facts;
      tradeParts.showFacts();
    }
    stage?.markWrong(mistake ? namesIn(mistake.text) : []);
    if (mistake) return;
    showForm();
    void draw(checked.text);
  }

  async function draw(drawn: string): Promise<void> {
    try {
      const scene = await api.scene(fileName(), drawn);
      if (drawn !== text.value) return;
      const replay = new Replay(await decodeReplay(decodeBase64(scene.form)));
      if (drawn !== text.value) return;
      if (!stage) {
        stage = new Stage();
        stage.onSelect = (key) => {
          part.value = key;
          showNumbers();
        };
        stage.onDrag = (_, at) => showNumbers(at);
        stage.onMove = (key, at) => void move(key, at);
        place.replaceChildren(stage.element);
      }
      base = drawn;
      moves = new Map();
      parts = scene.parts;
      const before = part.value;
      setChoices(part, parts.map((one): [string, string] => [one.key, one.name]), before);
      stage.snap = Number(snap.value);
      stage.selected = part.value;
      stage.show(replay, parts, isOther);
      isOther = false;
      stage.markWrong([]);
      showNumbers();
      if (scene.has_robot) await reach.load(fileName(), drawn, () => drawn === text.value);
      else reach.clear("This cell has no robot: its tool moves by itself and reaches everything.");
    } catch (error) {
      reach.clear(shell.say(error));
    }
  }

  /** The part goes there, in the text; what could not be drawn before is moved with it. */
  async function move(key: string, to: Place): Promise<void> {
    if (moves.size > 0 && text.value !== writtenHere) return shell.tell("The text has a mistake: correct it first.", true);
    moves.set(key, { key, position_mm: to.position, yaw_deg: to.yaw });
    const asked = [...moves.values()];
    const done = await shell.attempt(() => api.move(fileName(), base, asked));
    if (!done) {
      moves.delete(key);
      stage?.select(part.value);
      return showNumbers();
    }
    parts = parts.map((one) => (one.key === key ? { ...one, position_mm: to.position, yaw_deg: to.yaw } : one));
    stage?.setParts(parts);
    text.value = writtenHere = done.text;
    shell.tell("");
    tellCommand(`${key}.pose={position: [${to.position.map(metres).join(", ")}], yaw_deg: ${Number(to.yaw.toFixed(6))}}`);
    showNumbers();
    await check();
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
    if (!sizes[0]!.disabled && size.every((edge) => edge >= 10 && edge <= 20000)) {
      const before = text.value;
      text.value = setInnerSize(before, target(), size);
      if (text.value !== before) tellCommand(`containers.${facts?.target}.inner_size=[${size.map(metres).join(", ")}]`);
    }
    if (!radius.disabled && radius.valueAsNumber >= 1 && radius.valueAsNumber !== facts?.cup_radius_mm) {
      text.value = setCupRadius(text.value, radius.valueAsNumber);
      tellCommand(`cup.lip_radius=${metres(radius.valueAsNumber)}`);
    }
    await check();
  }

  async function editPlace(): Promise<void> {
    const one = parts.find(({ key }) => key === part.value);
    const [x, y, z] = numbers.map((input) => input.valueAsNumber) as [number, number, number];
    if (!one || ![x, y, z, turn.valueAsNumber].every(Number.isFinite)) return;
    const isThere = [x, y, z].every((value, k) => Math.abs(value - one.position_mm[k]!) < 1e-3) && Math.abs(turn.valueAsNumber - one.yaw_deg) < 1e-4;
    if (isThere) return;
    stage?.preview({ position: [x, y, z], yaw: turn.valueAsNumber });
    await move(one.key, { position: [x, y, z], yaw: turn.valueAsNumber });
  }

  async function begin(): Promise<void> {
    const found = await shell.attempt(() => api.template(template.value));
    if (!found) return;
    const { arm } = found;
    const known = arm && shell.folder.arms.find((one) => one.name === arm.name);
    if (known && known.bytes !== new Blob([arm.text]).size) return shell.tell(`The folder has another ${arm.name}: give it another name, or remove it.`, true);
    if (arm && !known) {
      if (!shell.folder.can_be_written) return shell.tell(`This template needs ${arm.name} in the folder, which can only be read.`, true);
      if (!(await shell.attempt(() => api.write(arm.name, arm.text)))) return;
      await shell.refresh();
    }
    name.value = template.value;
    asCommand.textContent = `As a command: snug init ${template.value}`;
    isOther = true;
    text.value = found.text;
    await check();
  }

  async function open(): Promise<void> {
    if (!saved.value) return;
    const checked = await shell.attempt(() => shell.open(saved.value));
    if (!checked) return;
    name.value = saved.value.replace(/\.yaml$/, "");
    isOther = true;
    text.value = checked.text;
    show(checked);
  }

  async function save(): Promise<void> {
    const done = await shell.attempt(() => shell.write(fileName(), text.value));
    if (done === false) return shell.tell(`${fileName()} is left as it was: give this cell another name, or open that one.`);
    if (!done) return check();
    shell.tell(`${fileName()} is saved.`);
    tellCommand();
    shell.remember({ scenario: fileName() });
    await shell.refresh();
  }

  const changed = later(300, () => void edit());
  for (const input of [...sizes, radius]) input.addEventListener("input", changed);
  const placed = later(300, () => void editPlace());
  for (const input of [...numbers, turn]) input.addEventListener("input", placed);
  text.addEventListener("input", later(300, () => void check()));
  saved.addEventListener("change", () => void open());
  part.addEventListener("change", () => {
    stage?.select(part.value);
    showNumbers();
  });
  snap.addEventListener("change", () => stage && (stage.snap = Number(snap.value)));
  showForm();
  showNumbers();
  void check();
  const element = make("section", "page",
    make("div", "bar", field("Template", template), action("Begin from the template", begin), field("Open a cell of the folder", saved),
      field("Name of the cell", name), action("Save cell", save, "main")),
    make("div", "bar", verdict, goTo),
    make("div", "cell",
      make("div", "cell-left", place,
        make("p", "hint edits", "Drag a part; with Shift up and down. Or choose it and use the arrow keys, Page Up, Page Down, [ and ] in the drawing."),
        make("fieldset", "numbers edits", make("legend", "", "Place of a part"),
          field("Part", part), field("x in mm", numbers[0]!), field("y in mm", numbers[1]!), field("z in mm", numbers[2]!), field("Turn in degrees", turn), field("Snap to", snap)),
        make("fieldset", "numbers edits", make("legend", "", "Main numbers"),
          field("Container length in mm", sizes[0]!), field("Container width in mm", sizes[1]!), field("Container height in mm", sizes[2]!),
          field("Cup radius in mm", radius), make("p", "", "The tempo is chosen with the run. Everything else is in the text.")),
        asCommand, tradeParts.element),
      make("div", "cell-right", reach.element, field("Text of the cell (YAML)", text, "wide"))));
  element.addEventListener("dragover", (event) => event.preventDefault());
  element.addEventListener("drop", (event) => {
    event.preventDefault();
    void tradeParts.take([...(event.dataTransfer?.files ?? [])]);
  });
  // For tests and scripts that point at parts.
  (window as unknown as { snugCell: object }).snugCell = { pointOf: (key: string) => stage?.pointOf(key) ?? null, reachLayer: () => reach.layer() };
  return {
    element,
    refresh: () => {
      setChoices(template, shell.folder.templates.map((one): [string, string] => [one.name, `${one.name}: ${one.description}`]));
      tradeParts.refresh();
      setChoices(saved, [["", "–"], ...shell.folder.scenarios.map((one): [string, string] => [one.name, one.name])]);
    },
  };
}
