/// What the links look like: visual geometry, collision volumes, padded volumes.

import { Box3, BufferGeometry, Matrix4, Vector3 } from 'three';
import { merge, type MeshStore, type Piece } from './meshes';
import { poseMatrix } from './model';
import { primitives, shapeGeometry } from './shapes';
import { cloudGeometry, isCloud, meshGeometry } from './surfaces';
import type { BodyData, SceneData, VisualData } from './types';

/** Points that are balls. */
export interface Cloud {
  geometry: BufferGeometry;
  radius: number;
}

export class Parts {
  private readonly pieces: (Piece[] | null)[];
  private readonly volumes: Map<BodyData, BufferGeometry | null>[] = [new Map(), new Map()];  // Plain, padded.
  private readonly points = new Map<BodyData, Cloud[]>();
  private moved: BodyData[] = [];

  /** The cell's bodies, each where it is now. */
  bodies: BodyData[];

  constructor(readonly scene: SceneData) {
    this.bodies = scene.bodies;
    this.pieces = scene.visuals.map((visual) => primitive(visual, scene.visuals));
  }

  /** Bodies that are elsewhere than in the scene; those of the last call are back where the scene has them. Says which links changed. */
  setMoved(moved: BodyData[]): Set<number> {
    const before = this.bodies;
    for (const body of this.moved) this.forget(body);
    this.moved = moved;
    const byName = new Map(moved.map((body) => [body.name, body]));
    this.bodies = this.scene.bodies.map((body) => byName.get(body.name) ?? body);
    return new Set(this.bodies.flatMap((body, i) => (body === before[i] ? [] : [before[i].link, body.link])));
  }

  private forget(body: BodyData): void {
    for (const volumes of this.volumes) {
      volumes.get(body)?.dispose();
      volumes.delete(body);
    }
    for (const { geometry } of this.points.get(body) ?? []) geometry.dispose();
    this.points.delete(body);
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
    return this.bodiesOf(link, 'robot').flatMap((body) => {
      const geometry = this.volume(body);
      return geometry ? [{ geometry, color: null }] : [];
    });
  }

  bodiesOf(link: number, kind: BodyData['kind']): BodyData[] {
    return this.bodies.filter((body) => body.link === link && body.kind === kind);
  }

  /** The shapes and meshes of a body in its link's frame, inflated by its padding if asked for; null if it has none. */
  volume(body: BodyData, padded = false): BufferGeometry | null {
    const volumes = this.volumes[padded ? 1 : 0];
    let geometry = volumes.get(body);
    if (geometry === undefined) {
      const padding = padded ? body.padding : 0;
      const pieces = [
        ...body.shapes.map((shape) => shapeGeometry(shape, padding)),
        ...body.surfaces.filter((surface) => !isCloud(surface)).map((surface) => meshGeometry(surface, padding)),
      ];
      geometry = pieces.length ? merge(pieces) : null;
      volumes.set(body, geometry);
    }
    return geometry;
  }

  /** The clouds of a body in its link's frame. */
  clouds(body: BodyData): Cloud[] {
    let clouds = this.points.get(body);
    if (!clouds) {
      clouds = body.surfaces.filter(isCloud).map((surface) => ({ geometry: cloudGeometry(surface), radius: surface.radius }));
      this.points.set(body, clouds);
    }
    return clouds;
  }

  /** What contains all of a body, in its link's frame. */
  box(body: BodyData): Box3 {
    const box = new Box3();
    const volume = this.volume(body);
    if (volume) box.union(boxOf(volume));
    for (const { geometry, radius } of this.clouds(body)) box.union(boxOf(geometry).expandByScalar(radius));
    return box;
  }
}

function boxOf(geometry: BufferGeometry): Box3 {
  if (!geometry.boundingBox) geometry.computeBoundingBox();
  return geometry.boundingBox!.clone();
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
