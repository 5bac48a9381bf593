/// What stands in the cell.

import { EdgesGeometry, Group, LineBasicMaterial, LineSegments, Vector3, type Box3, type Matrix4, type Object3D } from 'three';
import type { Bodies } from './bodies';
import type { Materials } from './materials';
import type { Theme } from './palette';
import type { Parts } from './parts';
import type { BodyData } from './types';

const kMostOutlined = 60_000;  // Vertices; looking for the edges of more takes a page too long.

export class Furniture extends Group {
  readonly padded = new Group();
  /** Height of the floor [m]. */
  ground = 0;
  private readonly edges = new LineBasicMaterial({ transparent: true, opacity: 0.3, toneMapped: false });

  constructor(private readonly X_WL: Matrix4[], private readonly parts: Parts, private readonly drawn: Bodies, private readonly materials: Materials) {
    super();
    this.rebuild();
  }

  /** Again, after bodies have moved. */
  rebuild(): void {
    const { X_WL, parts, drawn, materials } = this;
    for (const piece of this.children) if (piece instanceof LineSegments) piece.geometry.dispose();
    this.clear();
    this.padded.clear();
    // Numbered with what is carried, so that a piece keeps its colour when it is picked up and put down.
    parts.bodies.filter((body) => body.kind !== 'robot').forEach((body, i) => {
      if (body.kind !== 'obstacle') return;
      const box = parts.box(body);
      // The stage draws the ground; its outline says how far it goes.
      const flat = isGround(box);
      if (flat) this.ground = box.max.z;
      const shown = flat ? [] : drawn.solid(body, materials.furniture(i));
      place(this, [...shown, ...this.outline(body)], X_WL[body.link]);
      if (body.padding > 0) place(this.padded, drawn.skin(body, materials.skin('padding', -1, 0.3), 40, true), X_WL[body.link]);
    });
  }

  setTheme(theme: Theme): void {
    this.edges.color.set(theme === 'light' ? '#2c3640' : '#c9d4df');
  }

  private outline(body: BodyData): Object3D[] {
    const geometry = this.parts.volume(body);
    if (!geometry || geometry.getAttribute('position').count > kMostOutlined) return [];
    return [new LineSegments(new EdgesGeometry(geometry, 35), this.edges)];
  }
}

function place(group: Group, objects: Object3D[], X: Matrix4): void {
  for (const object of objects) {
    object.applyMatrix4(X);
    group.add(object);
  }
}

/** A wide, flat slab near the height of the world's origin is a floor, not furniture. */
function isGround(box: Box3): boolean {
  const size = box.getSize(new Vector3());
  return size.x * size.y > 1.5 && size.z < 0.25 && Math.abs(box.max.z) < 0.05;
}
