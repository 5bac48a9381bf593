/// Marks in the scene: labels, measured lines, coordinate frames.

import {
  BufferGeometry,
  CanvasTexture,
  Color,
  ConeGeometry,
  CylinderGeometry,
  Float32BufferAttribute,
  Group,
  Mesh,
  MeshBasicMaterial,
  Sprite,
  SpriteMaterial,
  SRGBColorSpace,
  Vector2,
  Vector3,
  type Camera,
  type WebGLRenderer,
} from 'three';
import { Line2 } from 'three/examples/jsm/lines/Line2.js';
import { LineGeometry } from 'three/examples/jsm/lines/LineGeometry.js';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';
import { colors, type Theme } from './palette';
import type { Vec3 } from './types';

/** Scale of an unattenuated sprite that makes it one pixel high. */
function unitsPerPixel(renderer: WebGLRenderer, camera: Camera): number {
  const height = renderer.getSize(new Vector2()).y;
  return 2 / (camera.projectionMatrix.elements[5] * height);
}

/** Pixels that a mark takes: a little more in large pictures. */
function scaled(pixels: number, renderer: WebGLRenderer): number {
  const height = renderer.getSize(new Vector2()).y;
  return pixels * Math.min(Math.max(height / 520, 0.8), 1.8);
}

/** A sprite that is `pixels` high on every screen. */
class Mark extends Sprite {
  constructor(material: SpriteMaterial, private readonly pixels: number, private readonly aspect: number) {
    super(material);
  }

  override onBeforeRender = (renderer: WebGLRenderer, _: unknown, camera: Camera): void => {
    const height = scaled(this.pixels, renderer) * unitsPerPixel(renderer, camera);
    this.matrixWorld.elements[0] = height * this.aspect;
    this.matrixWorld.elements[5] = height;
  };
}

/** Text over everything. */
export class Label extends Mark {
  private readonly canvas = document.createElement('canvas');
  private readonly texture: CanvasTexture;
  private text = '';

  constructor() {
    super(new SpriteMaterial({ depthTest: false, depthWrite: false, sizeAttenuation: false, toneMapped: false }), 52, 4);
    this.canvas.width = 512;
    this.canvas.height = 128;
    this.texture = new CanvasTexture(this.canvas);
    this.texture.colorSpace = SRGBColorSpace;
    this.texture.generateMipmaps = false;
    this.material.map = this.texture;
    this.renderOrder = 100;
    this.center.set(0.5, -0.35);
  }

  override dispose(): void {
    this.texture.dispose();
    this.material.dispose();
  }

  /** Draws only when something changed. */
  set(lines: string[], color: string, theme: Theme): void {
    const text = [...lines, color, theme].join('\n');
    if (text === this.text) return;
    this.text = text;
    const g = this.canvas.getContext('2d')!;
    g.clearRect(0, 0, 512, 128);
    g.textAlign = 'center';
    const fonts = ['600 40px system-ui, sans-serif', '25px system-ui, sans-serif'];
    const width = Math.min(508, 40 + Math.max(...lines.map((line, i) => ((g.font = fonts[i]), g.measureText(line).width))));
    const height = lines.length > 1 ? 104 : 62;
    g.fillStyle = theme === 'light' ? 'rgba(255,255,255,0.9)' : 'rgba(18,22,27,0.88)';
    g.strokeStyle = color;
    g.lineWidth = 3;
    g.beginPath();
    g.roundRect(256 - width / 2, 124 - height, width, height, 14);
    g.fill();
    g.stroke();
    const ink = [color, theme === 'light' ? '#39434e' : '#c3ccd6'];
    lines.forEach((line, i) => {
      g.font = fonts[i];
      g.fillStyle = ink[i];
      g.fillText(line, 256, 124 - height + 45 + 40 * i, 476);
    });
    this.texture.needsUpdate = true;
  }
}

/** 0.0058 m as people say it. */
export function formatLength(metres: number): string {
  const size = Math.abs(metres);
  if (size > 0 && size < 1e-5) return `${(metres * 1e6).toPrecision(2)} µm`;
  if (size < 1e-3) return `${(metres * 1e3).toFixed(2)} mm`;
  if (size < 0.1) return `${(metres * 1e3).toFixed(1)} mm`;
  return `${(metres * 1e2).toFixed(1)} cm`;
}

/** The line between the nearest points of two bodies, with what it measures. */
export class Measure extends Group {
  private readonly line: Line2;
  private readonly ends: Sprite[];
  private label: Label | null = null;

  constructor() {
    super();
    this.line = new Line2(new LineGeometry(), new LineMaterial({ linewidth: 3, depthTest: false, transparent: true, toneMapped: false }));
    this.line.renderOrder = 98;
    this.line.frustumCulled = false;
    const ring = ringTexture();
    this.ends = [0, 1].map(() => {
      const sprite = new Mark(new SpriteMaterial({ map: ring, depthTest: false, sizeAttenuation: false, toneMapped: false }), 17, 1);
      sprite.renderOrder = 99;
      return sprite;
    });
    this.add(this.line, ...this.ends);
  }

  /** Without lines there is no label. */
  set(a: Vec3, b: Vec3, lines: string[], color: string, theme: Theme): void {
    this.line.geometry.setPositions([...a, ...b]);
    this.line.material.color.set(color);
    this.ends.forEach((end, i) => {
      end.position.fromArray(i ? b : a);
      end.material.color.set(color);
    });
    if (lines.length === 0) return;
    if (!this.label) {
      this.label = new Label();
      this.add(this.label);
    }
    this.label.position.fromArray(a).lerp(new Vector3(...b), 0.5);
    this.label.set(lines, color, theme);
  }

  override dispose(): void {
    this.line.geometry.dispose();
    this.line.material.dispose();
    for (const end of this.ends) end.material.dispose();
    this.label?.dispose();
  }
}

let ring: CanvasTexture | null = null;
function ringTexture(): CanvasTexture {
  if (ring) return ring;
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 64;
  const g = canvas.getContext('2d')!;
  g.strokeStyle = g.fillStyle = '#fff';
  g.lineWidth = 7;
  g.beginPath();
  g.arc(32, 32, 26, 0, 2 * Math.PI);
  g.stroke();
  g.beginPath();
  g.arc(32, 32, 10, 0, 2 * Math.PI);
  g.fill();
  ring = new CanvasTexture(canvas);
  return ring;
}

/** Axes x, y, z of a frame, `size` metres long. */
export function frameMark(size: number): Mesh {
  const parts: BufferGeometry[] = [];
  [0, 1, 2].forEach((axis) => {
    const shaft = new CylinderGeometry(0.022 * size, 0.022 * size, 0.8 * size, 10).translate(0, 0.4 * size, 0);
    const head = new ConeGeometry(0.06 * size, 0.2 * size, 12).translate(0, 0.9 * size, 0);
    for (const part of [shaft, head]) {
      if (axis === 0) part.rotateZ(-Math.PI / 2);
      if (axis === 2) part.rotateX(Math.PI / 2);
      const color = new Color(colors.axes[axis]);
      const count = part.getAttribute('position').count;
      part.setAttribute('color', new Float32BufferAttribute(Array.from({ length: count }, () => color.toArray()).flat(), 3));
      parts.push(part);
    }
  });
  const mark = new Mesh(mergeGeometries(parts), new MeshBasicMaterial({ vertexColors: true, toneMapped: false }));
  mark.matrixAutoUpdate = false;
  return mark;
}
