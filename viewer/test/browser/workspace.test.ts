// The page of `snug ui` in Chromium, with the program behind it: by visible labels alone, as a person would.

import type { ChildProcess } from "node:child_process";
import { chmodSync, copyFileSync, existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, symlinkSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { strToU8, zipSync } from "fflate";
import type { Browser, Download, Page } from "playwright-core";
import { afterAll, afterEach, beforeAll, describe, expect, it } from "vitest";
import { openBrowser } from "../support/browser";
import { repository, serveAs, serveWith } from "../support/program";

const ORDERS = "order,article,length_mm,width_mm,height_mm,mass_kg\nmine,<img src=x onerror=alert(1)>,180,120,90,0.4\nmine,B,150,120,90,0.3\n";

/** A workbook as spreadsheet programs write it: packed, words in a list of their own. */
function xlsx(rows: (string | number)[][]): Uint8Array {
  const words = rows.flat().filter((cell): cell is string => typeof cell === "string");
  const text = (word: string): string => word.replace(/&/g, "&amp;").replace(/</g, "&lt;");
  const main = 'xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"', office = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
  const sheet = rows.map((row, r) => `<row r="${r + 1}">${row.map((cell, k) => `<c r="${String.fromCharCode(65 + k)}${r + 1}"${typeof cell === "string" ? ` t="s"><v>${words.indexOf(cell)}` : `><v>${cell}`}</v></c>`).join("")}</row>`).join("");
  return zipSync({
    "xl/workbook.xml": strToU8(`<workbook ${main} xmlns:r="${office}"><sheets><sheet name="x" sheetId="1" state="hidden" r:id="rId9"/><sheet name="Orders" sheetId="2" r:id="rId3"/></sheets></workbook>`),
    "xl/_rels/workbook.xml.rels": strToU8('<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="rId3" Target="worksheets/sheet2.xml"/></Relationships>'),
    "xl/sharedStrings.xml": strToU8(`<sst ${main}>${words.map((word) => `<si><r><t>${text(word.slice(0, 2))}</t></r><r><t xml:space="preserve">${text(word.slice(2))}</t></r></si>`).join("")}</sst>`),
    "xl/worksheets/sheet2.xml": strToU8(`<worksheet ${main}><sheetData>${sheet}</sheetData></worksheet>`),
  });
}

function ods(rows: (string | number)[][]): Uint8Array {
  const cells = rows.map((row) => `<t:table-row>${row.map((cell) => (typeof cell === "number" ? `<t:table-cell o:value-type="float" o:value="${cell}"><x:p>${cell}</x:p></t:table-cell>` : `<t:table-cell o:value-type="string"><x:p>${cell}</x:p></t:table-cell>`)).join("")}</t:table-row>`).join("");
  const urn = "urn:oasis:names:tc:opendocument:xmlns";
  return zipSync({ "content.xml": strToU8(`<o:document-content xmlns:o="${urn}:office:1.0" xmlns:t="${urn}:table:1.0" xmlns:x="${urn}:text:1.0"><o:body><o:spreadsheet><t:table>${cells}<t:table-row t:number-rows-repeated="1048000"><t:table-cell t:number-columns-repeated="16384"/></t:table-row></t:table></o:spreadsheet></o:body></o:document-content>`) });
}

/** Of a file that the page gives; the browser may be of another process. */
async function content(download: Download): Promise<Buffer> {
  const parts: Buffer[] = [];
  for await (const part of await download.createReadStream()) parts.push(Buffer.from(part as Uint8Array));
  return Buffer.concat(parts);
}

let browser: Browser;
let folder = "";
let child: ChildProcess | null = null;
let address = "";
const errors: string[] = [];

async function serve(): Promise<void> {
  ({ child, address } = await serveWith("ui", folder, "--no-open"));
}

async function end(signal: NodeJS.Signals): Promise<void> {
  const ended = new Promise((resolve) => child!.once("exit", resolve));
  child!.kill(signal);
  await ended;
  child = null;
}

async function openPage(width = 1280, height = 720, at = address): Promise<Page> {
  const context = await browser.newContext({ viewport: { width, height } });
  const page = await context.newPage();
  page.on("pageerror", (error) => errors.push(error.message));
  page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
  page.on("request", (request) => !/^(blob|data):/.test(request.url()) && !request.url().startsWith(new URL(at).origin) && errors.push(request.url()));
  page.on("dialog", (dialog) => void dialog.accept());
  await page.goto(at);
  await page.waitForFunction(() => (window as unknown as { snugReady?: boolean }).snugReady === true);
  return page;
}

/** For people to look at, where SNUG_PICTURES asks for them. */
async function picture(page: Page, name: string): Promise<void> {
  if (process.env.SNUG_PICTURES) await page.screenshot({ path: `test/out/${name}.png` });
}

const ask = (path: string, init: RequestInit = {}): Promise<Response> => fetch(new URL(path, address), init);
/** With the token, as the page has it in its cookie. */
const askKnown = (path: string, init: RequestInit = {}): Promise<Response> => fetch(`${new URL(path, address)}${new URL(address).search}`, init);

beforeAll(async () => {
  folder = mkdtempSync(join(tmpdir(), "snug-ui-"));
  browser = await openBrowser();
  await serve();
});
afterEach(() => void errors.splice(0));
afterAll(async () => {
  await browser?.close();
  if (child) await end("SIGTERM");
  rmSync(folder, { recursive: true, force: true });
});

describe("the page of snug ui", () => {
  it("leads from nothing to the first packed own order by its labels", async () => {
    const page = await openPage();
    let actions = 0;
    const click = async (role: "button" | "tab", name: string): Promise<void> => {
      ++actions;
      await page.getByRole(role, { name, exact: true }).click();
    };
    const shows = (text: string | RegExp): Promise<void> => page.getByText(text).first().waitFor();

    ++actions;
    await page.getByLabel("Choose a sheet (CSV, XLSX, ODS)").setInputFiles({ name: "my orders (1).csv", mimeType: "text/csv", buffer: Buffer.from(ORDERS.replace("180", "18x")) });
    await shows(/length_mm/);
    expect(await page.locator("tr.bad").innerText()).toContain("18x");
    ++actions;
    await page.getByLabel("Text of the items").fill(ORDERS);
    await shows("2 boxes; orders: mine");
    await click("button", "Save items");
    await shows("my-orders-1-.csv is saved.");
    await picture(page, "workspace-items");

    await click("tab", "Cell");
    await click("button", "Begin from the template");
    await shows(/This cell can be used/);
    ++actions;
    await page.getByLabel("Container height in mm").fill("180");
    await page.waitForFunction(() => document.querySelector("textarea.tall") !== null && (document.querySelector("textarea.tall") as HTMLTextAreaElement).value.includes("[0.4, 0.3, 0.18]"));
    await click("button", "Save cell");
    await shows("cell.yaml is saved.");
    await picture(page, "workspace-cell");

    await click("tab", "Run");
    await shows(/snug pack cell.yaml --items my-orders-1-.csv --sequence mine --plant-seed 1 --log run-1.jsonl/);
    await click("button", "Start");
    await shows("run-1: done");
    await shows(/2 of 2 packed/);
    await picture(page, "workspace-run");
    expect(actions).toBeLessThanOrEqual(25);
    expect(readFileSync(join(folder, "run-1.txt"), "utf8").split("\n")[0]).toBe(
      "$ snug pack cell.yaml --items my-orders-1-.csv --sequence mine --plant-seed 1 --log run-1.jsonl --operator run-1.operator --program run-1.program.csv --live run-1.live -o run-1.h5");
    expect(readFileSync(join(folder, "cell.yaml"), "utf8")).toContain("# What is packed into: a tote"); // comments stay

    await shows("Candidates (");
    expect(await page.locator(".plan svg").count()).toBe(2);

    await click("tab", "Compare");
    await shows("Boxes an hour");
    const [csv] = await Promise.all([page.waitForEvent("download"), click("button", "Download CSV")]);
    expect((await content(csv)).toString("utf8")).toMatch(/^,run-1\r\nState,done\r\n/);
    await page.getByLabel("An hour of the cell").fill("3600");
    await shows("Cost of a packed box");
    await page.waitForFunction(() => /^\d+\.\d{3}$/.test([...document.querySelectorAll("table.compare")].find((one) => one.textContent!.includes("Cost of a packed box"))!.querySelector("tr:last-child td:last-child")!.textContent!));
    const [book] = await Promise.all([page.waitForEvent("download"), click("button", "Download workbook (.xlsx)")]);
    expect((await content(book)).subarray(0, 4).toString("latin1")).toBe("PK\x03\x04");
    await click("tab", "Take away");
    for (const [button, words] of [["Make a picture", /The picture of run-1 is in the folder/], ["Make a GLB", /The GLB of run-1 is in the folder/]] as const) {
      await click("button", button);
      await shows(words);
    }
    expect(readFileSync(join(folder, "run-1.png")).subarray(1, 4).toString("latin1")).toBe("PNG");
    expect(readFileSync(join(folder, "run-1.glb")).subarray(0, 4).toString("latin1")).toBe("glTF");
    // Asked without drawing it, which takes seconds without a graphics card: scripts, but no address of its own.
    const path = await page.getByRole("link", { name: "Open the report" }).getAttribute("href");
    const report = await askKnown(path!);
    expect(report.headers.get("Content-Security-Policy")).toMatch(/^sandbox allow-scripts (?!.*allow-same-origin)/);
    expect(await report.text()).toContain('id="snug-recording-0"');
    expect(existsSync(join(folder, "run-1.html"))).toBe(true);

    await page.setViewportSize({ width: 390, height: 800 });
    for (const tab of ["Items", "Cell", "Run", "Compare", "Take away"]) {
      await click("tab", tab);
      expect(await page.evaluate(() => document.documentElement.scrollWidth), tab).toBeLessThanOrEqual(390);
    }
    await click("tab", "Run");
    await picture(page, "workspace-390");
    await page.reload();
    await shows("2 of 2 packed, ");
    expect(errors).toEqual([]);
    await page.context().close();
  });

  it("takes workbooks as people keep them, and asks for units that they do not say", async () => {
    const page = await openPage();
    const choose = (name: string, bytes: Uint8Array): Promise<void> =>
      page.getByLabel("Choose a sheet (CSV, XLSX, ODS)").setInputFiles({ name, mimeType: "application/octet-stream", buffer: Buffer.from(bytes) });
    const orders = page.getByLabel("Text of the items");
    await choose("Bestellung.xlsx", xlsx([["Artikel", "Länge", "Breite", "Höhe", "Gewicht", "Anzahl"], ["Kaffee; <b>", 20, 15, 10.5, 500, 2], ["Tee", "18,5", 12, 9, 400, 1]]));
    await page.getByRole("dialog", { name: "In which unit are the lengths of this sheet?" }).waitFor();
    await picture(page, "workspace-question");
    await page.getByRole("button", { name: "cm: the first box is 200 x 150 x 105 mm" }).click();
    await page.getByRole("button", { name: "g: the first box is 0.5 kg" }).click();
    await page.getByText("3 boxes; orders: Bestellung").waitFor();
    expect(await orders.inputValue()).toBe("article,length_mm,width_mm,height_mm,mass_kg,count\nKaffee; <b>,200,150,105,0.5,2\nTee,185,120,90,0.4,1\n");
    await page.getByText(/snug items read Bestellung.csv --length-unit cm --mass-unit g/).waitFor();
    await choose("plan.ods", ods([["sku", "size in mm", "weight in kg"], ["A", "200 x 150 x 100", 0.5]]));
    await page.getByText("1 boxes; orders: plan").waitFor();
    await choose("two.csv", Buffer.from("length_mm,width_mm,height_mm,mass_kg\n1x,1,1,1\n10,10,10,1\n10,10,10,-1\n"));
    await page.getByText(/^2 lines with mistakes/).waitFor();
    expect(await page.locator("tr.bad td.wrong").allInnerTexts()).toEqual(["1x", "-1"]);
    const bomb = zipSync({ "xl/workbook.xml": new Uint8Array(40 << 20) });
    expect(bomb.length).toBeLessThan(100_000);
    new DataView(bomb.buffer).setUint32(22, 10, true); // it says that it is small
    await choose("bomb.xlsx", bomb);
    await page.getByText(/bomb.xlsx cannot be read. It unpacks to more than/).waitFor();
    await choose("entities.xlsx", zipSync({ "xl/workbook.xml": strToU8('<!DOCTYPE a [<!ENTITY b "bbb">]><workbook>&b;</workbook>') }));
    await page.getByText(/entities.xlsx cannot be read. It has definitions of its own/).waitFor();
    await choose("torn.xlsx", xlsx([["a"]]).subarray(0, 300));
    await page.getByText(/torn.xlsx cannot be read/).waitFor();
    expect(errors).toEqual([]);
    await page.context().close();
  });

  it("can be worked in by keys, and gives every field a name", async () => {
    const page = await openPage();
    await page.getByRole("tab", { name: "Items" }).focus();
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("ArrowRight");
    expect(await page.getByRole("tab", { selected: true }).innerText()).toBe("Run");
    await page.keyboard.press("Tab");
    expect(await page.evaluate(() => document.activeElement!.closest("label")?.innerText)).toContain("Cell");
    const unnamed = await page.evaluate(() => [...document.querySelectorAll("input, select, textarea, button, a")]
      .filter((one) => !(one as HTMLInputElement).labels?.[0]?.textContent && !one.textContent && !one.getAttribute("aria-label") && !one.closest("[hidden]"))
      .map((one) => one.outerHTML));
    expect(unnamed).toEqual([]);
    await page.context().close();
  });

  it("asks before it saves over what another page saved", async () => {
    const pages = [await openPage(), await openPage()];
    for (const page of pages) {
      await page.getByRole("tab", { name: "Cell" }).click();
      await page.getByLabel("Open a cell of the folder").selectOption("cell.yaml");
      await page.waitForFunction(() => (document.querySelector("textarea.tall") as HTMLTextAreaElement).value.includes("[0.4, 0.3, 0.18]"));
    }
    const saves = async (page: Page, height: string): Promise<void> => {
      await page.getByLabel("Container height in mm").fill(height);
      await page.waitForFunction((wanted) => (document.querySelector("textarea.tall") as HTMLTextAreaElement).value.includes(wanted), `[0.4, 0.3, 0.${height.slice(0, 2)}]`);
      await page.getByRole("button", { name: "Save cell" }).click();
    };
    const [one, other] = pages as [Page, Page];
    await saves(one, "170");
    await one.getByText("cell.yaml is saved.").waitFor();
    await saves(other, "190");
    await other.getByRole("dialog", { name: /another cell.yaml/ }).waitFor();
    await other.getByRole("button", { name: "Leave it as it is" }).click();
    await other.getByText(/cell.yaml is left as it was/).waitFor();
    expect(readFileSync(join(folder, "cell.yaml"), "utf8")).toContain("[0.4, 0.3, 0.17]");
    await other.getByRole("button", { name: "Save cell" }).click();
    await other.getByRole("button", { name: "Save over it" }).click();
    await other.getByText("cell.yaml is saved.").waitFor();
    expect(readFileSync(join(folder, "cell.yaml"), "utf8")).toContain("[0.4, 0.3, 0.19]");
    expect(errors).toEqual([]);
    for (const page of pages) await page.context().close();
  });

  it("says so when the program was killed in the middle of a run, and goes on with its folder", async () => {
    const page = await openPage();
    await page.getByRole("tab", { name: "Run" }).click();
    await page.getByRole("combobox", { name: "Items", exact: true }).selectOption("my-orders-1-.csv");
    await page.getByText(/--sequence mine .*--log run-2.jsonl/).first().waitFor();
    await page.getByRole("button", { name: "Start", exact: true }).click();
    await page.getByText("run-2: running").waitFor();
    await end("SIGKILL");
    await page.getByText(/The program does not answer. Is it still running/).waitFor();
    await page.context().close();
    errors.splice(0);
    await serve();
    const again = await openPage();
    await again.getByRole("tab", { name: "Run" }).click();
    await again.getByRole("row", { name: /run-2 done/ }).waitFor(); // it was not killed with the program
    await again.context().close();
  });

  it("says that a folder can only be read, and leaves nothing there", async () => {
    const shut = mkdtempSync(join(tmpdir(), "snug-ui-shut-"));
    for (const ending of [".jsonl", ".h5", ".txt"]) copyFileSync(join(folder, `run-1${ending}`), join(shut, `run-1${ending}`));
    copyFileSync(join(repository, "scenarios/init/cell.yaml"), join(shut, "cell.yaml"));
    chmodSync(shut, 0o555);
    const before = readdirSync(shut);
    const other = await serveAs(process.getuid!() === 0 ? 65534 : undefined, "ui", shut, "--no-open"); // root may write everywhere
    const page = await openPage(1280, 720, other.address);
    await page.getByText("This folder can only be read").waitFor();
    await page.getByRole("tab", { name: "Cell" }).click();
    await page.getByLabel("Template").selectOption("ur");
    await page.getByRole("button", { name: "Begin from the template" }).click();
    await page.getByText("This template needs ur5e.urdf in the folder, which can only be read.").waitFor();
    await page.getByLabel("Open a cell of the folder").selectOption("cell.yaml");
    await page.getByText(/This cell can be used/).waitFor();
    await page.getByRole("button", { name: "Save cell" }).click();
    await page.getByText(/^cell.yaml: could not be written: /).waitFor();
    await page.getByRole("tab", { name: "Run" }).click();
    await page.getByRole("row", { name: /run-1 done/ }).waitFor();
    await page.getByRole("button", { name: "Start", exact: true }).click();
    await page.getByText(/^run-2.txt: could not be written: /).waitFor();
    await page.getByRole("tab", { name: "Take away" }).click();
    await page.getByRole("button", { name: "Make a GLB" }).click();
    await page.getByText("run-1.glb: could not be written: this folder can only be read").waitFor();
    const report = await fetch(`${new URL(other.address).origin}/api/1/runs/run-1/report${new URL(other.address).search}`);
    expect(await report.text()).toContain('id="snug-recording-0"'); // made elsewhere, not kept
    expect(readdirSync(shut)).toEqual(before);
    expect(errors.filter((text) => !/507/.test(text))).toEqual([]);
    await page.context().close();
    other.child.kill("SIGTERM");
    chmodSync(shut, 0o755);
    rmSync(shut, { recursive: true });
  });

  it("answers who knows the token only, and nothing out of the folder", async () => {
    writeFileSync(join(folder, "..", "snug-ui-secret.yaml"), "secret");
    symlinkSync(join(folder, "..", "snug-ui-secret.yaml"), join(folder, "link.yaml"));
    for (const path of ["/", "/workspace.js", "/api/1/folder"]) expect((await ask(path)).status).toBe(403);
    expect((await askKnown("/api/1/folder")).status).toBe(200);
    expect((await askKnown("/api/1/folder", { headers: { "Sec-Fetch-Site": "cross-site" } })).status).toBeGreaterThanOrEqual(200);
    const put = (name: string, headers: Record<string, string>, body = "name: x\n"): Promise<Response> => askKnown(`/api/1/files/${name}`, { method: "PUT", headers, body });
    const right = { "X-Snug": "1", "Content-Type": "text/plain" };
    expect((await put("a.yaml", { "Content-Type": "text/plain" })).status).toBe(403);
    expect((await put("a.yaml", { ...right, "Content-Type": "application/x-www-form-urlencoded" })).status).toBe(415);
    expect((await put("..%2fsnug-ui-other.yaml", right)).status).toBeGreaterThanOrEqual(404);
    expect((await put("link.yaml", right)).status).toBe(422);
    expect((await put("a.yaml", right, "x".repeat(5 << 20))).status).toBe(413);
    expect((await askKnown("/api/1/files/link.yaml")).status).toBe(422);
    const page = await askKnown("/");
    expect(page.headers.get("Content-Security-Policy")).toMatch(/^default-src 'none'; script-src 'self';(?!.*unsafe)/);
    expect(existsSync(join(folder, "a.yaml"))).toBe(false);
    expect(existsSync(join(folder, "..", "snug-ui-other.yaml"))).toBe(false);
    rmSync(join(folder, "..", "snug-ui-secret.yaml"));
  });
});
