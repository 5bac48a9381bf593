/// A set of links that is posed as one: the robots, their volumes, a ghost.

import { BufferGeometry, Group, Material, Matrix4, Mesh, type Object3D } from 'three';

export class Figure extends Group {
  private readonly holders: Group[];

  constructor(linkCount: number) {
    super();
    this.matrixAutoUpdate = false;
    this.holders = Array.from({ length: linkCount }, () => {
      const holder = new Group();
      holder.matrixAutoUpdate = false;
      return holder;
    });
    this.add(...this.holders);
  }

  setLink(link: number, objects: Object3D[]): void {
    this.holders[link].clear();
    for (const object of objects) {
      object.matrixAutoUpdate = false;
      this.holders[link].add(object);
    }
  }

  pose(X_WL: Matrix4[]): void {
    this.holders.forEach((holder, i) => {
      holder.matrix.copy(X_WL[i]);
      holder.matrixWorldNeedsUpdate = true;
    });
  }

  empty(): void {
    for (const holder of this.holders) holder.clear();
  }
}

export function solid(geometry: BufferGeometry, material: Material): Mesh {
  const mesh = new Mesh(geometry, material);
  mesh.castShadow = true;
  mesh.receiveShadow = true;
  return mesh;
}

/** A translucent surface without its inside: depth first, colour second. */
export function skin(geometry: BufferGeometry, material: Material, depthOnly: Material, order: number): Mesh[] {
  const first = new Mesh(geometry, depthOnly);
  const second = new Mesh(geometry, material);
  first.renderOrder = order;
  second.renderOrder = order + 1;
  return [first, second];
}
