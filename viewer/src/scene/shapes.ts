// Geometry of shapes: boxes, capsules, cylinders and hulls merged into one mesh and one set of edges.

import {
  BoxGeometry, BufferGeometry, CapsuleGeometry, CylinderGeometry, EdgesGeometry, Float32BufferAttribute, Matrix4, SphereGeometry,
} from "three";
import { toCreasedNormals } from "three/examples/jsm/utils/BufferGeometryUtils.js";
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
    if (shape.half_length < 1e-6) return { faces: new SphereGeometry(shape.radius, 20, 12).applyMatrix4(X), edges: null };
    const faces = new CapsuleGeometry(shape.radius, 2 * shape.half_length, 5, 18);
    faces.applyMatrix4(new Matrix4().makeRotationX(Math.PI / 2)); // three's capsule lies along y, ours along z
    return { faces: faces.applyMatrix4(X), edges: null };
  }
  if (shape.kind === "cylinder") {
    const faces = new CylinderGeometry(shape.radius, shape.radius, 2 * shape.half_length, 32);
    faces.applyMatrix4(new Matrix4().makeRotationX(Math.PI / 2)); // along y in three
    const edges = new EdgesGeometry(faces, 30);
    return { faces: faces.applyMatrix4(X), edges: edges.applyMatrix4(X) };
  }
  if (shape.kind === "mesh") return { faces: meshGeometry(shape.vertices, shape.triangles).applyMatrix4(X), edges: null };
  const indexed = new BufferGeometry();
  indexed.setAttribute("position", new Float32BufferAttribute(shape.vertices.flat(), 3));
  indexed.setIndex(shape.triangles.flat());
  const faces = indexed.toNonIndexed();
  faces.computeVertexNormals();
  const edges = new EdgesGeometry(faces, 5);
  return { faces: faces.applyMatrix4(X), edges: edges.applyMatrix4(X) };
}

/** Faces of a mesh that meet at less are drawn as one round surface, rad. */
const CREASE = Math.PI / 5;

function meshGeometry(vertices: [number, number, number][], triangles: [number, number, number][]): BufferGeometry {
  const mesh = new BufferGeometry();
  mesh.setAttribute("position", new Float32BufferAttribute(vertices.flat(), 3));
  mesh.setIndex(triangles.flat());
  return toCreasedNormals(mesh, CREASE);
}

/** One geometry of all given (positions and normals only); what shares corners goes on sharing them: each is computed once. */
export function mergeGeometries(parts: BufferGeometry[]): BufferGeometry {
  const positions: number[] = [];
  const normals: number[] = [];
  const colours: number[] = [];
  const index: number[] = [];
  const isIndexed = parts.some((part) => part.index);
  for (const part of parts) {
    const first = positions.length / 3;
    const position = part.getAttribute("position");
    for (const value of position.array) positions.push(value);
    const normal = part.getAttribute("normal");
    if (normal) for (const value of normal.array) normals.push(value);
    const colour = part.getAttribute("color");
    if (colour) for (const value of colour.array) colours.push(value);
    if (!isIndexed) continue;
    if (part.index) for (const corner of part.index.array) index.push(first + corner);
    else for (let corner = 0; corner < position.count; ++corner) index.push(first + corner);
  }
  const merged = new BufferGeometry();
  merged.setAttribute("position", new Float32BufferAttribute(positions, 3));
  if (normals.length === positions.length) merged.setAttribute("normal", new Float32BufferAttribute(normals, 3));
  if (colours.length === positions.length) merged.setAttribute("color", new Float32BufferAttribute(colours, 3));
  if (isIndexed) merged.setIndex(index);
  return merged;
}
