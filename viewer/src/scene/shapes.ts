// Geometry of shapes: boxes, capsules and hulls merged into one mesh and one set of edges.

import {
  BoxGeometry, BufferGeometry, CapsuleGeometry, EdgesGeometry, Float32BufferAttribute, Matrix4, SphereGeometry,
} from "three";
import type { Shape } from "../replay/header";
import { matrixOf } from "./maths";

/** Faces and edges of one shape in the body frame; edges may be null (round shapes). */
export function shapeGeometry(shape: Shape): { faces: BufferGeometry; edges: BufferGeometry | null } {
  const X = matrixOf(shape.pose);
  if (shape.kind === "box") {
    const faces = new BoxGeometry(2 * shape.half[0], 2 * shape.half[1], 2 * shape.half[2]);
    const edges = new EdgesGeometry(faces);
    return { faces: faces.applyMatrix4(X), edges: edges.applyMatrix4(X) };
  }
  if (shape.kind === "capsule") {
    if (shape.half_length < 1e-6) return { faces: new SphereGeometry(shape.radius, 24, 16).applyMatrix4(X), edges: null };
    const faces = new CapsuleGeometry(shape.radius, 2 * shape.half_length, 8, 24);
    faces.applyMatrix4(new Matrix4().makeRotationX(Math.PI / 2)); // three's capsule lies along y, ours along z
    return { faces: faces.applyMatrix4(X), edges: null };
  }
  const indexed = new BufferGeometry();
  indexed.setAttribute("position", new Float32BufferAttribute(shape.vertices.flat(), 3));
  indexed.setIndex(shape.triangles.flat());
  const faces = indexed.toNonIndexed();
  faces.computeVertexNormals();
  const edges = new EdgesGeometry(faces, 5);
  return { faces: faces.applyMatrix4(X), edges: edges.applyMatrix4(X) };
}

/** One geometry of all given (positions and normals only). */
export function mergeGeometries(parts: BufferGeometry[]): BufferGeometry {
  const positions: number[] = [];
  const normals: number[] = [];
  for (const part of parts) {
    const flat = part.index ? part.toNonIndexed() : part;
    positions.push(...flat.getAttribute("position").array);
    const normal = flat.getAttribute("normal");
    if (normal) normals.push(...normal.array);
  }
  const merged = new BufferGeometry();
  merged.setAttribute("position", new Float32BufferAttribute(positions, 3));
  if (normals.length === positions.length) merged.setAttribute("normal", new Float32BufferAttribute(normals, 3));
  return merged;
}
