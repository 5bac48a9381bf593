import { Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { primitives, shapeGeometry } from '../src/shapes';
import type { CoreType, RoundedData, Vec3 } from '../src/types';
import { reach, volume } from './measure';
import { random } from './random';

/** Furthest the shape reaches along a unit vector, by definition of its core. */
function support(shape: RoundedData, d: Vector3): number {
  const u = shape.extents.map((e) => new Vector3(...e));
  const base = new Vector3(...shape.origin).dot(d) + shape.radius;
  if (shape.core === 'triangle') return base + Math.max(0, u[0].dot(d), u[1].dot(d));
  let reach = base + u.reduce((sum, e) => sum + Math.abs(e.dot(d)), 0);
  if (shape.core === 'cylinder') {
    const axis = u[0].clone().normalize();
    reach += shape.core_radius * Math.sqrt(Math.max(0, 1 - axis.dot(d) ** 2));
  }
  return reach;
}

function randomShape(core: CoreType, next: () => number, radius: number): RoundedData {
  const vector = () => new Vector3(next() - 0.5, next() - 0.5, next() - 0.5);
  const x = vector().normalize();
  const y = x.clone().cross(vector()).normalize();
  const z = x.clone().cross(y).multiplyScalar(next() < 0.5 ? -1 : 1);
  const scaled = (e: Vector3): Vec3 => e.clone().multiplyScalar(0.05 + 0.3 * next()).toArray() as Vec3;
  const none: Vec3 = [0, 0, 0];
  const counts = { point: 0, segment: 1, triangle: 2, rectangle: 2, box: 3, cylinder: 1 };
  const extents = [x, y, z].map((e, i) => (i < counts[core] ? scaled(e) : none));
  if (core === 'triangle') extents[1] = vector().multiplyScalar(0.4).toArray() as Vec3;
  return {
    core,
    origin: vector().toArray() as Vec3,
    extents: extents as [Vec3, Vec3, Vec3],
    core_radius: core === 'cylinder' ? 0.05 + 0.1 * next() : 0,
    radius,
  };
}

const cores: CoreType[] = ['point', 'segment', 'triangle', 'rectangle', 'box', 'cylinder'];

describe.each(cores)('%s', (core) => {
  it('reaches as far as the shape in every direction, and no further', () => {
    const next = random(7);
    for (let k = 0; k < 20; ++k) {
      const radius = core === 'box' || core === 'cylinder' ? k % 2 && 0.05 * next() : 0.01 + 0.1 * next();
      const shape = randomShape(core, next, radius);
      const geometry = shapeGeometry(shape);
      const facet = 0.03 * (shape.radius + shape.core_radius);  // Chords lie inside their circle.
      for (let i = 0; i < 30; ++i) {
        const d = new Vector3(next() - 0.5, next() - 0.5, next() - 0.5).normalize();
        const expected = support(shape, d);
        expect(reach(geometry, d)).toBeLessThan(expected + 1e-6);
        expect(reach(geometry, d)).toBeGreaterThan(expected - facet - 1e-6);
      }
    }
  });

  it('is closed, faces outward, and has unit normals that point outward', () => {
    const next = random(11);
    for (let k = 0; k < 5; ++k) {
      const shape = randomShape(core, next, 0.05);
      const geometry = shapeGeometry(shape);
      expect(volume(geometry)).toBeGreaterThan(0.9 * (4 / 3) * Math.PI * 0.05 ** 3);
      const [points, normals] = [geometry.getAttribute('position'), geometry.getAttribute('normal')];
      for (let i = 0; i < points.count; i += 7) {
        const n = new Vector3().fromBufferAttribute(normals, i);
        expect(n.length()).toBeCloseTo(1, 4);
        // The shape lies behind the tangent plane of each of its points.
        expect(new Vector3().fromBufferAttribute(points, i).dot(n)).toBeCloseTo(support(shape, n), 4);
      }
    }
  });

  it('grows by its padding', () => {
    const shape = randomShape(core, random(3), 0.05);
    const grown = shapeGeometry(shape, 0.02);
    const axis = new Vector3(0, 0, 1);
    const facet = 0.01 * (shape.core_radius + 0.07);
    expect(Math.abs(reach(grown, axis) - support(shape, axis) - 0.02)).toBeLessThan(facet);
  });
});

describe('volumes', () => {
  const box = (radius: number): RoundedData => ({
    core: 'box',
    origin: [1, 2, 3],
    extents: [[0.1, 0, 0], [0, 0.2, 0], [0, 0, -0.3]],
    core_radius: 0,
    radius,
  });

  it('of a box is exact, of a rounded box follows Steiner', () => {
    expect(volume(shapeGeometry(box(0)))).toBeCloseTo(0.2 * 0.4 * 0.6, 7);
    const r = 0.05;
    const faces = 2 * (0.2 * 0.4 + 0.4 * 0.6 + 0.2 * 0.6);
    const edges = Math.PI * (0.2 + 0.4 + 0.6);
    const expected = 0.048 + faces * r + edges * r * r + (4 / 3) * Math.PI * r ** 3;
    expect(Math.abs(volume(shapeGeometry(box(r))) / expected - 1)).toBeLessThan(0.005);
  });

  it('of primitives are those of their formulas', () => {
    expect(volume(primitives.box([0.1, 0.2, 0.3]))).toBeCloseTo(0.006, 9);
    expect(Math.abs(volume(primitives.sphere(0.1)) / ((4 / 3) * Math.PI * 1e-3) - 1)).toBeLessThan(0.02);
    expect(Math.abs(volume(primitives.cylinder(0.1, 0.5)) / (Math.PI * 5e-3) - 1)).toBeLessThan(0.01);
  });

  it('of degenerate shapes are those of what is left', () => {
    const flat: RoundedData = { ...box(0.1), core: 'triangle', extents: [[0.3, 0, 0], [0.6, 0, 0], [0, 0, 0]] };
    const capsule = Math.PI * 0.01 * 0.6 + (4 / 3) * Math.PI * 1e-3;
    expect(Math.abs(volume(shapeGeometry(flat)) / capsule - 1)).toBeLessThan(0.02);
    const point: RoundedData = { ...box(0.1), core: 'segment', extents: [[0, 0, 0], [0, 0, 0], [0, 0, 0]] };
    expect(Math.abs(volume(shapeGeometry(point)) / ((4 / 3) * Math.PI * 1e-3) - 1)).toBeLessThan(0.02);
  });
});
