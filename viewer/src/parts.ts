/// What the links look like: visual geometry, collision volumes, padded volumes.

import { BufferGeometry, Matrix4, Vector3 } from 'three';
import { merge, type MeshStore, type Piece } from './meshes';
import { poseMatrix } from './model';
import { primitives, shapeGeometry } from './shapes';
import type { BodyData, SceneData, VisualData } from './types';

export class Parts {
  private readonly pieces: (Piece[] | null)[];
  private readonly volumes = new Map<string, BufferGeometry>();

  constructor(readonly scene: SceneData) {
    this.pieces = scene.visuals.map((visual) => primitive(visual, scene.visuals));
  }

  /** Loads mesh files one after another; `ready` is called per link that changed. */
  async loadMeshes(store: MeshStore, ready: (link: number) => void, failed: (message: string) => void): Promise<void> {
    for (const [i, visual] of this.scene.visuals.entries()) {
      if (!visual.mesh) continue;
      const { index, type, scale } = visual.mesh;
      try {
        const X_LG = poseMatrix(visual.pose).scale(new Vector3(...scale));
        this.pieces[i] = (await store.load(index, type)).map(({ geometry, color }) => ({
          geometry: transformed(geometry, X_LG),
          color,
        }));
        ready(visual.link);
      } catch (error) {
        failed(`mesh ${index} of ${this.scene.links[visual.link].name}: ${(error as Error).message}`);
      }
      await new Promise((resolve) => setTimeout(resolve));  // Let the page answer in between.
    }
  }

  /** What the link itself looks like; its volumes until all of its meshes have arrived. */
  visual(link: number): Piece[] {
    const own = this.scene.visuals.flatMap((visual, i) => (visual.link === link ? [this.pieces[i]] : []));
    if (own.length && own.every((pieces) => pieces !== null)) return mergeByColor(own.flat() as Piece[]);
    return this.bodiesOf(link, 'robot').map((body) => ({ geometry: this.volume(body), color: null }));
  }

  bodiesOf(link: number, kind: BodyData['kind']): BodyData[] {
    return this.scene.bodies.filter((body) => body.link === link && body.kind === kind);
  }

  /** The swept sphere volumes of a body in its link's frame, inflated by its padding if asked for. */
  volume(body: BodyData, padded = false): BufferGeometry {
    const key = `${body.name} ${padded}`;
    let geometry = this.volumes.get(key);
    if (!geometry) {
      geometry = merge(body.shapes.map((shape) => shapeGeometry(shape, padded ? body.padding : 0)));
      this.volumes.set(key, geometry);
    }
    return geometry;
  }
}

function transformed(geometry: BufferGeometry, X: Matrix4): BufferGeometry {
  const copy = geometry.clone().applyMatrix4(X);
  if (X.determinant() < 0) flip(copy);
  return copy;
}

/** A mirrored mesh shows its inside: turn its triangles around. */
function flip(geometry: BufferGeometry): void {
  for (const name of ['position', 'normal']) {
    const attribute = geometry.getAttribute(name);
    for (let i = 0; i + 2 < attribute.count; i += 3) {
      const [b, c] = [i + 1, i + 2].map((k) => new Vector3().fromBufferAttribute(attribute, k));
      attribute.setXYZ(i + 1, c.x, c.y, c.z);
      attribute.setXYZ(i + 2, b.x, b.y, b.z);
    }
  }
}

function mergeByColor(pieces: Piece[]): Piece[] {
  const colors = [...new Set(pieces.map((piece) => piece.color))];
  return colors.map((color) => ({
    color,
    geometry: merge(pieces.filter((piece) => piece.color === color).map((piece) => piece.geometry)),
  }));
}

/** Whether a sphere of the same link closes the end of a cylinder: its flat end would only flicker in it. */
function isCapped({ link, pose, cylinder }: VisualData, side: number, all: VisualData[]): boolean {
  if (!cylinder) return false;
  const end = new Vector3(0, 0, (side * cylinder.length) / 2).applyMatrix4(poseMatrix(pose));
  return all.some((other) =>
    other.link === link &&
    Math.abs((other.sphere ?? -1) - cylinder.radius) < 1e-5 &&
    end.distanceTo(new Vector3(...other.pose.xyz)) < 1e-4,
  );
}

/** Null for a mesh that has not been loaded. */
function primitive(visual: VisualData, all: VisualData[]): Piece[] | null {
  let geometry: BufferGeometry;
  if (visual.box) {
    geometry = primitives.box(visual.box);
  } else if (visual.sphere !== undefined) {
    geometry = primitives.sphere(visual.sphere);
  } else if (visual.cylinder) {
    const { radius, length } = visual.cylinder;
    geometry = primitives.cylinder(radius, length, !isCapped(visual, 1, all), !isCapped(visual, -1, all));
  } else {
    return visual.mesh ? null : [];
  }
  return [{ geometry: geometry.applyMatrix4(poseMatrix(visual.pose)), color: null }];
}
