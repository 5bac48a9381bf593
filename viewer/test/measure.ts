/// What tests measure of geometry.

import { Vector3, type BufferGeometry } from 'three';

/** Furthest that a geometry reaches along a unit vector. */
export function reach(geometry: BufferGeometry, d: Vector3): number {
  const points = geometry.getAttribute('position');
  let best = -Infinity;
  for (let i = 0; i < points.count; ++i) {
    best = Math.max(best, new Vector3().fromBufferAttribute(points, i).dot(d));
  }
  return best;
}

/** By the divergence theorem; positive only if the triangles face outward and close up. */
export function volume(geometry: BufferGeometry): number {
  const points = geometry.getAttribute('position');
  const index = geometry.getIndex();
  const at = (i: number) => new Vector3().fromBufferAttribute(points, index ? index.getX(i) : i);
  let sum = 0;
  for (let i = 0; i < (index ?? points).count; i += 3) sum += at(i).dot(at(i + 1).cross(at(i + 2))) / 6;
  return sum;
}
