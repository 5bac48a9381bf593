/// Materials by role, shared and recoloured when the theme changes.

import { Color, DoubleSide, MeshBasicMaterial, MeshLambertMaterial, MeshStandardMaterial, PointsMaterial, type Material } from 'three';
import { armColor, colors, furnitureColor, kFieldOfView, mix, type Theme } from './palette';

/** The renderer takes a point's size for that at a field of view of 90 degrees. */
const kTan = Math.tan((kFieldOfView * Math.PI) / 360);

/** Light from above and ahead. */
const kBall = `
  vec2 ball = 2.0 * gl_PointCoord - 1.0;
  float ahead = 1.0 - dot(ball, ball);
  if (ahead < 0.0) discard;
  diffuseColor.rgb *= 0.5 + 0.35 * sqrt(ahead) - 0.25 * ball.y;
`;

type Paint = (theme: Theme) => string;

export class Materials {
  private readonly made = new Map<string, { material: Material & { color: Color }; paint: Paint }>();

  constructor(private theme: Theme) {}

  private get<Kind extends Material & { color: Color }>(key: string, paint: Paint, make: () => Kind): Kind {
    let entry = this.made.get(key);
    if (!entry) {
      entry = { material: make(), paint };
      entry.material.color.set(paint(this.theme));
      this.made.set(key, entry);
    }
    return entry.material as Kind;
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    for (const { material, paint } of this.made.values()) material.color.set(paint(theme));
  }

  /** A robot's own surface; `weight` is how much of its arm's colour it shows. */
  shell(arm: number, weight: number): MeshStandardMaterial {
    const paint: Paint = (theme) => {
      const plain = theme === 'light' ? '#eceff2' : '#d5dae0';
      return arm < 0 ? plain : mix(plain, armColor(arm, theme), weight);
    };
    return this.get(`shell ${arm} ${weight.toFixed(2)}`, paint, () => new MeshStandardMaterial({ roughness: 0.42, metalness: 0.05 }));
  }

  /** The colour that a mesh file asks for. */
  painted(hex: string): MeshStandardMaterial {
    return this.get(`painted ${hex}`, () => hex, () => new MeshStandardMaterial({ roughness: 0.45, metalness: 0.1, side: DoubleSide }));
  }

  furniture(index: number): MeshStandardMaterial {
    return this.get(`furniture ${index}`, (theme) => furnitureColor(index, theme), () => new MeshStandardMaterial({
      roughness: 0.75,
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    }));
  }

  attached(): MeshStandardMaterial {
    return this.get('attached', (theme) => colors.attached[theme], () => new MeshStandardMaterial({ roughness: 0.5 }));
  }

  /** A translucent skin. Where it coincides with a solid surface, a ghost lies behind it, others before it. */
  skin(key: string, arm: number, opacity: number, ghost = false): MeshLambertMaterial {
    const paint: Paint = (theme) => (arm < 0 ? (theme === 'light' ? '#7c8a99' : '#a9b6c4') : armColor(arm, theme));
    return this.get(`skin ${key} ${arm}`, paint, () => new MeshLambertMaterial({
      transparent: true,
      opacity,
      depthWrite: false,
      polygonOffset: true,
      polygonOffsetFactor: ghost ? 2 : -1,
      polygonOffsetUnits: ghost ? 24 : -16,
    }));
  }

  /** What touches; furniture is large, so it is marked less. */
  alert(faint: boolean): MeshLambertMaterial {
    return this.get(`alert ${faint}`, (theme) => colors.alert[theme], () => new MeshLambertMaterial({
      transparent: true,
      opacity: faint ? 0.28 : 0.62,
      depthWrite: false,
    }));
  }

  /** Balls of `radius` [m], one a point, that look like surfaces of another material. */
  balls(like: Material & { color: Color }, radius: number): PointsMaterial {
    const paint = [...this.made.values()].find(({ material }) => material === like)!.paint;
    return this.get(`balls ${like.uuid} ${radius}`, paint, () => {
      const material = new PointsMaterial({ size: (2 * radius) / kTan, transparent: like.transparent, opacity: like.opacity });
      material.onBeforeCompile = (shader) => {
        shader.fragmentShader = shader.fragmentShader.replace('#include <map_particle_fragment>', kBall);
      };
      return material;
    });
  }

  /** Fills depth only, so that a skin shows its nearest surface and nothing of its inside. */
  readonly depthOnly = new MeshBasicMaterial({
    colorWrite: false,
    transparent: true,
    polygonOffset: true,
    polygonOffsetFactor: 2,
    polygonOffsetUnits: 24,
  });
}
