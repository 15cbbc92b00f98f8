// Parts: what a cell is made of, chosen by name: containers and pallets, cups of the catalogue, an arm whose URDF is dropped.

import { api, type Catalogue, type CupSheet, type Facts } from "./api";
import { action, field, make, numberInput, plainName, setChoices } from "./dom";
import type { Shell } from "./shell";
import { canEditSize, setInnerSize } from "./yaml_edit";

const LARGEST_URDF = 4 * 1024 * 1024; // bytes, as the program takes
const LARGEST_MESH = 16 * 1024 * 1024;
const MOST_FILES = 100;
const MESH = /\.(stl|obj|dae)$/i;

export interface CellText {
  name(): string; // of the file
  text(): string;
  facts(): Facts | null;
  /** The text is another one now. */
  set(text: string): Promise<void>;
}

/** Names of files that can be written, with the ending in small letters: as the URDF's meshes have them. */
export function splitDropped(files: { name: string; size: number }[]): { urdfs: number[]; meshes: number[]; trouble: string } {
  const urdfs: number[] = [], meshes: number[] = [];
  let trouble = files.length > MOST_FILES ? `${files.length} files: at most ${MOST_FILES} at a time.` : "";
  files.forEach(({ name, size }, k) => {
    const isUrdf = /\.urdf$/i.test(name), isMesh = MESH.test(name);
    if (isUrdf) urdfs.push(k);
    else if (isMesh) meshes.push(k);
    else trouble ||= `${name} is neither a URDF nor a mesh (.stl, .obj, .dae). A xacro has to be expanded first.`;
    const most = isUrdf ? LARGEST_URDF : LARGEST_MESH;
    if (size > most) trouble ||= `${name} has ${size} bytes; at most ${most} can be taken.`;
  });
  if (urdfs.length > 1) trouble ||= "More than one URDF: one arm at a time.";
  if (urdfs.length + meshes.length === 0) trouble ||= "No URDF is among them.";
  return { urdfs, meshes, trouble };
}

