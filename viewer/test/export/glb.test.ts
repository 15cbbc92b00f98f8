// GLB as snug writes it, read by the loader of three and compared with the same recording's CSV table.

import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { Box3, Mesh, type MeshStandardMaterial, type Object3D, Vector3 } from "three";
import { GLTFLoader } from "three/examples/jsm/loaders/GLTFLoader.js";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { demonstrator, repository, snug } from "../support/export";

let folder = "";
let last: Record<string, string> = {};
const at = (name: string): string => join(folder, name);

async function bodiesOf(name: string): Promise<Map<string, Object3D>> {
  const bytes = readFileSync(at(name));
  const { scene } = await new GLTFLoader().parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length) as ArrayBuffer, "");
  scene.updateMatrixWorld(true);
  expect(scene.children.length).toBe(1);
  return new Map(scene.children[0]!.children.map((node) => [node.userData.name as string, node]));
}

/** The table calls BOX001 box001_FloatingBase. */
const column = (name: string): string => `${name.replace(/^BOX/, "box")}_FloatingBase`;

/** z is up in the recording, y in glTF. */
const recorded = (name: string): Vector3 => {
  const [x, y, z] = ["x", "y", "z"].map((c) => Number(last[`${column(name)}_position_${c}`])) as [number, number, number];
  return new Vector3(x, z, -y);
};

beforeAll(() => {
  folder = mkdtempSync(join(tmpdir(), "snug-glb-"));
  snug("program", demonstrator, join(repository, "scenarios/demo-placements.yaml"), "--sequence", "1", "-o", at("p.csv"));
  snug("simulate", demonstrator, "--program", at("p.csv"), "--sequence", "1", "--until", "20", "-o", at("run.h5"));
  snug("export", at("run.h5"), "--format", "csv", "-o", at("run.csv"));
  snug("export", at("run.h5"), "--format", "glb", "-o", at("run.glb"));
  snug("export", at("run.h5"), "--format", "glb", "--load", "-o", at("load.glb"));
  const lines = readFileSync(at("run.csv"), "utf8").trim().split("\n").map((line) => line.split(";"));
  last = Object.fromEntries(lines[0]!.map((name, i) => [name, lines.at(-1)![i]!]));
}, 120_000);
afterAll(() => rmSync(folder, { recursive: true, force: true }));

describe("a GLB export", () => {
  it("has each body where the recording ends", async () => {
    const bodies = await bodiesOf("run.glb");
    let compared = 0;
    for (const [name, node] of bodies) {
      if (!Number.isFinite(Number(last[`${column(name)}_position_x`] ?? "nan"))) continue;
      expect(node.getWorldPosition(new Vector3()).distanceTo(recorded(name))).toBeLessThan(1e-6);
      compared += 1;
    }
    expect(compared).toBeGreaterThan(2);
    expect(bodies.has("cup")).toBe(true);
  });

  it("has boxes in metres and a container that one can see into", async () => {
    const bodies = await bodiesOf("load.glb");
    const boxes = [...bodies.values()].filter((node) => "mass_kg" in node.userData);
    expect(boxes.length).toBeGreaterThan(0);
    expect(bodies.size).toBe(boxes.length + 1);
    for (const box of boxes) {
      const size = new Box3().setFromObject(box).getSize(new Vector3());
      expect(Math.min(size.x, size.y, size.z)).toBeGreaterThan(0.02);
      expect(Math.max(size.x, size.y, size.z)).toBeLessThan(1);
    }
    const container = [...bodies.values()].find((node) => !("mass_kg" in node.userData))!;
    const seen: MeshStandardMaterial[] = [];
    container.traverse((part) => {
      if (part instanceof Mesh) seen.push(part.material as MeshStandardMaterial);
    });
    expect(seen.length).toBeGreaterThan(0);
    for (const material of seen) expect(material.transparent).toBe(true);
    // The boxes lie within the container's extent.
    const inner = new Box3().setFromObject(container);
    for (const box of boxes) expect(inner.containsPoint(new Box3().setFromObject(box).getCenter(new Vector3()))).toBe(true);
  });
});
