// The cell of `snug ui` in Chromium: what is reached, parts moved by mouse, keys and numbers, the same cell as by hand; runs
// watched in 3D; and what an accessibility checker finds on every view.

import type { ChildProcess } from "node:child_process";
import { appendFileSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import type { Browser, Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, describe, expect, it } from "vitest";
import { openBrowser } from "../support/browser";
import { repository, serveWith, snug } from "../support/program";

const ORDERS = "order,article,length_mm,width_mm,height_mm,mass_kg,count\nmine,A,180,120,90,0.4,1\nmine,B,150,120,90,0.3,1\nlong,C,120,100,70,0.2,25\n";
/** Three slides and a turn; one mesh, named by a path that must not be read. */
const SLIDE = '<limit lower="-1.5" upper="1.5" effort="3000" velocity="2"/>';
const MASS = '<inertial><mass value="8"/><inertia ixx="0.3" iyy="0.3" izz="0.3"/></inertial>';
const joint = (name: string, kind: string, parent: string, child: string, axis: string, limit: string): string =>
  `<joint name="${name}" type="${kind}"><parent link="${parent}"/><child link="${child}"/><axis xyz="${axis}"/>${limit}</joint>`;
const GANTRY = `<robot name="gantry"><link name="frame"/><link name="bridge">${MASS}</link><link name="carriage">${MASS}</link>
<link name="mast">${MASS}<collision><geometry><mesh filename="file:///etc/mast.stl" scale="0.01 0.01 0.01"/></geometry></collision></link><link name="flange">${MASS}</link>
${joint("x", "prismatic", "frame", "bridge", "1 0 0", SLIDE)}${joint("y", "prismatic", "bridge", "carriage", "0 1 0", SLIDE)}
${joint("z", "prismatic", "carriage", "mast", "0 0 1", SLIDE)}${joint("yaw", "revolute", "mast", "flange", "0 0 1", '<limit lower="-6.28" upper="6.28" effort="300" velocity="4"/>')}
<link name="tool0"/><joint name="turned" type="fixed"><parent link="flange"/><child link="tool0"/><origin rpy="3.141592653589793 0 0"/></joint></robot>`;
const MAST = `solid mast
${[[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]].map((corners) => `facet normal 0 0 0
outer loop
${corners.map((k) => `vertex ${["0 0 0", "1 0 0", "0 1 0", "0 0 1"][k]}`).join("\n")}
endloop
endfacet`).join("\n")}
endsolid mast
`;
const PATIENCE = 180_000; // ms, for drawing without a graphics card while others work
const axe = readFileSync(join(repository, "viewer/node_modules/axe-core/axe.min.js"), "utf8");

let browser: Browser;
let folder = "";
let child: ChildProcess | null = null;
let address = "";
const errors: string[] = [];

/** Small: pixels are what drawing without a graphics card costs. */
async function openPage(width = 960, height = 600): Promise<Page> {
  const context = await browser.newContext({ viewport: { width, height } });
  const page = await context.newPage();
  page.on("pageerror", (error) => errors.push(error.message));
  page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
  page.on("dialog", (dialog) => void dialog.accept());
  await page.goto(address);
  await page.waitForFunction(() => (window as unknown as { snugReady?: boolean }).snugReady === true);
  return page;
}

/** For people to look at, where SNUG_PICTURES asks for them. */
async function picture(page: Page, name: string): Promise<void> {
  if (process.env.SNUG_PICTURES) await page.screenshot({ path: `test/out/${name}.png` });
}

async function begin(page: Page, template: string): Promise<void> {
  await page.getByRole("tab", { name: "Cell" }).click();
  await page.getByLabel("Template").selectOption(template);
  await page.getByRole("button", { name: "Begin from the template" }).click();
  await page.getByText(/This cell can be used/).waitFor();
  await page.locator(".stage canvas").waitFor();
}

const text = (page: Page): Promise<string> => page.getByLabel("Text of the cell (YAML)").inputValue();
const textHas = (page: Page, words: string): Promise<unknown> =>
  page.waitForFunction((wanted) => (document.querySelector("textarea.tall") as HTMLTextAreaElement).value.includes(wanted), words);
const pointOf = (page: Page, key: string): Promise<[number, number]> =>
  page.evaluate((wanted) => (window as unknown as { snugCell: { pointOf(key: string): [number, number] } }).snugCell.pointOf(wanted), key);
interface Watched {
  frames(): number;
  shown(): number;
  end(): number;
}
const watched = (page: Page): Promise<{ frames: number; shown: number; end: number }> =>
  page.evaluate(() => {
    const watch = (window as unknown as { snugWatch: Watched }).snugWatch;
    return { frames: watch.frames(), shown: watch.shown(), end: watch.end() };
  });

/** Findings that keep somebody from using the page. */
async function serious(page: Page): Promise<string[]> {
  await page.evaluate(axe);
  return page.evaluate(async () => {
    interface Found {
      violations: { id: string; impact: string; nodes: { html: string }[] }[];
    }
    const found = await (window as unknown as { axe: { run(): Promise<Found> } }).axe.run();
    return found.violations.filter(({ impact }) => impact === "serious" || impact === "critical").map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 120)).join(" | ")}`);
  });
}

beforeAll(async () => {
  folder = mkdtempSync(join(tmpdir(), "snug-ui-cell-"));
  writeFileSync(join(folder, "mine.csv"), ORDERS);
  browser = await openBrowser();
  ({ child, address } = await serveWith("ui", folder, "--no-open"));
});
afterEach(() => void errors.splice(0));
afterAll(async () => {
  await browser?.close();
  child?.kill("SIGTERM");
  rmSync(folder, { recursive: true, force: true });
});

describe("the cell of snug ui", () => {
  it("shows what the robot reaches, anew when its base is moved", async () => {
    const page = await openPage();
    await begin(page, "demonstrator");
    await page.getByText("reached: 384 of 384").or(page.getByText(/^reached: \d+ of 384/)).first().waitFor();
    await page.getByText(/All \d+ places of pick are reached/).waitFor();
    await page.getByLabel("Height of the cup").selectOption({ index: 3 });
    await page.getByText("reached: 384 of 384").waitFor();
    await picture(page, "workspace-reach");
    await page.getByRole("combobox", { name: "Part", exact: true }).selectOption("robot");
    await page.getByLabel("x in mm").fill("-1500");
    await textHas(page, "pose: {position: [-1.5, 0.0, 0.0], yaw_deg: 180.0}           # W is the controller's");
    await page.getByText("out of reach: 384 of 384").waitFor();
    await picture(page, "workspace-reach-moved");
    expect(errors).toEqual([]);
    await page.context().close();
  }, PATIENCE);

  it("moves parts by mouse and by keys, in whole steps, and shows mistakes where they are", async () => {
    const page = await openPage();
    await begin(page, "cell");
    await page.getByText("This cell has no robot").waitFor();
    const [x, y] = await pointOf(page, "containers.tote");
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 30, y + 5, { steps: 4 });
    await page.mouse.up();
    await page.waitForFunction(() => !(document.querySelector("textarea.tall") as HTMLTextAreaElement).value.includes("position: [0.45, 0.0, 0.02]"));
    const found = /name: tote, pose: \{position: \[(-?[\d.]+), (-?[\d.]+), 0\.02\]/.exec(await text(page))!;
    expect(found).not.toBeNull();
    for (const number of found.slice(1, 3)) expect(Math.abs(Number(number) * 100 - Math.round(Number(number) * 100))).toBeLessThan(1e-6); // of 10 mm
    expect(await text(page)).toContain("# What is packed into: a tote");
    expect(await page.getByRole("combobox", { name: "Part", exact: true }).inputValue()).toBe("containers.tote");

    const before = Number(await page.getByLabel("x in mm").inputValue());
    await page.getByLabel("Snap to").selectOption("50");
    await page.locator(".stage canvas").focus();
    await page.keyboard.press("ArrowRight");
    await page.waitForFunction((old) => Number((document.querySelectorAll(".cell-left fieldset.numbers input")[0] as HTMLInputElement).value) > old, before);
    expect(Number(await page.getByLabel("x in mm").inputValue()) % 50).toBe(0);
    await page.keyboard.press("PageDown"); // into the bench
    await page.getByText(/overlaps/).waitFor();
    expect(await page.locator(".verdict.bad").innerText()).toContain("tote");
    await page.getByRole("button", { name: /Show line/ }).click();
    await picture(page, "workspace-mistake");
    await page.getByLabel("z in mm").fill("20");
    await page.getByText(/This cell can be used/).waitFor();
    expect(errors).toEqual([]);
    await page.context().close();
  }, PATIENCE);

  it("makes the same cell as one that is written by hand", async () => {
    const page = await openPage();
    await begin(page, "cell");
    await page.getByRole("combobox", { name: "Part", exact: true }).selectOption("containers.tote");
    await page.getByLabel("y in mm").fill("50");
    await textHas(page, "[0.45, 0.05, 0.02]");
    const changes: string[] = []; // as the page says them for the command line
    const keepChange = async (): Promise<void> => {
      changes.push("--set", /--set "(.*)"$/.exec(await page.getByText(/^As a command: snug check cell.yaml --reach/).innerText())![1]!);
    };
    await keepChange();
    await page.getByText(/This cell can be used/).waitFor();
    await page.getByRole("combobox", { name: "Part", exact: true }).selectOption("aligner");
    await page.getByLabel("x in mm").fill("-420");
    await textHas(page, "[-0.42, -0.1, 0.0]");
    await keepChange();
    await page.getByText(/This cell can be used/).waitFor();
    await page.getByLabel("Container height in mm").fill("180");
    await textHas(page, "[0.4, 0.3, 0.18]");
    await keepChange();
    await page.getByLabel("Name of the cell").fill("by-page");
    await page.getByRole("button", { name: "Save cell" }).click();
    await page.getByText("by-page.yaml is saved.").waitFor();
    const hand = readFileSync(join(repository, "scenarios/init/cell.yaml"), "utf8")
      .replace("position: [0.45, 0.0, 0.02]}, inner_size: [0.400, 0.300, 0.200]", "position: [0.450, 0.050, 0.020]}, inner_size: [0.40, 0.30, 0.18]")
      .replace("position: [-0.40, -0.10, 0.0]", "position: [-0.420, -0.100, 0]");
    writeFileSync(join(folder, "by-hand.yaml"), hand);
    const hashOf = (path: string, more: string[] = []): string => {
      const said = snug("pack", path, "--items", join(folder, "mine.csv"), "--sequence", "mine", "--samples", "0", "--json", ...more);
      return (JSON.parse(said) as { state_hash: string }).state_hash;
    };
    const byHand = hashOf(join(folder, "by-hand.yaml"));
    expect(hashOf(join(repository, "scenarios/init/cell.yaml"), changes)).toBe(byHand);
    expect(byHand).toMatch(/^[0-9a-f]{16}$/);
    expect(hashOf(join(folder, "by-page.yaml"))).toBe(byHand);
    expect(errors).toEqual([]);
    await page.context().close();
  }, PATIENCE);
});

describe("templates", () => {
  it("are a UR cell and a gantry, too, whose arms lie in the folder and reach their picks", async () => {
    const page = await openPage();
    for (const [template, arm] of [["ur", "ur5e.urdf"], ["gantry", "gantry.urdf"]] as const) {
      await begin(page, template);
      await textHas(page, `  urdf: ${arm}\n`);
      await page.getByText(/All \d+ places of pick are reached/).waitFor();
      expect(readFileSync(join(folder, arm), "utf8")).toBe(readFileSync(join(repository, "scenarios/robots", arm), "utf8"));
      await picture(page, `workspace-template-${template}`);
    }
    rmSync(join(folder, "gantry.urdf")); // another one is dropped below
    expect(errors).toEqual([]);
    await page.context().close();
  }, PATIENCE);
});

describe("a served cell", () => {
  it("is packed, and drawn with its boxes where they are perceived", async () => {
    const page = await openPage();
    await begin(page, "ur");
    await page.getByRole("button", { name: "Save cell" }).click();
    await page.getByText("ur.yaml is saved.").waitFor();
    const { child: served } = await serveWith("serve", join(folder, "ur.yaml"), "--items", join(folder, "mine.csv"), "--sequence", "mine", "--plant-seed", "1", "--click", `ipc://${folder}/cell`);
    await page.getByRole("tab", { name: "Run" }).click();
    await page.getByRole("combobox", { name: "Cell", exact: true }).selectOption("ur.yaml");
    await page.getByRole("combobox", { name: "Items", exact: true }).selectOption("mine.csv");
    await page.getByLabel("What is packed").selectOption("click");
    await page.getByLabel("Address").fill(`click+ipc://${folder}/cell`);
    await page.getByLabel("Name of the run").fill("served");
    await page.getByText(/snug pack ur.yaml --items mine.csv --sequence mine --plant 'click/).waitFor();
    await page.getByRole("button", { name: "Start", exact: true }).click();
    await page.locator(".plan-stage canvas").waitFor();
    await page.getByText(/2 of 2 packed/).first().waitFor();
    await page.getByText("Solid: as perceived.").waitFor();
    expect(await page.locator(".plan svg").count()).toBe(2);
    await picture(page, "workspace-served");
    served.kill("SIGINT");
    expect(errors).toEqual([]);
    await page.context().close();
  }, PATIENCE);
});

