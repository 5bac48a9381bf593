import { Vector3 } from 'three';
import { ConvexHull } from 'three/examples/jsm/math/ConvexHull.js';
import { describe, expect, it } from 'vitest';
import { bytesOf } from '../src/bytes';
import { convexGeometry } from '../src/convex';
import { matrixPose, poseMatrix } from '../src/model';
import { shapeGeometry } from '../src/shapes';
import { cloudGeometry, isCloud, meshGeometry } from '../src/surfaces';
import type { PoseData, SurfaceData, Vec3 } from '../src/types';
import { reach, volume } from './measure';
import { random } from './random';

const direction = (next: () => number) => new Vector3(next() - 0.5, next() - 0.5, next() - 0.5).normalize();

/** Hull of random points, as vertices and triangles. */
function polytope(next: () => number): { vertices: Vector3[]; faces: number[][] } {
  const points = Array.from({ length: 20 }, () => direction(next).multiplyScalar(0.2 + 0.05 * next()).add(new Vector3(1, 2, 3)));
  const faces = new ConvexHull().setFromPoints(points).faces.map(({ edge }) => {
    return [edge, edge.next, edge.prev].map((e) => points.indexOf(e.head().point));
  });
  return { vertices: points, faces };
}

/** All six faces of a box, four corners each, seen from outside. */
const box = {
  vertices: [0, 1, 2, 3, 4, 5, 6, 7].map((i) => new Vector3(i & 1 ? 0.1 : -0.1, i & 2 ? 0.2 : -0.2, i & 4 ? 0.3 : -0.3)),
  faces: [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]],
};

describe('a convex polytope', () => {
  it('reaches as far as its vertices and its radius, closed and facing outward', () => {
    const next = random(5);
    for (const radius of [0, 0.03]) {
      for (let round = 0; round < 10; ++round) {
        const { vertices, faces } = polytope(next);
        const geometry = convexGeometry(vertices, faces, radius);
        for (let i = 0; i < 30; ++i) {
          const d = direction(next);
          const expected = Math.max(...vertices.map((p) => p.dot(d))) + radius;
          expect(reach(geometry, d)).toBeLessThan(expected + 1e-6);
          expect(reach(geometry, d)).toBeGreaterThan(expected - 0.03 * radius - 1e-6);
        }
      }
    }
  });

  it('that is flat is a rounded plate', () => {
    const [a, b, r] = [0.2, 0.3, 0.05];
    const vertices = [[0, 0], [a, 0], [a, b], [0, b]].map(([x, y]) => new Vector3(x, y, 0));
    const geometry = convexGeometry(vertices, [[0, 1, 2], [0, 2, 3], [0, 2, 1], [0, 3, 2]], r);
    const expected = 2 * a * b * r + Math.PI * (a + b) * r * r + (4 / 3) * Math.PI * r ** 3;
    expect(Math.abs(volume(geometry) / expected - 1)).toBeLessThan(0.02);
  });

  it('stands where its origin and extents say', () => {
    const turned = poseMatrix(pose);
    const column = (i: number) => new Vector3().setFromMatrixColumn(turned, i).toArray() as Vec3;
    const shape = { core: 'convex' as const, origin: pose.xyz, extents: [column(0), column(1), column(2)] as [Vec3, Vec3, Vec3], vertices: box.vertices.map((p) => p.toArray() as Vec3), faces: box.faces, radius: 0 };
    const d = new Vector3(1, 2, 3).normalize();
    expect(reach(shapeGeometry(shape), d)).toBeCloseTo(Math.max(...box.vertices.map((p) => p.clone().applyMatrix4(turned).dot(d))), 6);
  });

  it('has the volume of its faces, edges and corners (Steiner)', () => {
    expect(volume(convexGeometry(box.vertices, box.faces, 0))).toBeCloseTo(0.048, 7);
    const r = 0.05;
    const expected = 0.048 + 2 * (0.08 + 0.24 + 0.12) * r + Math.PI * (0.2 + 0.4 + 0.6) * r * r + (4 / 3) * Math.PI * r ** 3;
    expect(Math.abs(volume(convexGeometry(box.vertices, box.faces, r)) / expected - 1)).toBeLessThan(0.01);
  });
});

