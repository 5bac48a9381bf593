/// Visual meshes: files to plain geometry with colours. Nothing is fetched but the file itself.

import { BufferGeometry, LoadingManager, Matrix4, Mesh, type Material, type Object3D } from 'three';
import { ColladaLoader } from 'three/examples/jsm/loaders/ColladaLoader.js';
import { OBJLoader } from 'three/examples/jsm/loaders/OBJLoader.js';
import { STLLoader } from 'three/examples/jsm/loaders/STLLoader.js';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';

/** A piece of a link's surface; a colour of null takes that of its arm. */
export interface Piece {
  geometry: BufferGeometry;
  color: string | null;
}

export type MeshSource = (index: number) => Promise<ArrayBuffer>;

export class MeshStore {
  private readonly loaded = new Map<number, Promise<Piece[]>>();

  constructor(private readonly source: MeshSource) {}

  /** Each file is read once. */
  load(index: number, type: string): Promise<Piece[]> {
    let pieces = this.loaded.get(index);
    if (!pieces) {
      pieces = this.source(index).then((bytes) => parseMesh(bytes, type));
      this.loaded.set(index, pieces);
    }
    return pieces;
  }
}

export function parseMesh(bytes: ArrayBuffer, type: string): Piece[] {
  switch (type.toLowerCase()) {
    case '.stl':
      return [{ geometry: plain(new STLLoader().parse(bytes)), color: null }];
    case '.obj':
      return flatten(new OBJLoader().parse(new TextDecoder().decode(bytes)), false);
    case '.dae': {
      // URDF takes the numbers of a mesh as they are, whatever axis the file calls up.
      const text = new TextDecoder().decode(bytes).replace(/<up_axis>.*?<\/up_axis>/, '<up_axis>Y_UP</up_axis>');
      const collada = new ColladaLoader(withoutTextures()).parse(text, '');
      if (!collada) throw new Error('not a COLLADA document');
      return flatten(collada.scene, true);
    }
    default:
      throw new Error(`meshes of type "${type}" are not shown: .dae, .obj and .stl are`);
  }
}

/** Textures would be further files: a single grey pixel stands for each. */
function withoutTextures(): LoadingManager {
  const pixel = 'data:image/gif;base64,R0lGODlhAQABAIAAAMLCwgAAACH5BAAAAAAALAAAAAABAAEAAAICRAEAOw==';
  return new LoadingManager().setURLModifier(() => pixel);
}

/** All triangles of an object in its own frame, one piece per colour. */
function flatten(root: Object3D, coloured: boolean): Piece[] {
  root.updateMatrixWorld(true);
  const byColor = new Map<string | null, BufferGeometry[]>();
  root.traverse((node) => {
    if (!(node instanceof Mesh)) return;
    const geometry = plain(node.geometry as BufferGeometry, node.matrixWorld);
    const materials = (Array.isArray(node.material) ? node.material : [node.material]) as Material[];
    const groups = geometry.groups.length ? geometry.groups : [{ start: 0, count: Infinity, materialIndex: 0 }];
    for (const { start, count, materialIndex } of groups) {
      const color = coloured ? colorOf(materials[materialIndex ?? 0]) : null;
      const list = byColor.get(color) ?? [];
      list.push(slice(geometry, start, count));
      byColor.set(color, list);
    }
  });
  return [...byColor].map(([color, list]) => ({ geometry: merge(list), color }));
}

function colorOf(material: Material | undefined): string | null {
  const color = (material as { color?: { getHexString(): string } } | undefined)?.color;
  return color ? `#${color.getHexString()}` : null;
}

/** Positions and normals only, without index: what every file can be merged as. */
function plain(source: BufferGeometry, X?: Matrix4): BufferGeometry {
  const geometry = source.index ? source.toNonIndexed() : source.clone();
  for (const name of Object.keys(geometry.attributes)) {
    if (name !== 'position' && name !== 'normal') geometry.deleteAttribute(name);
  }
  if (!geometry.getAttribute('normal')) geometry.computeVertexNormals();
  if (X) geometry.applyMatrix4(X);
  return geometry;
}

function slice(source: BufferGeometry, start: number, count: number): BufferGeometry {
  const end = Math.min(start + count, source.getAttribute('position').count);
  const part = new BufferGeometry();
  for (const name of ['position', 'normal']) {
    const attribute = source.getAttribute(name).clone();
    attribute.array = attribute.array.slice(3 * start, 3 * end);
    (attribute as { count: number }).count = end - start;
    part.setAttribute(name, attribute);
  }
  return part;
}

export function merge(list: BufferGeometry[]): BufferGeometry {
  if (list.length === 1) return list[0];
  if (list.every((geometry) => geometry.index)) return mergeGeometries(list);
  return mergeGeometries(list.map((geometry) => (geometry.index ? geometry.toNonIndexed() : geometry)));
}
