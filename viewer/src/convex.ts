/// Convex polytopes swept by a sphere.

import { Vector3 } from 'three';
import { SurfaceBuilder } from './builder';
import type { BufferGeometry } from 'three';

const kFine = Math.PI / 8;  // Of rounding [rad].
const kTurned = 3;  // Beyond that faces lie back to back [rad].

/** Of the spherical polygon at a vertex: normals up to those of the next face. */
interface Side {
  face: number;
  normals: Vector3[];
}

/** The great arc from unit vector a to b in `parts` steps, both ends included. */
function arc(a: Vector3, b: Vector3, parts: number): Vector3[] {
  const angle = a.angleTo(b);
  const s = Math.sin(angle);
  return Array.from({ length: parts + 1 }, (_, k) => {
    const t = k / parts;
    if (s < 1e-6) return a.clone().lerp(b, t).normalize();
    return a.clone().multiplyScalar(Math.sin((1 - t) * angle) / s).addScaledVector(b, Math.sin(t * angle) / s);
  });
}

/** Of a polygon, counter-clockwise seen from outside (Newell). */
function normalOf(face: Vector3[]): Vector3 {
  const n = new Vector3();
  face.forEach((p, i) => n.add(p.clone().cross(face[(i + 1) % face.length])));
  return n.normalize();
}

/**
 * @param vertices [m]
 * @param faces    indices into them, counter-clockwise seen from outside
 * @param radius   of the sphere [m], 0 leaves the edges sharp
 */
export function convexGeometry(vertices: Vector3[], faces: number[][], radius: number): BufferGeometry {
  const builder = new SurfaceBuilder();
  const put = (p: Vector3, n: Vector3) => builder.vertex(p.clone().addScaledVector(n, radius).toArray(), n.toArray());
  const normals = faces.map((face) => normalOf(face.map((i) => vertices[i])));
  faces.forEach((face, f) => builder.fan(face.map((i) => put(vertices[i], normals[f]))));
  if (radius === 0) return builder.finish();

  /** Normals from face f to face g, that share the edge from vertex i to k of f. */
  const bend = (i: number, k: number, f: number, g: number): Vector3[] => {
    const angle = normals[f].angleTo(normals[g]);
    const parts = Math.max(1, Math.round(angle / kFine));
    if (angle < kTurned) return arc(normals[f], normals[g], parts);
    const outward = vertices[k].clone().sub(vertices[i]).cross(normals[f]).normalize();
    return [...arc(normals[f], outward, parts).slice(0, -1), ...arc(outward, normals[g], parts)];
  };
  const faceOfEdge = new Map<string, number>();  // That has the edge from i to k.
  faces.forEach((face, f) => face.forEach((i, j) => faceOfEdge.set(`${i} ${face[(j + 1) % face.length]}`, f)));
  const next = new Map<string, Side>();  // Around a vertex, what follows a face.
  for (const [edge, f] of faceOfEdge) {
    const [i, k] = edge.split(' ').map(Number);
    const g = faceOfEdge.get(`${k} ${i}`);
    if (g === undefined) continue;
    const across = bend(i, k, f, g);
    next.set(`${i} ${g}`, { face: f, normals: [...across].reverse() });
    if (i < k) builder.grid([vertices[k], vertices[i]].map((p) => across.map((n) => put(p, n))), false);
  }
  vertices.forEach((p, i) => {
    const first = faces.findIndex((face) => face.includes(i));
    if (first >= 0) corner(p, around(first, (f) => next.get(`${i} ${f}`)));
  });
  return builder.finish();

  /** A spherical polygon, by the arcs of its sides. */
  function corner(p: Vector3, sides: Vector3[][]): void {
    const rim = sides.flatMap((side) => side.slice(0, -1));
    if (rim.length < 3) return;
    const middle = rim.reduce((sum, n) => sum.add(n), new Vector3()).normalize();
    const steps = Math.max(1, Math.round(Math.max(...rim.map((n) => n.angleTo(middle))) / kFine));
    const spokes = rim.map((n) => arc(middle, n, steps));
    builder.grid(Array.from({ length: steps + 1 }, (_, k) => spokes.map((spoke) => put(p, spoke[k]))), true);
  }
}

/** The sides that follow `first`, until it comes again. */
function around(first: number, next: (face: number) => Side | undefined): Vector3[][] {
  const sides: Vector3[][] = [];
  let face = first;
  do {
    const side = next(face);
    if (!side) break;
    sides.push(side.normals);
    face = side.face;
  } while (face !== first && sides.length < 1000);
  return sides;
}