const text = (array: Float32Array | Uint32Array) => Buffer.from(array.buffer).toString('base64');
const pose: PoseData = { xyz: [1, -2, 0.5], quat_wxyz: [0.5, 0.5, 0.5, 0.5] };

function mesh({ vertices, faces }: { vertices: Vector3[]; faces: number[][] }, radius: number): SurfaceData {
  const triangles = faces.flatMap(([a, b, ...rest]) => rest.flatMap((c, i) => [a, i ? rest[i - 1] : b, c]));
  return {
    pose,
    radius,
    vertices: text(new Float32Array(vertices.flatMap((p) => p.toArray()))),
    triangles: text(new Uint32Array(triangles)),
  };
}

describe('a surface', () => {
  it('that is a mesh stands where its pose says, every triangle flat', () => {
    const surface = mesh(box, 0);
    expect(isCloud(surface)).toBe(false);
    const geometry = meshGeometry(surface);
    expect(geometry.getAttribute('position').count).toBe(36);
    expect(volume(geometry)).toBeCloseTo(0.048, 6);
    const X = poseMatrix(pose);
    const next = random(2);
    for (let i = 0; i < 20; ++i) {
      const d = direction(next);
      expect(reach(geometry, d)).toBeCloseTo(Math.max(...box.vertices.map((p) => p.clone().applyMatrix4(X).dot(d))), 5);
    }
    expect(matrixPose(X)).toEqual(pose);
  });

  it('grows by its radius and its padding where it is smooth', () => {
    const next = random(4);
    const vertices = Array.from({ length: 2000 }, () => direction(next).multiplyScalar(0.3));
    const faces = new ConvexHull().setFromPoints(vertices).faces.map(({ edge }) => [edge, edge.next, edge.prev].map((e) => vertices.indexOf(e.head().point)));
    const geometry = meshGeometry({ ...mesh({ vertices, faces }, 0.02), pose: { xyz: [0, 0, 0], quat_wxyz: [1, 0, 0, 0] } }, 0.03);
    expect(Math.abs(volume(geometry) / ((4 / 3) * Math.PI * 0.35 ** 3) - 1)).toBeLessThan(0.02);
  });

  it('without triangles is a cloud of its points', () => {
    const points = new Float32Array([0, 0, 0, 0.1, 0, 0, 0, 0.2, 0]);
    const cloud: SurfaceData = { pose, radius: 0.01, vertices: text(points) };
    expect(isCloud(cloud)).toBe(true);
    const at = cloudGeometry(cloud).getAttribute('position');
    expect(at.count).toBe(3);
    const expected = new Vector3(0, 0.2, 0).applyMatrix4(poseMatrix(pose)).toArray();
    new Vector3().fromBufferAttribute(at, 2).toArray().forEach((value, i) => expect(value).toBeCloseTo(expected[i], 6));
  });

  it('of 100,000 points is there in a moment', () => {
    const cloud: SurfaceData = { pose, radius: 0.01, vertices: text(new Float32Array(300_000).map((_, i) => i)) };
    const begun = performance.now();
    expect(cloudGeometry(cloud).getAttribute('position').count).toBe(100_000);
    expect(performance.now() - begun).toBeLessThan(2000);  // 30 ms alone.
  });
});

it('reads bytes out of text, with and without an address around it', () => {
  const bytes = Uint8Array.from({ length: 256 }, (_, i) => i);
  const packed = Buffer.from(bytes).toString('base64');
  expect(bytesOf(packed)).toEqual(bytes);
  expect(bytesOf(`data:model/stl;base64,${packed}`)).toEqual(bytes);
});