export function makeParts(shell: Shell, cell: CellText): { element: HTMLElement; refresh(): void; take(files: File[]): Promise<void>; showFacts(): void } {
  const container = make("select"), cup = make("select"), arm = make("select"), tool = make("select");
  const files = make("input");
  files.type = "file";
  files.multiple = true;
  files.accept = ".urdf,.stl,.obj,.dae";
  const said = make("p", "hint");
  said.setAttribute("role", "status");
  // A cup by its data sheet.
  const diameter = numberInput(40, 5, 300, "any"), folds = make("select"), material = make("select"), lip = make("select");
  const vacuum = numberInput(-60, -101, -1, "any"), stroke = numberInput("", 0, 300, "any");
  setChoices(folds, [["0", "flat"], ["1.5", "1.5"], ["2.5", "2.5"]], "1.5");
  setChoices(material, ["silicone", "nitrile", "polyurethane", "natural-rubber"].map((one): [string, string] => [one, one.replace("-", " ")]));
  setChoices(lip, [["plain", "plain"], ["foam", "foam"]]);
  let catalogue: Catalogue | null = null;

  async function load(): Promise<void> {
    if (catalogue) return;
    catalogue = (await shell.attempt(() => api.catalogue())) ?? null;
    if (!catalogue) return;
    setChoices(cup, [["", "–"], ...catalogue.cups.map((one): [string, string] =>
      [one.key, `${one.diameter_mm.toFixed(0)} mm, ${one.bellows === 0 ? "flat" : `${one.bellows} folds`}${one.lip === "foam" ? ", foam lip" : ""}: ${one.pull_off_N[1].toFixed(0)} N`])]);
    showFacts();
  }

  function target(): { index: number; walls: boolean; height: number } | null {
    const facts = cell.facts();
    const index = (facts?.containers ?? []).findIndex((one) => one.name === facts!.target);
    if (!facts || index < 0) return null;
    const one = facts.containers![index]!;
    return { index, walls: one.walls, height: one.inner_size_mm[2] };
  }

  /** Containers or pallets, as the cell has them. */
  function showFacts(): void {
    const now = target();
    const can = now !== null && canEditSize(cell.text(), cell.facts()!.containers!.length);
    container.disabled = !can || !catalogue;
    cup.disabled = !cell.facts() || !catalogue;
    if (!can || !catalogue) return;
    const fitting = catalogue.containers.map((one, k): [string, string, boolean] => [String(k), one.name, one.pallet === !now.walls]).filter(([, , fits]) => fits);
    setChoices(container, [["", "–"], ...fitting.map(([k, name]): [string, string] => [k, name])]);
  }

  async function chooseContainer(): Promise<void> {
    const one = catalogue?.containers[Number(container.value || -1)];
    const now = target();
    if (!one || !now) return;
    const [length, width, height] = one.inner_size_mm;
    said.textContent = `${one.name}: ${one.source}. ${one.pallet ? `Boxes may stand ${now.height.toFixed(0)} mm high.` : "Measure yours."}`;
    await cell.set(setInnerSize(cell.text(), now.index, [length, width, one.pallet ? now.height : height]));
  }

  async function putCup(which: string | CupSheet): Promise<void> {
    if (cell.text().trim() === "") return shell.tell("Begin from a template first: the cup is put into a cell.", true);
    const done = await shell.attempt(() => api.putCup(cell.name(), cell.text(), which));
    if (!done) return;
    const pull = done.pull_off_N!;
    shell.tell("");
    said.textContent = `An estimate to begin with: pull-off ${pull[0].toFixed(0)} to ${pull[2].toFixed(0)} N. As a command: ${done.command}`;
    await cell.set(done.text);
  }

  function putSheet(): void | Promise<void> {
    if (![diameter, vacuum].every((input) => input.value !== "" && input.checkValidity()) || !stroke.checkValidity())
      return shell.tell("A cup has a diameter of 5 to 300 mm, a vacuum of -101 to -1 kPa and, if the sheet has it, a stroke.", true);
    return putCup({ diameter_mm: diameter.valueAsNumber, bellows: Number(folds.value), material: material.value, lip: lip.value, vacuum_kPa: vacuum.valueAsNumber,
      stroke_mm: stroke.value === "" ? null : stroke.valueAsNumber });
  }

  async function loadTools(): Promise<void> {
    if (!arm.value) return setChoices(tool, [["", "–"]]);
    const checked = await shell.attempt(() => api.facts(arm.value));
    setChoices(tool, (checked?.facts?.links ?? []).map((one): [string, string] => [one, one]));
  }

  async function putArm(): Promise<void> {
    if (!arm.value) return void (said.textContent = "Drop a URDF first.");
    if (cell.text().trim() === "") return void (said.textContent = "Begin from a template first: the arm is put into a cell.");
    const done = await shell.attempt(() => api.putArm(cell.name(), cell.text(), arm.value, tool.value || undefined));
    if (!done) return;
    said.textContent = `${arm.value} is the arm of this cell; ${done.tool} carries the tool.`;
    await cell.set(done.text);
  }

  /** Meshes first: the URDF is taken with all that it names, or not at all. */
  async function take(dropped: File[]): Promise<void> {
    const { urdfs, meshes, trouble } = splitDropped(dropped);
    if (trouble) return shell.tell(trouble, true);
    for (const k of meshes) {
      const one = dropped[k]!;
      if (!(await shell.attempt(() => api.upload(one.name, one)))) return;
    }
    const urdf = urdfs.length > 0 ? dropped[urdfs[0]!]! : null;
    if (!urdf) return void (said.textContent = `${meshes.length} meshes are in the folder.`);
    const name = `${plainName(urdf.name, "arm")}.urdf`;
    if (!(await shell.attempt(() => api.upload(name, urdf)))) return;
    shell.tell(`${name} is in the folder.`);
    await shell.refresh();
    arm.value = name;
    await loadTools();
    await putArm();
  }

  container.addEventListener("change", () => void chooseContainer());
  cup.addEventListener("change", () => cup.value && void putCup(cup.value));
  arm.addEventListener("change", () => void loadTools());
  files.addEventListener("change", () => void take([...(files.files ?? [])]).then(() => (files.value = "")));
  const sheet = make("details", "", make("summary", "", "Cup by its data sheet"),
    make("div", "bar", field("Diameter of the lip in mm", diameter), field("Folds", folds), field("Material", material), field("Lip", lip), field("Vacuum in kPa", vacuum), field("Stroke in mm", stroke),
      action("Use this cup", putSheet)));
  const element = make("fieldset", "numbers edits", make("legend", "", "Catalogue, cups and arms"),
    field("Container of the catalogue", container), field("Cup of the catalogue", cup), sheet,
    field("Choose a URDF and its meshes", files), field("Arm of the folder", arm), field("Link that carries the tool", tool), action("Use this arm", putArm), said);
  return {
    element,
    take,
    showFacts,
    refresh: () => {
      const before = arm.value;
      setChoices(arm, [["", "–"], ...shell.folder.arms.map((one): [string, string] => [one.name, one.name])]);
      if (arm.value !== before || tool.options.length === 0) void loadTools();
      void load();
    },
  };
}
