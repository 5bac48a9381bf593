/// How bodies are drawn: surfaces solid or as a skin, clouds as balls.

import { Points, type BufferGeometry, type Color, type Material, type Mesh, type Object3D } from 'three';
import { skin, solid } from './figure';
import type { Materials } from './materials';
import type { Parts } from './parts';
import type { BodyData } from './types';

type Coloured = Material & { color: Color };

export class Bodies {
  constructor(private readonly parts: Parts, private readonly materials: Materials) {}

  solid(body: BodyData, material: Coloured): Object3D[] {
    return [...this.surface(body, false, (geometry) => [solid(geometry, material)]), ...this.balls(body, material, false)];
  }

  skin(body: BodyData, material: Coloured, order: number, padded = false): Object3D[] {
    const surface = this.surface(body, padded, (geometry) => skin(geometry, material, this.materials.depthOnly, order));
    return [...surface, ...this.balls(body, material, padded, order + 1)];
  }

  private surface(body: BodyData, padded: boolean, draw: (geometry: BufferGeometry) => Mesh[]): Mesh[] {
    const geometry = this.parts.volume(body, padded);
    return geometry ? draw(geometry) : [];
  }

  private balls(body: BodyData, like: Coloured, padded: boolean, order = 0): Points[] {
    return this.parts.clouds(body).map(({ geometry, radius }) => {
      const points = new Points(geometry, this.materials.balls(like, radius + (padded ? body.padding : 0)));
      points.renderOrder = order;
      return points;
    });
  }
}
