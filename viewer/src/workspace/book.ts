// Book: the first sheet of a workbook (.xlsx of ECMA-376, .ods of ISO 26300) as a CSV. Packed files are unpacked piece by piece
// and no farther than they may go, whatever they say of themselves; the browser itself reads the XML.

import { Unzip, UnzipInflate } from "fflate";

const LARGEST = 8 * 1024 * 1024; // bytes of a workbook
const MOST_UNPACKED = 32 * 1024 * 1024; // bytes of what is read of it
const MOST_FILES = 1000;
const PIECE = 16 * 1024; // bytes that are unpacked at a time: to 16 MB at most
const MOST_ROWS = 20_000;
const MOST_COLUMNS = 100;

export class BookError extends Error {}

/** Files of a ZIP that are wanted, as text. */
export function unpack(bytes: Uint8Array, isWanted: (name: string) => boolean): Map<string, string> {
  if (bytes.length > LARGEST) throw new BookError(`It has ${bytes.length} bytes; at most ${LARGEST} can be taken.`);
  const found = new Map<string, Uint8Array[]>();
  let size = 0, files = 0, trouble = "";
  const unzip = new Unzip((file) => {
    if (++files > MOST_FILES) trouble = `It has more than ${MOST_FILES} files within.`;
    if (trouble || !isWanted(file.name) || found.has(file.name)) return;
    const pieces: Uint8Array[] = [];
    found.set(file.name, pieces);
    file.ondata = (error, data) => {
      if (error) trouble ||= "It is damaged.";
      else if ((size += data.length) > MOST_UNPACKED) trouble ||= `It unpacks to more than ${MOST_UNPACKED} bytes.`;
      if (!trouble) pieces.push(data);
    };
    file.start();
  });
  unzip.register(UnzipInflate);
  try {
    for (let at = 0; at < bytes.length && !trouble; at += PIECE) unzip.push(bytes.subarray(at, at + PIECE), at + PIECE >= bytes.length);
  } catch {
    trouble ||= "It is damaged.";
  }
  if (trouble) throw new BookError(trouble);
  const decoder = new TextDecoder();
  return new Map([...found].map(([name, pieces]) => [name, pieces.map((piece, k) => decoder.decode(piece, { stream: k + 1 < pieces.length })).join("")]));
}

function parse(text: string | undefined): Document | null {
  if (text === undefined) return null;
  if (/<!(DOCTYPE|ENTITY)/i.test(text)) throw new BookError("It has definitions of its own (DOCTYPE), which no spreadsheet program writes.");
  const xml = new DOMParser().parseFromString(text, "application/xml");
  if (xml.querySelector("parsererror")) throw new BookError("It is damaged.");
  return xml;
}

const all = (from: Document | Element, name: string): Element[] => [...from.getElementsByTagNameNS("*", name)];
const attribute = (of: Element, name: string): string | null => [...of.attributes].find((one) => one.localName === name)?.value ?? null;

/** As people see it: 0.1 + 0.2 is 0.3. */
function numberText(text: string): string {
  const value = Number(text);
  return text.trim() === "" || !Number.isFinite(value) ? text : String(Number(value.toPrecision(12)));
}

function columnOf(place: string): number {
  let column = 0;
  for (const letter of /^[A-Z]+/.exec(place)?.[0] ?? "") column = 26 * column + letter.charCodeAt(0) - 64;
  return column - 1;
}

function put(rows: string[][], row: number, column: number, word: string): void {
  if (word === "" || column < 0 || column >= MOST_COLUMNS) return;
  if (row >= MOST_ROWS) throw new BookError(`It has more than ${MOST_ROWS} rows.`);
  const line = (rows[row] ??= []);
  line[column] = word;
}

function rowsOfXlsx(files: Map<string, string>): string[][] {
  const strings = all(parse(files.get("xl/sharedStrings.xml")) ?? new Document(), "si").map((one) =>
    all(one, "t").filter((text) => text.parentElement?.localName !== "rPh").map((text) => text.textContent).join(""));
  const first = all(parse(files.get("xl/workbook.xml")) ?? new Document(), "sheet").find((one) => (attribute(one, "state") ?? "visible") === "visible");
  const target = all(parse(files.get("xl/_rels/workbook.xml.rels")) ?? new Document(), "Relationship")
    .find((one) => attribute(one, "Id") === (first && first.getAttributeNS("http://schemas.openxmlformats.org/officeDocument/2006/relationships", "id")));
  const path = (target ? attribute(target, "Target") ?? "" : "").replace(/^\/?(xl\/)?/, "xl/");
  const sheet = parse(files.get(path));
  if (!sheet) throw new BookError("It has no sheet that can be read.");
  const rows: string[][] = [];
  all(sheet, "row").forEach((row, k) => {
    const number = Number(attribute(row, "r") ?? k + 1) - 1;
    all(row, "c").forEach((cell, i) => {
      const kind = attribute(cell, "t") ?? "n";
      const value = all(cell, "v")[0]?.textContent ?? "";
      const word = kind === "s" ? strings[Number(value)] ?? "" : kind === "inlineStr" ? all(cell, "t").map((text) => text.textContent).join("") : kind === "n" ? numberText(value) : value;
      put(rows, number, attribute(cell, "r") ? columnOf(attribute(cell, "r")!) : i, word);
    });
  });
  return rows;
}

function rowsOfOds(files: Map<string, string>): string[][] {
  const table = all(parse(files.get("content.xml")) ?? new Document(), "table")[0];
  if (!table) throw new BookError("It has no sheet that can be read.");
  const rows: string[][] = [];
  let row = 0;
  for (const one of all(table, "table-row")) {
    const times = Math.max(1, Number(attribute(one, "number-rows-repeated") ?? 1));
    const words: [number, string][] = [];
    let column = 0;
    for (const cell of one.children) {
      const word = attribute(cell, "value-type") === "float" ? numberText(attribute(cell, "value") ?? "") : all(cell, "p").map((text) => text.textContent).join(" ");
      const repeated = Math.max(1, Number(attribute(cell, "number-columns-repeated") ?? 1));
      for (let k = 0; word !== "" && k < repeated && column + k < MOST_COLUMNS; ++k) words.push([column + k, word]);
      column += repeated;
    }
    for (let k = 0; words.length > 0 && k < times; ++k) for (const [at, word] of words) put(rows, row + k, at, word);
    row += times;
  }
  return rows;
}

const quoted = (word: string): string => (/[",;\t\r\n]/.test(word) ? `"${word.replace(/[\r\n]+/g, " ").replace(/"/g, '""')}"` : word);

/** The first sheet as a CSV with commas; rows before its first one are left out. */
export function csvOfBook(bytes: Uint8Array): string {
  const isXlsx = (name: string): boolean => /^xl\/(workbook\.xml|sharedStrings\.xml|_rels\/workbook\.xml\.rels|worksheets\/[^/]+\.xml)$/.test(name);
  const files = unpack(bytes, (name) => isXlsx(name) || name === "content.xml");
  const rows = files.has("content.xml") ? rowsOfOds(files) : rowsOfXlsx(files);
  const filled = Array.from(rows, (row) => Array.from(row ?? [], (word) => word ?? ""));
  const first = filled.findIndex((row) => row.length > 0);
  if (first < 0) throw new BookError("Its first sheet is empty.");
  const width = Math.max(...filled.map((row) => row.length));
  return filled.slice(first).map((row) => (row.length === 0 ? "" : Array.from({ length: width }, (_, k) => quoted(row[k] ?? "")).join(","))).join("\n") + "\n";
}
