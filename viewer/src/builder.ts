/// Surfaces built triangle by triangle.

import { BufferAttribute, BufferGeometry, Vector3 } from 'three';

/** Triangles under construction. */
export class SurfaceBuilder {
  private readonly positions: number[] = [];
  private readonly normals: number[] = [];
  private readonly indices: number[] = [];

  vertex(p: number[], n: number[]): number {
    this.positions.push(...p);
    this.normals.push(...n);
    return this.positions.length / 3 - 1;
  }

  /** Triangles without area are left out. */
  triangle(a: number, b: number, c: number): void {
    const at = (i: number) => new Vector3().fromArray(this.positions, 3 * i);
    const area = at(b).sub(at(a)).cross(at(c).sub(at(a))).length();
    if (area > 1e-14) this.indices.push(a, b, c);
  }

  /** Joins rows of equally many vertices; counter-clockwise seen from outside. */
  grid(rows: number[][], closed: boolean): void {
    for (let i = 1; i < rows.length; ++i) {
      const count = rows[i].length;
      for (let j = 0; j < (closed ? count : count - 1); ++j) {
        const k = (j + 1) % count;
        this.triangle(rows[i - 1][j], rows[i][j], rows[i][k]);
        this.triangle(rows[i - 1][j], rows[i][k], rows[i - 1][k]);
      }
    }
  }

  fan(ring: number[]): void {
    for (let j = 2; j < ring.length; ++j) this.triangle(ring[0], ring[j - 1], ring[j]);
  }

  finish(): BufferGeometry {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(this.positions), 3));
    geometry.setAttribute('normal', new BufferAttribute(new Float32Array(this.normals), 3));
    geometry.setIndex(this.indices);
    return geometry;
  }
}