describe("parts of the trade", () => {
  it("are a container and a cup by their names, and an arm that is dropped with its meshes", async () => {
    const page = await openPage();
    await begin(page, "cell");
    await page.getByLabel("Container of the catalogue").selectOption({ label: "Euro container 400 x 300 x 220" });
    await textHas(page, "inner_size: [0.36, 0.26, 0.205]");
    const cup = await page.getByLabel("Cup of the catalogue").locator("option", { hasText: "40 mm, 1.5 folds, foam lip" }).getAttribute("value");
    await page.getByLabel("Cup of the catalogue").selectOption(cup!);
    await textHas(page, "# snug cup estimate --diameter 40 --bellows 1.5 --lip foam");
    const file = (name: string, text: string): { name: string; mimeType: string; buffer: Buffer } => ({ name, mimeType: "text/plain", buffer: Buffer.from(text) });
    const files = page.getByLabel("Choose a URDF and its meshes");
    await files.setInputFiles([file("<img src=x onerror=alert(1)>.urdf", GANTRY)]);
    await page.getByText(/files that are not in the folder: mast\.stl/).waitFor();
    await files.setInputFiles([file("gantry.urdf", GANTRY), file("mast.stl", MAST)]);
    await page.getByText("gantry.urdf is the arm of this cell; tool0 carries the tool.").waitFor();
    await page.getByText(/reached: \d+ of \d+/).first().waitFor();
    expect(await text(page)).toContain("  urdf: gantry.urdf\n");
    expect(readdirSync(folder).filter((name) => /gantry|mast/.test(name))).toEqual(["gantry.urdf", "mast.stl"]);
    expect(readFileSync(join(folder, "gantry.urdf"), "utf8")).not.toContain("/etc/");
    await picture(page, "workspace-parts");
    expect(errors.filter((text) => !/422/.test(text))).toEqual([]);
    await page.context().close();
  }, PATIENCE);
});

