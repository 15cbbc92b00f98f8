// Where a plane cuts a box: the polygon against areas and corners worked out by hand.

import { Matrix4, Plane, Vector3 } from "three";
import { describe, expect, it } from "vitest";
import { cutBox } from "../../src/scene/section";

function areaOf(corners: Vector3[]): number {
  const sum = new Vector3();
  corners.forEach((corner, k) => sum.add(corner.clone().cross(corners[(k + 1) % corners.length]!)));
  return sum.length() / 2;
}

describe("cutBox", () => {
  const half = new Vector3(0.2, 0.1, 0.05);
  it("is a rectangle across an axis, in order around it", () => {
    const corners = cutBox(new Plane(new Vector3(1, 0, 0), -0.03), new Matrix4(), half);
    expect(corners).toHaveLength(4);
    expect(areaOf(corners)).toBeCloseTo(4 * 0.1 * 0.05, 12);
    corners.forEach((corner) => expect(corner.x).toBeCloseTo(0.03, 12));
  });
  it("is a regular hexagon across the diagonal of a cube", () => {
    const corners = cutBox(new Plane(new Vector3(1, 1, 1).normalize(), 0), new Matrix4(), new Vector3(0.5, 0.5, 0.5));
    expect(corners).toHaveLength(6);
    expect(areaOf(corners)).toBeCloseTo((3 * Math.sqrt(3)) / 4, 12);
  });
  it("moves and turns with the box, and is nothing where the plane misses it", () => {
    const X = new Matrix4().makeRotationZ(Math.PI / 2).setPosition(1, 0, 0);
    expect(areaOf(cutBox(new Plane(new Vector3(1, 0, 0), -1), X, half))).toBeCloseTo(4 * 0.2 * 0.05, 12);
    expect(cutBox(new Plane(new Vector3(1, 0, 0), -1.11), X, half)).toEqual([]);
  });
});
