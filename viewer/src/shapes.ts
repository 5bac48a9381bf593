/// Geometry of the convex shapes: a core swept by a sphere, with exact surfaces and normals.

import { Matrix4, Vector3, type BufferGeometry } from 'three';
import { SurfaceBuilder } from './builder';
import { convexGeometry } from './convex';
import type { ShapeData } from './types';

/**
 * A flat convex polygon (1 vertex, 2, or more counter-clockwise) in x and y, drawn out to |z| <= h,
 * swept by a sphere.
 */
function roundedPrism(polygon: [number, number][], h: number, radius: number, steps: number) {
  const n = polygon.length;
  const outward = (i: number): number => {
    const [p, q] = [polygon[i], polygon[(i + 1) % n]];
    return Math.atan2(q[1] - p[1], q[0] - p[0]) - Math.PI / 2;
  };
  // Around: at every vertex from the normal of the edge before it to that of the edge after it.
  const around: { x: number; y: number; angle: number }[] = [];
  polygon.forEach(([x, y], i) => {
    const from = n === 1 ? 0 : outward((i + n - 1) % n);
    let sweep = n === 1 ? 2 * Math.PI : outward(i) - from;
    while (sweep < 0) sweep += 2 * Math.PI;
    const parts = radius > 0 ? Math.max(1, Math.round((sweep / (2 * Math.PI)) * steps)) : 1;
    for (let k = 0; k <= parts; ++k) around.push({ x, y, angle: from + (sweep * k) / parts });
  });
  const surface = new SurfaceBuilder();
  const quarter = radius > 0 ? Math.max(2, Math.round(steps / 4)) : 1;
  const rows: number[][] = [];
  for (const side of h > 0 ? [1, -1] : [0]) {
    // Downward: a quarter circle per end of the prism, or one half circle for a flat core.
    const parts = side ? quarter : 2 * quarter;
    for (let k = 0; k <= parts; ++k) {
      const latitude = Math.PI / 2 - ((k + (side < 0 ? quarter : 0)) * Math.PI) / 2 / quarter;
      const [c, s] = [Math.cos(latitude), Math.sin(latitude)];
      rows.push(
        around.map(({ x, y, angle }) => {
          const normal = [c * Math.cos(angle), c * Math.sin(angle), s];
          const point = [x + radius * normal[0], y + radius * normal[1], side * h + radius * s];
          return surface.vertex(point, normal);
        }),
      );
    }
  }
  surface.grid(rows, true);
  surface.fan(rows[0]);
  surface.fan([...rows[rows.length - 1]].reverse());
  return surface.finish();
}

/** A cylinder about z with |z| <= h, swept by a sphere. Ends that another shape covers can be left out. */
function roundedCylinder(coreRadius: number, h: number, radius: number, steps: number, top = true, bottom = true) {
  const profile: { rho: number; z: number; latitude: number }[] = [];
  const quarter = radius > 0 ? Math.max(2, Math.round(steps / 8)) : 1;
  if (top) profile.push({ rho: 0, z: h + radius, latitude: Math.PI / 2 });
  for (const side of [1, -1]) {
    for (let k = 0; k <= quarter; ++k) {
      const latitude = ((side > 0 ? 1 : 0) - k / quarter) * (Math.PI / 2);
      const rho = coreRadius + radius * Math.cos(latitude);
      profile.push({ rho, z: side * h + radius * Math.sin(latitude), latitude });
    }
  }
  if (bottom) profile.push({ rho: 0, z: -h - radius, latitude: -Math.PI / 2 });
  const surface = new SurfaceBuilder();
  const rows = profile.map(({ rho, z, latitude }) =>
    Array.from({ length: steps + 1 }, (_, j) => {
      const angle = (2 * Math.PI * j) / steps;
      const [c, s] = [Math.cos(angle), Math.sin(angle)];
      const flat = Math.cos(latitude);
      return surface.vertex([rho * c, rho * s, z], [flat * c, flat * s, Math.sin(latitude)]);
    }),
  );
  surface.grid(rows, false);
  return surface.finish();
}

