/// Triangle meshes and point clouds of bodies.

import { BufferAttribute, BufferGeometry, Vector3 } from 'three';
import { bytesOf } from './bytes';
import { poseMatrix } from './model';
import type { SurfaceData } from './types';

export function isCloud(surface: SurfaceData): boolean {
  return surface.triangles === undefined;
}

/** The points of a cloud, in the frame of its body. */
export function cloudGeometry(surface: SurfaceData): BufferGeometry {
  const positions = new Float32Array(bytesOf(surface.vertices).buffer);
  const geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(positions, 3));
  return geometry.applyMatrix4(poseMatrix(surface.pose));
}

/**
 * The triangles of a mesh, flat, in the frame of its body. What sweeps them, its radius and
 * `padding` [m], moves every vertex along the mean normal of the triangles around it: true where
 * the mesh is smooth, a little less than true at its edges.
 */
export function meshGeometry(surface: SurfaceData, padding = 0): BufferGeometry {
  const indexed = cloudGeometry(surface);
  indexed.setIndex(new BufferAttribute(new Uint32Array(bytesOf(surface.triangles ?? '').buffer), 1));
  const sweep = surface.radius + padding;
  if (sweep > 0) moveOut(indexed, sweep);
  const geometry = indexed.toNonIndexed();
  geometry.computeVertexNormals();
  return geometry;
}

function moveOut(geometry: BufferGeometry, distance: number): void {
  geometry.computeVertexNormals();
  const [p, n] = [geometry.getAttribute('position'), geometry.getAttribute('normal')];
  const point = new Vector3();
  const normal = new Vector3();
  for (let i = 0; i < p.count; ++i) {
    point.fromBufferAttribute(p, i).addScaledVector(normal.fromBufferAttribute(n, i), distance);
    p.setXYZ(i, point.x, point.y, point.z);
  }
  geometry.deleteAttribute('normal');
}
