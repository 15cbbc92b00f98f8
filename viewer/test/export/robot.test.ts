// The robot of an MCAP export as a viewer shows it that knows URDF and transforms and nothing of snug: the URDF's joints, read here and turned by
// the joint states, put each link where the transforms do, and both where the recording has the bodies of the links.

import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { Euler, Matrix4, Quaternion, Vector3 } from "three";
import { afterAll, beforeAll, describe, expect, it } from "vitest";
import { demonstrator, messagesOf, opened, repository, snug, type Json, type Message } from "../support/export";

interface Joint {
  name: string;
  parent: string;
  child: string;
  moves: boolean;
  origin: Matrix4;
  axis: Vector3;
}

const ONE = new Vector3(1, 1, 1);
let folder = "";
let messages: Message[] = [];
let urdf = "";

const attribute = (text: string, tag: string, key: string): string | undefined => new RegExp(`<${tag}\\b[^>]*\\b${key}="([^"]*)"`).exec(text)?.[1];
const triple = (text: string | undefined, otherwise: [number, number, number]): [number, number, number] =>
  text === undefined ? otherwise : (text.trim().split(/\s+/).map(Number) as [number, number, number]);

function jointsOf(text: string): Joint[] {
  return [...text.matchAll(/<joint [\s\S]*?<\/joint>/g)].map(([joint]) => {
    const rpy = triple(attribute(joint, "origin", "rpy"), [0, 0, 0]);
    const turn = new Quaternion().setFromEuler(new Euler(...rpy, "ZYX"));
    return {
      name: attribute(joint, "joint", "name")!,
      parent: attribute(joint, "parent", "link")!,
      child: attribute(joint, "child", "link")!,
      moves: attribute(joint, "joint", "type") !== "fixed",
      origin: new Matrix4().compose(new Vector3(...triple(attribute(joint, "origin", "xyz"), [0, 0, 0])), turn, ONE),
      axis: new Vector3(...triple(attribute(joint, "axis", "xyz"), [1, 0, 0])),
    };
  });
}

/** Poses in W of all frames, from the transforms up to a time. */
function framesAt(ns: bigint): { of: (frame: string) => Matrix4; parents: Map<string, string> } {
  const parents = new Map<string, string>();
  const poses = new Map<string, Matrix4>();
  for (const message of messages.filter((m) => m.topic.startsWith("/tf") && m.ns <= ns)) {
    for (const { parent_frame_id: parent, child_frame_id: child, translation: p, rotation: q } of message.data.transforms as Json[]) {
      expect(parents.get(child) ?? parent, `${child} has one parent`).toBe(parent);
      parents.set(child, parent);
      poses.set(child, new Matrix4().compose(new Vector3(p.x, p.y, p.z), new Quaternion(q.x, q.y, q.z, q.w), ONE));
    }
  }
  const of = (frame: string): Matrix4 => (frame === "W" ? new Matrix4() : of(parents.get(frame)!).multiply(poses.get(frame)!));
  return { of, parents };
}

const farthest = (a: Matrix4, b: Matrix4): number => Math.max(...a.elements.map((v, i) => Math.abs(v - b.elements[i]!)));

async function exported(name: string, ...words: string[]): Promise<Message[]> {
  snug("export", join(folder, "run.h5"), "--format", "mcap", "--encoding", "json", ...words, "-o", join(folder, name));
  return messagesOf(await opened(readFileSync(join(folder, name))));
}

beforeAll(async () => {
  folder = mkdtempSync(join(tmpdir(), "snug-robot-"));
  snug("program", demonstrator, join(repository, "scenarios/demo-placements.yaml"), "--sequence", "1", "-o", join(folder, "p.csv"));
  snug("simulate", demonstrator, "--program", join(folder, "p.csv"), "--sequence", "1", "--robot", "ur10", "--until", "8", "-o", join(folder, "run.h5"));
  messages = await exported("run.mcap");
  urdf = messages.find((m) => m.topic === "/robot_description")!.data.data;
}, 120_000);
afterAll(() => rmSync(folder, { recursive: true, force: true }));

describe("the robot of an MCAP export", () => {
  it("stands and turns where its URDF, its joint states and its bodies say", () => {
    const joints = jointsOf(urdf);
    expect(joints.length).toBeGreaterThan(10);
    const states = messages.filter((m) => m.topic === "/joint_states");
    let compared = 0;
    for (const k of [0, 0.3, 0.6, 1].map((part) => Math.round(part * (states.length - 1)))) {
      const { name, position } = states[k]!.data;
      const { of, parents } = framesAt(states[k]!.ns);
      for (const joint of joints) {
        expect(parents.get(joint.child), joint.child).toBe(joint.parent);
        const turned = joint.moves ? new Matrix4().makeRotationAxis(joint.axis, position[name.indexOf(joint.name)]) : new Matrix4();
        expect(farthest(of(joint.child), of(joint.parent).multiply(joint.origin.clone().multiply(turned))), joint.child).toBeLessThan(1e-9);
        // Bodies come from the simulation: the only figures here that are not made of joints.
        if (!parents.has(`robot/${joint.child}`)) continue;
        expect(farthest(of(joint.child), of(`robot/${joint.child}`)), joint.child).toBeLessThan(1e-9);
        ++compared;
      }
      const tool = messages.filter((m) => m.topic === "/tool/pose" && m.ns <= states[k]!.ns).at(-1)!.data.pose;
      expect(new Vector3().setFromMatrixPosition(of("E")).distanceTo(tool.position)).toBeLessThan(1e-9);
    }
    expect(compared).toBeGreaterThan(20);
    expect(farthest(framesAt(states[0]!.ns).of("forearm_link"), framesAt(states.at(-1)!.ns).of("forearm_link"))).toBeGreaterThan(0.05);
  });

  it("has the meshes of its visuals in the text, and the files as they are beside it", async () => {
    const stl = "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\nvertex 0 0.1 0\nendloop\nendfacet\nendsolid t\n";
    writeFileSync(join(folder, "part.stl"), stl);
    const shipped = readFileSync(join(repository, "scenarios/robots/ur10.urdf"), "utf8");
    const own = shipped.replace(/(<link name="forearm_link">[\s\S]*?<visual>[\s\S]*?<geometry>)<cylinder [^>]*\/>/, '$1<mesh filename="part.stl"/>');
    expect(own).not.toBe(shipped);
    writeFileSync(join(folder, "own.urdf"), own);
    const list = await exported("own.mcap", "--urdf", join(folder, "own.urdf"));
    const text = list.find((m) => m.topic === "/robot_description")!.data.data as string;
    const [, inside] = /filename="data:model\/stl;base64,([^"]*)"/.exec(text)!;
    expect(Buffer.from(inside!, "base64").toString("utf8")).toBe(stl);
    expect(text).not.toContain("part.stl");
    const attached = new Map<string, string>();
    for await (const file of (await opened(readFileSync(join(folder, "own.mcap")))).readAttachments()) attached.set(file.name, Buffer.from(file.data).toString("utf8"));
    expect(attached.get("robot.urdf")).toBe(own);
    expect(attached.get("part.stl")).toBe(stl);
  });
});