/** Right-handed frame at `origin` with x along `x` and y in the plane of `x` and `y`. */
function frame(origin: Vector3, x: Vector3, y: Vector3): Matrix4 {
  const ex = x.lengthSq() > 0 ? x.clone().normalize() : new Vector3(1, 0, 0);
  let ey = y.clone().addScaledVector(ex, -y.dot(ex));
  if (ey.lengthSq() < 1e-18) {
    const other = Math.abs(ex.z) < 0.9 ? new Vector3(0, 0, 1) : new Vector3(0, 1, 0);
    ey = other.addScaledVector(ex, -other.dot(ex));
  }
  ey.normalize();
  return new Matrix4().makeBasis(ex, ey, ex.clone().cross(ey)).setPosition(origin);
}

/** Fewer facets where nobody sees them. */
function stepsFor(radius: number): number {
  return radius > 0.03 ? 32 : radius > 0.01 ? 24 : 16;
}

/** Surface of a shape in the frame it is given in, inflated by `padding` [m]. */
export function shapeGeometry(shape: ShapeData, padding = 0): BufferGeometry {
  const radius = shape.radius + padding;
  const origin = new Vector3(...shape.origin);
  const [u0, u1, u2] = shape.extents.map((u) => new Vector3(...u));
  if (shape.core === 'convex') {
    const X = new Matrix4().makeBasis(u0, u1, u2).setPosition(origin);
    return convexGeometry(shape.vertices.map((p) => new Vector3(...p).applyMatrix4(X)), shape.faces, radius);
  }
  const [a, b, c] = [u0.length(), u1.length(), u2.length()];
  const steps = stepsFor(radius);
  switch (shape.core) {
    case 'point':
      return roundedPrism([[0, 0]], 0, radius, steps).translate(origin.x, origin.y, origin.z);
    case 'segment': {
      const ends: [number, number][] = a > 0 ? [[-a, 0], [a, 0]] : [[0, 0]];
      return roundedPrism(ends, 0, radius, steps).applyMatrix4(frame(origin, u0, new Vector3()));
    }
    case 'triangle':
      return triangle(origin, u0, u1, radius, steps);
    case 'rectangle':
      return roundedPrism(rectangle(a, b), 0, radius, steps).applyMatrix4(frame(origin, u0, u1));
    case 'box':
      return roundedPrism(rectangle(a, b), c, radius, steps).applyMatrix4(frame(origin, u0, u1));
    case 'cylinder': {
      const X = frame(origin, u0, new Vector3());
      const turn = new Matrix4().makeRotationY(Math.PI / 2);  // z of the cylinder along u0.
      return roundedCylinder(shape.core_radius, a, radius, stepsFor(shape.core_radius + radius))
        .applyMatrix4(X.multiply(turn));
    }
  }
}

function rectangle(a: number, b: number): [number, number][] {
  return [[-a, -b], [a, -b], [a, b], [-a, b]];
}

function triangle(origin: Vector3, u0: Vector3, u1: Vector3, radius: number, steps: number) {
  const X = frame(origin, u0, u1);
  const ex = new Vector3().setFromMatrixColumn(X, 0);
  const ey = new Vector3().setFromMatrixColumn(X, 1);
  const corner: [number, number] = [u1.dot(ex), u1.dot(ey)];
  const width = u0.length();
  if (corner[1] > 1e-9 * width) return roundedPrism([[0, 0], [width, 0], corner], 0, radius, steps).applyMatrix4(X);
  // Its vertices lie on a line: the longest edge is the whole core.
  const low = Math.min(0, corner[0]);
  const high = Math.max(width, corner[0]);
  return roundedPrism([[low, 0], [high, 0]], 0, radius, steps).applyMatrix4(X);
}

/** The shapes that URDF knows, about the origin. */
export const primitives = {
  box: ([x, y, z]: number[]): BufferGeometry => roundedPrism(rectangle(x / 2, y / 2), z / 2, 0, 4),
  sphere: (radius: number): BufferGeometry => roundedPrism([[0, 0]], 0, radius, stepsFor(radius)),
  cylinder: (radius: number, length: number, top = true, bottom = true): BufferGeometry =>
    roundedCylinder(radius, length / 2, 0, stepsFor(radius), top, bottom),
};
