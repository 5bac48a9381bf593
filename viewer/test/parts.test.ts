import { Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { Parts } from '../src/parts';
import type { BodyData, SceneData, Vec3 } from '../src/types';

function ball(name: string, kind: BodyData['kind'], link: number, origin: Vec3): BodyData {
  const none: Vec3 = [0, 0, 0];
  return {
    name, kind, link, padding: 0.01, surfaces: [],
    shapes: [{ core: 'point', origin, extents: [none, none, none], core_radius: 0, radius: 0.05 }],
  };
}

describe('objects that move between motions', () => {
  const bodies = [ball('arm', 'robot', 1, [0, 0, 0]), ball('gear', 'obstacle', 0, [1, 0, 0]), ball('box', 'obstacle', 0, [2, 0, 0])];
  const scene = { links: [{ name: 'world' }, { name: 'hand' }, { name: 'other hand' }], bodies, visuals: [] } as unknown as SceneData;
  const names = (parts: Parts, link: number, kind: BodyData['kind']) => parts.bodiesOf(link, kind).map((body) => body.name);
  const center = (parts: Parts, name: string, padded = false) => {
    const geometry = parts.volume(parts.bodies.find((body) => body.name === name)!, padded)!;
    geometry.computeBoundingBox();
    return geometry.boundingBox!.getCenter(new Vector3()).x;
  };

  it('are where the last motion has them, others where the scene has them', () => {
    const parts = new Parts(scene);
    expect(center(parts, 'gear')).toBeCloseTo(1, 6);
    expect(parts.setMoved([ball('gear', 'attached', 1, [0.1, 0, 0])])).toEqual(new Set([0, 1]));
    expect(names(parts, 1, 'attached')).toEqual(['gear']);
    expect(names(parts, 0, 'obstacle')).toEqual(['box']);
    for (const padded of [false, true]) expect(center(parts, 'gear', padded)).toBeCloseTo(0.1, 6);
    expect(parts.setMoved([ball('box', 'attached', 2, [0.2, 0, 0])])).toEqual(new Set([0, 1, 2]));
    expect(names(parts, 1, 'attached')).toEqual([]);
    expect(names(parts, 2, 'attached')).toEqual(['box']);
    expect(names(parts, 0, 'obstacle')).toEqual(['gear']);
    expect(center(parts, 'gear')).toBeCloseTo(1, 6);
    expect(center(parts, 'box')).toBeCloseTo(0.2, 6);
    expect(parts.setMoved([])).toEqual(new Set([0, 2]));
    expect(parts.bodies).toEqual(bodies);
    expect(parts.setMoved([])).toEqual(new Set());
    expect(names(parts, 1, 'robot')).toEqual(['arm']);
  });
});
