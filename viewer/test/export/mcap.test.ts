// MCAP as snug writes it, read by the format's own indexed reader and compared with the same recording's CSV table. Messages as protocol
// buffers are compared with these by tests/mcap_test.py.

import { spawnSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { McapStreamReader } from "@mcap/core";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { demonstrator, messagesOf, opened, program, repository, snug, unpack, type Json, type Message } from "../support/export";

let folder = "";
let bytes: Uint8Array;
let rows: Record<string, string>[] = [];
let messages: Message[] = [];
let schemas: Map<string, Json>;

const on = (topic: string): Message[] => messages.filter((message) => message.topic === topic);
const numbers = (row: Record<string, string>, ...names: string[]): number[] => names.map((name) => Number(row[name]));

/** The table has the rotation world -> body, and another sign perhaps. */
function expectRotation(q: Json, row: Record<string, string>, prefix: string): void {
  const table = numbers(row, ...["w", "x", "y", "z"].map((c) => `${prefix}_orientation_${c}`)) as [number, number, number, number];
  const sign = q.w * table[0] - q.x * table[1] - q.y * table[2] - q.z * table[3] < 0 ? -1 : 1;
  const unsigned = (v: number): number => v + 0; // 0 for -0
  expect([q.w, q.x, q.y, q.z].map(unsigned)).toEqual([sign * table[0], -sign * table[1], -sign * table[2], -sign * table[3]].map(unsigned));
}

function expectPosition(p: Json, row: Record<string, string>, prefix: string): void {
  expect([p.x, p.y, p.z]).toEqual(numbers(row, ...["x", "y", "z"].map((c) => `${prefix}_position_${c}`)));
}

beforeAll(() => {
  folder = mkdtempSync(join(tmpdir(), "snug-mcap-"));
  const at = (name: string): string => join(folder, name);
  snug("program", demonstrator, join(repository, "scenarios/demo-placements.yaml"), "--sequence", "1", "-o", at("p.csv"));
  snug("simulate", demonstrator, "--program", at("p.csv"), "--sequence", "1", "--until", "45", "-o", at("run.h5"));
  snug("export", at("run.h5"), "--format", "mcap", "--encoding", "json", "-o", at("run.mcap"));
  snug("export", at("run.h5"), "--format", "csv", "-o", at("run.csv"));
  bytes = readFileSync(at("run.mcap"));
  const lines = readFileSync(at("run.csv"), "utf8").trim().split("\n").map((line) => line.split(";"));
  const names = lines.shift()!;
  rows = lines.map((cells) => Object.fromEntries(names.map((name, i) => [name, cells[i]!])));
}, 120_000);
afterAll(() => rmSync(folder, { recursive: true, force: true }));

describe("an MCAP export", () => {
  it("opens in the indexed reader, with statistics that count what is there", async () => {
    const reader = await opened(bytes);
    messages = await messagesOf(reader);
    schemas = new Map([...reader.schemasById.values()].map((s) => [s.name, JSON.parse(Buffer.from(s.data).toString("utf8"))]));
    expect(messages.length).toBe(Number(reader.statistics!.messageCount));
    expect(reader.statistics!.chunkCount).toBe(reader.chunkIndexes.length);
    expect(reader.chunkIndexes.length).toBeGreaterThan(5);
    expect([...schemas.keys()].sort()).toEqual(
      ["foxglove.FrameTransforms", "foxglove.Log", "foxglove.PoseInFrame", "foxglove.SceneUpdate", "geometry_msgs/TwistStamped",
        "geometry_msgs/WrenchStamped", "snug.CupState", "snug.ProgramState", "snug.SolverState"]);
  });

  it("passes the streaming reader with all checksums", () => {
    const reader = new McapStreamReader({ validateCrcs: true, decompressHandlers: unpack });
    reader.append(bytes);
    let count = 0;
    for (let record; (record = reader.nextRecord()); ) count += record.type === "Message" ? 1 : 0;
    expect(reader.done()).toBe(true);
    expect(count).toBe(messages.length);
  });

  it("has a message of each frame on each topic, in times that grow", () => {
    for (const topic of ["/tf", "/tool/pose", "/tool/pose_command", "/tool/twist", "/cup/state", "/cup/wrench", "/flange/wrench", "/solver"]) {
      const list = on(topic);
      expect(list.length, topic).toBe(rows.length);
      list.forEach((message, i) => expect(message.ns).toBe(BigInt(Math.round(1e9 * Number(rows[i]!.t)))));
    }
    const last = new Map<string, bigint>();
    for (const { topic, ns } of messages) {
      expect(ns > (last.get(topic) ?? -1n), topic).toBe(true);
      last.set(topic, ns);
    }
  });

  it("has the tool, its command and all boxes where the recording has them, to the last bit", () => {
    const bodies = Object.keys(rows[0]!).flatMap((name) => /^(.*)_FloatingBase_position_x$/.exec(name)?.[1] ?? []);
    let compared = 0;
    on("/tf").forEach(({ data }, i) => {
      const row = rows[i]!;
      const frames = new Map<string, Json>(data.transforms.map((t: Json) => [t.child_frame_id, t]));
      expectPosition(frames.get("E")!.translation, row, "tool");
      expectRotation(frames.get("E")!.rotation, row, "tool");
      expect(frames.has("S")).toBe(row.cup_attached !== "");
      if (frames.has("S")) expectPosition(frames.get("S")!.translation, row, "cup");
      for (const body of bodies) {
        const frame = frames.get(body) ?? frames.get(body.toUpperCase());
        if (body.toLowerCase().startsWith("box")) expect(frame !== undefined, body).toBe(row[`${body}_FloatingBase_position_x`] !== "");
        if (!frame) continue;
        expect(frame.parent_frame_id).toBe("W");
        expectPosition(frame.translation, row, `${body}_FloatingBase`);
        expectRotation(frame.rotation, row, `${body}_FloatingBase`);
        ++compared;
      }
    });
    expect(compared).toBeGreaterThan(2 * rows.length);
    on("/tool/pose_command").forEach(({ data }, i) => {
      expect(data.frame_id).toBe("W");
      expectPosition(data.pose.position, rows[i]!, "tool_command");
      expectRotation(data.pose.orientation, rows[i]!, "tool_command");
    });
  });

  it("has the wrenches, the twist, the cup and the solver of the recording", () => {
    const wrench = ({ wrench: F }: Json): number[] => [F.torque.x, F.torque.y, F.torque.z, F.force.x, F.force.y, F.force.z];
    const named = (prefix: string): string[] => ["cx", "cy", "cz", "fx", "fy", "fz"].map((c) => `${prefix}_${c}`);
    const lists = ["/flange/wrench", "/cup/wrench", "/tool/twist", "/cup/state", "/solver"].map(on);
    rows.forEach((row, i) => {
      expect(wrench(lists[0]![i]!.data)).toEqual(numbers(row, ...named("UR10FTSensor")));
      expect(wrench(lists[1]![i]!.data)).toEqual(numbers(row, ...named("cup_wrench")));
      const { linear, angular } = lists[2]![i]!.data.twist;
      expect([angular.x, angular.y, angular.z, linear.x, linear.y, linear.z]).toEqual(
        numbers(row, ...["wx", "wy", "wz", "vx", "vy", "vz"].map((c) => `tool_velocity_${c}`)));
      const cup = lists[3]![i]!.data;
      expect([Number(cup.vacuum), Number(cup.blow_off), cup.pressure_gauge_pa]).toEqual(numbers(row, "vacuum", "blow_off", "pressure_gauge"));
      expect(cup.attached_body.toLowerCase()).toBe(row.cup_attached); // the table's names are those of mc_rtc
      if (row.cup_attached) expect([cup.length_m, cup.bend_rad]).toEqual(numbers(row, "cup_length", "cup_bend"));
      const solver = lists[4]![i]!.data;
      expect([solver.residual, solver.iterations, solver.contacts]).toEqual(numbers(row, "solver_residual", "solver_iterations", "contacts"));
    });
  });

  it("draws every body that is there, and the cup, in frames that exist", () => {
    const scenes = on("/scene");
    expect(scenes[0]!.data.deletions[0].type).toBe(1);
    const frames = new Set(["W", ...[...on("/tf_static"), ...on("/tf")].flatMap(({ data }) => data.transforms.map((t: Json) => t.child_frame_id))]);
    const drawn = scenes.at(-1)!.data.entities as Json[];
    const there = new Set(on("/tf").at(-1)!.data.transforms.map((t: Json) => t.child_frame_id));
    for (const entity of drawn) {
      expect(frames.has(entity.frame_id), entity.id).toBe(true);
      expect(entity.cubes.length + entity.cylinders.length + entity.triangles.length + entity.spheres.length).toBeGreaterThan(0);
    }
    for (const name of there) if (/^BOX/.test(name as string)) expect(drawn.some((entity) => entity.id === name)).toBe(true);
    expect(on("/cup/scene").length).toBeGreaterThan(100);
    expect(frames.has("T")).toBe(true);
  });

  it("logs what happened", () => {
    const kinds = on("/events").map(({ data }) => data.kind);
    for (const kind of ["appear", "seal", "release"]) expect(kinds).toContain(kind);
  });

  it("says nothing that its schemas do not know", () => {
    const check = (value: any, schema: Json, path: string): void => {
      if (schema.type === "array") return void value.forEach((item: any) => check(item, schema.items, `${path}[]`));
      if (schema.type === "integer") return expect(Number.isInteger(value), path).toBe(true);
      if (schema.type !== "object") return expect(typeof value, path).toBe(schema.type);
      if (!schema.properties) return;
      for (const [key, item] of Object.entries(value)) {
        expect(schema.properties[key], `${path}.${key}`).toBeDefined();
        check(item, schema.properties[key], `${path}.${key}`);
      }
    };
    const seen = new Map<string, number>();
    for (const { topic, schema, data } of messages) {
      const count = (seen.get(topic) ?? 0) + 1;
      seen.set(topic, count);
      if (count % 200 === 1) check(data, schemas.get(schema)!, topic);
    }
  });

  it("is found by time, and carries scenario, program and settings", async () => {
    const reader = await opened(bytes);
    const part = await messagesOf(reader, { topics: ["/tf"], startTime: 20_000_000_000n, endTime: 21_000_000_000n });
    expect(part.length).toBe(rows.filter((row) => Number(row.t) >= 20 - 1e-9 && Number(row.t) <= 21 + 1e-9).length);
    const attached = new Map<string, string>();
    for await (const file of reader.readAttachments({ validateCrcs: true })) attached.set(file.name, Buffer.from(file.data).toString("utf8"));
    expect(attached.get("scenario.yaml")).toBe(readFileSync(demonstrator, "utf8"));
    expect(attached.get("program.csv")).toBe(readFileSync(join(folder, "p.csv"), "utf8"));
    const metadata: Json[] = [];
    for await (const record of reader.readMetadata({ name: "snug" })) metadata.push(Object.fromEntries(record.metadata));
    expect(metadata[0]!.sequence).toBe("1");
  });

  it("is the same without compression, and refuses what cannot be", async () => {
    snug("export", join(folder, "run.h5"), "--format", "mcap", "--encoding", "json", "--from", "10", "--to", "12", "--compression", "none", "-o", join(folder, "plain.mcap"));
    const plain = await messagesOf(await opened(readFileSync(join(folder, "plain.mcap"))), { topics: ["/tf"] });
    const same = on("/tf").filter(({ ns }) => ns >= plain[0]!.ns && ns <= plain.at(-1)!.ns);
    expect(plain.map((m) => m.data)).toEqual(same.map((m) => m.data));
    const refused = spawnSync(program, ["export", join(folder, "run.h5"), "--format", "mcpa", "-o", "x"], { encoding: "utf8" });
    expect(refused.status).toBe(2);
    expect(refused.stderr).toContain("did you mean mcap?");
  });
});
