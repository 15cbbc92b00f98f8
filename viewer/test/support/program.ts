// The program under test, from the shell, and its tables of numbers.

import { spawn, spawnSync, type ChildProcess } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

export const repository = join(dirname(fileURLToPath(import.meta.url)), "../../..");
const program = process.env.SNUG || join(repository, "build/snug");

export function snug(...words: string[]): string {
  if (!existsSync(program)) throw new Error(`${program} is missing: build it, or tell where it is in SNUG`);
  const done = spawnSync(program, words, { encoding: "utf8" });
  if (done.status !== 0) throw new Error(`snug ${words.join(" ")}: ${done.stderr || done.error}`);
  return done.stdout;
}

/** Starts a program that serves, and waits for the address that it tells. */
export const serveWith = (...words: string[]): Promise<{ child: ChildProcess; address: string }> => serveAs(undefined, ...words);

/** As somebody else; undefined: as who runs the tests. */
export async function serveAs(uid: number | undefined, ...words: string[]): Promise<{ child: ChildProcess; address: string }> {
  const child = spawn(program, words, { stdio: ["ignore", "ignore", "pipe"], uid });
  let told = "";
  const address = await new Promise<string>((resolve, reject) => {
    child.on("exit", (code) => reject(new Error(`snug ${words.join(" ")} ended with ${code}: ${told}`)));
    child.stderr!.on("data", (text: Buffer) => {
      told += text.toString();
      const found = /(?:showing|serving .*) at (\S+)/.exec(told);
      if (found) resolve(found[1]!);
    });
  });
  return { child, address };
}

/** The table of `snug simulate --csv`: columns by name; a name is 1, what is left empty or is no number NaN. */
export function readTable(path: string): Map<string, number[]> {
  const [head, ...lines] = readFileSync(path, "utf8").trimEnd().split("\n");
  const columns = head!.split(";").map((name): [string, number[]] => [name, []]);
  for (const line of lines) line.split(";").forEach((cell, k) => columns[k]![1].push(valueOf(cell)));
  return new Map(columns);
}

function valueOf(cell: string): number {
  if (cell === "" || /^-?(nan|inf)/i.test(cell)) return NaN;
  return /^[A-Za-z]/.test(cell) ? 1 : Number(cell);
}

/** X_WB of a body at a row: position, and quaternion child -> parent (the table has its inverse). */
export function poseIn(table: Map<string, number[]>, body: string, row: number): { p: number[]; quat_wxyz: number[] } {
  const at = (name: string): number => table.get(`${body.toLowerCase()}_FloatingBase_${name}`)![row]!;
  const [w, x, y, z] = ["w", "x", "y", "z"].map((axis) => at(`orientation_${axis}`));
  return { p: ["x", "y", "z"].map((axis) => at(`position_${axis}`)), quat_wxyz: [w!, -x!, -y!, -z!] };
}