describe("a run of snug ui", () => {
  it("is watched in 3D while it goes on, and stops when told", async () => {
    const page = await openPage();
    await page.getByRole("tab", { name: "Run" }).click();
    await page.getByRole("combobox", { name: "Cell", exact: true }).selectOption("by-page.yaml");
    await page.getByRole("combobox", { name: "Items", exact: true }).selectOption("mine.csv");
    await page.getByRole("combobox", { name: "Order", exact: true }).selectOption("long"); // long enough to be stepped into
    await page.getByText(/snug pack by-page.yaml --items mine.csv --sequence long .*--live run-1.live/).waitFor();
    await page.getByLabel("Hold the first box").check(); // it waits, however slow the browser is
    await page.getByRole("button", { name: "Start", exact: true }).click();
    await page.getByText(/is planned and waits for your order/).waitFor();
    await page.getByRole("button", { name: "Choose" }).first().waitFor();
    await picture(page, "workspace-held");
    await page.getByRole("button", { name: "Another place" }).click();
    await page.getByText(/the operator: \S+ elsewhere/).waitFor();
    appendFileSync(join(folder, "run-1.operator"), "ITEM000005 hold\n"); // as a shell would: it waits again, two boxes later
    await page.getByRole("button", { name: "Skip this box" }).click();
    await page.getByText(/skipped: by the operator/).first().waitFor();
    expect(readFileSync(join(folder, "run-1.operator"), "utf8")).toBe("next hold\nITEM000003 elsewhere\nITEM000005 hold\nITEM000003 skip\n");
    await page.locator(".watch .stage canvas").waitFor();
    await page.waitForFunction(() => (window as unknown as { snugWatch: Watched }).snugWatch.shown() > 0.5);
    const first = await watched(page);
    expect(first.frames).toBeGreaterThan(10);
    expect(first.shown).toBeLessThanOrEqual(first.end);
    await page.locator(".live").getByRole("button", { name: "Stop", exact: true }).click();
    await picture(page, "workspace-live");
    expect(await serious(page)).toEqual([]); // with the drawing
    await page.getByText(/interrupted/).first().waitFor();
    expect(errors).toEqual([]);
    await page.context().close();
  }, PATIENCE);

  it("can be used with the aids that an accessibility checker speaks for", async () => {
    const sizes: [number, number][] = [[1280, 720], [390, 800]];
    if (process.env.SNUG_PICTURES) sizes.push([1920, 1080]); // for people to look at
    for (const [width, height] of sizes) {
      const page = await openPage(width, height);
      await begin(page, "demonstrator");
      await page.getByText(/places of pick are reached/).waitFor();
      for (const tab of ["Items", "Cell", "Run", "Compare", "Take away"]) {
        await page.getByRole("tab", { name: tab }).click();
        if (tab === "Items") await page.getByRole("button", { name: "Use the example" }).click();
        if (tab === "Cell" && width > 390) await page.getByText("Cup by its data sheet").click();
        if (tab === "Run") await page.getByRole("button", { name: "Show" }).first().click();
        if (tab === "Compare") await page.getByText("Boxes an hour").first().waitFor();
        expect(await serious(page), `${tab} at ${width}`).toEqual([]);
        expect(await page.evaluate(() => document.documentElement.scrollWidth), tab).toBeLessThanOrEqual(width);
        await picture(page, `workspace-${tab}-${width}`);
      }
      await page.context().close();
    }
  }, 2 * PATIENCE);
});
