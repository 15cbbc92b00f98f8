// Shapes stand as they are recorded: cylinders and capsules along z, their pose applied to faces and edges.

import { expect, test } from "vitest";
import type { BufferGeometry } from "three";
import { shapeGeometry } from "../../src/scene/shapes";

/** Half extent and middle along an axis. */
function along(geometry: BufferGeometry, axis: 0 | 1 | 2): { half: number; middle: number } {
  const values = geometry.getAttribute("position").array.filter((_, i) => i % 3 === axis);
  const low = Math.min(...values), high = Math.max(...values);
  return { half: (high - low) / 2, middle: (high + low) / 2 };
}

test("a cylinder has flat ends along z and its radius across", () => {
  const { faces, edges } = shapeGeometry({ kind: "cylinder", pose: [1, 0, 0, 1, 0, 0, 0], radius: 0.05, half_length: 0.2 });
  for (const geometry of [faces, edges!]) {
    expect(along(geometry, 2).half).toBeCloseTo(0.2, 6);
    expect(along(geometry, 0)).toMatchObject({ half: expect.closeTo(0.05, 6), middle: expect.closeTo(1, 6) });
  }
});

test("a capsule is longer than its segment by its radius", () => {
  const { faces } = shapeGeometry({ kind: "capsule", pose: [0, 0, 0, 1, 0, 0, 0], radius: 0.05, half_length: 0.2 });
  expect(along(faces, 2).half).toBeCloseTo(0.25, 6);
});
