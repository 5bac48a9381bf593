/// What the page draws, against pictures of it. The motion is fixed: no planner changes them.

import { mkdirSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { afterEach, describe, expect, it } from 'vitest';
import type { Page } from 'playwright-core';
import type { PageData, SurfaceData, Vec3 } from '../../src/types';
import { compare } from './compare';
import { kPatience, missing, pageData, Pages, picture, smallPage, type Watched } from './harness';

const [width, height] = [480, 300];
const out = resolve(process.cwd(), process.env.TANDEM_PICTURES ?? 'test/out');
const text = (array: Float32Array | Uint32Array) => Buffer.from(array.buffer).toString('base64');

/** A tetrahedron of triangles and a cloud on a wavy sheet, on the table. */
function surfaces(): SurfaceData[] {
  const at = (xyz: Vec3) => ({ xyz, quat_wxyz: [1, 0, 0, 0] as [number, number, number, number] });
  const corners = [0, 0, 0, 0.25, 0, 0, 0, 0.25, 0, 0, 0, 0.3];
  const sheet = Float32Array.from({ length: 3 * 2500 }, (_, k) => {
    const [i, j] = [Math.floor(k / 3) % 50, Math.floor(k / 150)];
    return [0.01 * i, 0.01 * j, 0.05 + 0.04 * Math.sin(i / 5) * Math.cos(j / 5)][k % 3];
  });
  return [
    { pose: at([0.45, -0.35, 0.4]), radius: 0, vertices: text(new Float32Array(corners)), triangles: text(new Uint32Array([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3])) },
    { pose: at([0.2, 0.1, 0.4]), radius: 0.006, vertices: text(sheet) },
  ];
}

/** A pyramid with its top cut off, rounded. */
const frustum = {
  core: 'convex' as const,
  origin: [0.3, -0.1, 0] as Vec3,
  extents: [[1, 0, 0], [0, 1, 0], [0, 0, 1]] as [Vec3, Vec3, Vec3],
  vertices: [0, 1, 2, 3, 4, 5, 6, 7].map((i): Vec3 => {
    const half = i & 4 ? 0.05 : 0.1;
    return [i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? 0.6 : 0.42];
  }),
  faces: [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]],
  radius: 0.02,
};

describe.skipIf(missing('TANDEM_SMALL_PAGE'))('pictures', { timeout: kPatience }, () => {
  const pages = new Pages();
  let page: Watched | null = null;

  afterEach(async () => {
    expect(page?.complaints.splice(0)).toEqual([]);
    await page?.tab.context().close();
  }, kPatience);

  /** The page with changes to what it carries. */
  async function open(change: (data: PageData) => void, dark = false): Promise<Page> {
    const { data, around } = pageData(smallPage);
    change(data);
    mkdirSync(out, { recursive: true });
    const file = join(out, 'changed.html');
    writeFileSync(file, around(data));
    page = await pages.fromDisk(file, '#t=0.8&paused', {
      viewport: { width: 320, height: 200 },  // What is compared has a size of its own.
      colorScheme: dark ? 'dark' : 'light',
    });
    await toggle(page.tab, 'clearance');  // Its label is in whatever font there is.
    return page.tab;
  }

  const toggle = (tab: Page, name: string) => tab.locator(`[data-toggle="${name}"] input`).dispatchEvent('click');

  it('of a plan', async () => {
    const tab = await open(() => {});
    expect(compare('plan', await picture(tab, width, height))).toBe('');
  });

  it('in the dark, of volumes and padding alone, with the start', async () => {
    const tab = await open(() => {}, true);
    for (const name of ['visual', 'volumes', 'padding', 'start', 'frames']) await toggle(tab, name);
    expect(compare('volumes', await picture(tab, width, height))).toBe('');
  });

  it('of a mesh, a cloud and a convex shape', async () => {
    const tab = await open(({ scene }) => {
      const table = scene.bodies.find(({ name }) => name === 'table')!;
      scene.bodies = scene.bodies.filter(({ kind }) => kind !== 'obstacle');
      scene.bodies.push(table, { ...table, name: 'scan', shapes: [frustum], surfaces: surfaces() });
    });
    expect(compare('surfaces', await picture(tab, width, height))).toBe('');
  });

  it('without an arm, or without the smallest obstacle, are not those with it', async () => {
    const without = (data: PageData, gone: (name: string) => boolean) => {
      const { scene } = data;
      scene.bodies = scene.bodies.filter(({ name }) => !gone(name));
      scene.visuals = scene.visuals.filter(({ link }) => !gone(scene.links[link].name));
    };
    for (const gone of ['right/', 'pin']) {
      const tab = await open((data) => without(data, (name) => name.startsWith(gone)));
      const verdict = compare('plan', await picture(tab, width, height), 'meant_to_differ');
      expect(verdict, gone).toMatch(/% of .*meant_to_differ\.actual\.png differ from .*plan\.png, .*: see .*meant_to_differ\.diff\.png/);
      if (gone === 'right/') await tab.context().close();
    }
  });
});
