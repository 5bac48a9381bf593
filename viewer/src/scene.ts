/// The cell in three dimensions: robots, furniture, ghosts, traces and marks.

import { Box3, Group, Matrix4, Mesh, Vector3 } from 'three';
import { Bodies } from './bodies';
import { Figure, skin, solid } from './figure';
import { Furniture } from './furniture';
import { formatLength, frameMark, Measure } from './markers';
import { Materials } from './materials';
import { Kinematics } from './model';
import { colors, type Theme } from './palette';
import { Parts } from './parts';
import { clearanceAt, type CellMotion } from './spline';
import { Stage } from './stage';
import { Traces } from './traces';
import type { BodyData, ClearanceSample, Phase, SceneData, Touching } from './types';

/** What can be switched on and off; phases of a plan come as `phase:NAME`. */
export type Toggle =
  | 'visual' | 'volumes' | 'padding' | 'obstacles' | 'frames'
  | 'motion' | 'clearance' | 'start' | 'goal' | `phase:${string}`;

export type View = 'home' | 'top' | 'front' | 'side';

const kLabels = 2;  // More of them hide each other.
const kDefaults: Toggle[] = ['visual', 'obstacles', 'motion', 'clearance', 'goal'];

export class CellView {
  readonly stage: Stage;
  readonly kinematics: Kinematics;
  readonly parts: Parts;
  readonly traces: Traces;
  private readonly materials: Materials;
  private readonly on = new Set<Toggle>(kDefaults);
  private readonly figures: Record<'visual' | 'volumes' | 'padding' | 'start' | 'goal' | 'alert', Figure>;
  private readonly bodies: Bodies;
  private readonly obstacles: Furniture;
  private readonly frames = new Group();
  private readonly toolFrames: Mesh[] = [];
  private readonly measure = new Measure();
  private readonly touching = new Group();
  private readonly X_WL: Matrix4[];
  private readonly X_other: Matrix4[];
  private motion: CellMotion | null = null;
  private clearance: ClearanceSample[] = [];
  private ends: (number[] | null)[] = [];
  private q: number[] = [];
  private view: View = 'home';
  private time = 0;

  constructor(canvas: HTMLCanvasElement, readonly scene: SceneData, private theme: Theme, draft: boolean, readonly changed: () => void) {
    this.stage = new Stage(canvas, draft, changed);
    this.kinematics = new Kinematics(scene);
    this.parts = new Parts(scene);
    this.materials = new Materials(theme);
    this.bodies = new Bodies(this.parts, this.materials);
    this.traces = new Traces(this.kinematics, theme);
    this.X_WL = this.kinematics.makePoses();
    this.X_other = this.kinematics.makePoses();
    const figure = () => new Figure(scene.links.length);
    this.figures = { visual: figure(), volumes: figure(), padding: figure(), start: figure(), goal: figure(), alert: figure() };
    this.kinematics.linkPoses(scene.home, this.X_WL);
    this.obstacles = new Furniture(this.X_WL, this.parts, this.bodies, this.materials);
    this.stage.setGround(this.obstacles.ground);
    this.buildFrames();
    scene.links.forEach((_, link) => this.buildLink(link));
    this.stage.scene.add(
      this.obstacles, this.obstacles.padded, this.frames, this.traces, this.measure, this.touching,
      ...Object.values(this.figures),
    );
    this.show(scene.home, 0);
    this.setTheme(theme);
    this.apply();
  }

  // ---- what is shown

  isOn(toggle: Toggle): boolean {
    return this.on.has(toggle);
  }

  toggle(toggle: Toggle, on: boolean): void {
    if (on) this.on.add(toggle);
    else this.on.delete(toggle);
    this.apply();
    if (toggle === 'visual' || toggle === 'volumes') this.scene.links.forEach((_, link) => this.buildVolumes(link));
    this.changed();
  }

  get hasPadding(): boolean {
    return this.parts.bodies.some((body) => body.padding > 0);
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    this.stage.setTheme(theme);
    this.materials.setTheme(theme);
    this.traces.setTheme(theme);
    this.obstacles.setTheme(theme);
    this.mark();
    this.changed();
  }

  /** The cell at configuration q; t chooses the clearance and the bold part of the traces. */
  show(q: ArrayLike<number>, t: number): void {
    this.time = t;
    this.q = Array.from(q);
    this.kinematics.linkPoses(q, this.X_WL);
    for (const name of ['visual', 'volumes', 'padding'] as const) this.figures[name].pose(this.X_WL);
    this.toolFrames.forEach((mark, arm) => {
      this.kinematics.toolPose(arm, this.X_WL, mark.matrix);
      mark.matrixWorldNeedsUpdate = true;
    });
    this.traces.setTime(t);
    this.stage.moved();
    this.mark();
  }

  /** Objects that are elsewhere than in the scene, in hands or put down; all others are where it has them. */
  setObjects(objects: BodyData[]): void {
    this.setTouching([], null);
    const links = this.parts.setMoved(objects);
    if (links.size === 0) return;
    this.obstacles.rebuild();
    for (const link of links) this.buildLink(link);
    this.show(this.q, this.time);
    this.setEnds(this.ends[0] ?? null, this.ends[1] ?? null);
  }

  setPlan(motion: CellMotion | null, phases: Phase[], clearance: ClearanceSample[]): void {
    this.motion = motion;
    this.clearance = clearance;
    this.traces.set(motion, phases, (name) => this.on.has(name === 'motion' ? 'motion' : `phase:${name}`));
    this.apply();
  }

  setEnds(start: number[] | null, goal: number[] | null): void {
    this.ends = [start, goal];
    for (const [name, q] of [['start', start], ['goal', goal]] as const) {
      if (!q) continue;
      this.kinematics.linkPoses(q, this.X_other);
      this.figures[name].pose(this.X_other);
    }
    this.apply();
    this.changed();
  }

  /** Bodies that touch at configuration q, and how deep. */
  setTouching(touching: Touching[], q: number[] | null): void {
    for (const mark of this.touching.children) (mark as Measure).dispose();
    this.touching.clear();
    this.figures.alert.empty();
    const deepestFirst = [...touching].sort((a, b) => a.distance - b.distance);
    deepestFirst.forEach((pair, i) => {
      const mark = new Measure();
      const depth = pair.distance < 0 ? `${formatLength(-pair.distance)} deep` : formatLength(pair.distance);
      mark.set(pair.a, pair.b, i < kLabels ? [depth, pair.pair] : [], colors.alert[this.theme], this.theme);
      this.touching.add(mark);
    });
    this.mark();
    const names = new Set(touching.flatMap((pair) => this.bodiesOfPair(pair.pair)));
    const links = new Map<number, BodyData[]>();
    for (const body of this.parts.bodies) {
      if (names.has(body.name)) links.set(body.link, [...(links.get(body.link) ?? []), body]);
    }
    for (const [link, bodies] of links) {
      this.figures.alert.setLink(link, bodies.flatMap((body) => this.bodies.skin(body, this.materials.alert(body.kind === 'obstacle'), 50)));
    }
    if (q) this.kinematics.linkPoses(q, this.X_other);
    this.figures.alert.pose(q ? this.X_other : this.X_WL);
    this.changed();
  }

  /** "left/panda_hand and box" names two bodies; their names may hold "and" themselves. */
  bodiesOfPair(pair: string): string[] {
    const known = new Set(this.scene.bodies.map((body) => body.name));
    const words = pair.split(' and ');
    for (let k = 1; k < words.length; ++k) {
      const names = [words.slice(0, k).join(' and '), words.slice(k).join(' and ')];
      if (names.every((name) => known.has(name))) return names;
    }
    return [];
  }

  render(): void {
    this.stage.render();
  }

  // ---- the camera

  frame(view: View = 'home'): void {
    this.view = view;
    const configurations = this.configurations();
    const points = this.robotPoints(configurations);
    const box = new Box3().setFromPoints(points);
    const radius = box.getSize(new Vector3()).length() / 2;
    this.stage.light(box.getCenter(new Vector3()), 2 * radius);
    this.stage.frame(points, this.direction(view, configurations));
    this.changed();
  }

  /** After something new came: the view that was framed last, unless a person has turned it since. */
  frameAgain(): void {
    if (!this.stage.handled) this.frame(this.view);
  }

  /** Where the robots go. */
  private configurations(): ArrayLike<number>[] {
    const { motion } = this;
    const ends = this.ends.filter((q) => q !== null);
    if (!motion) return [this.q, ...ends];
    return Array.from({ length: 7 }, (_, i) => motion.evaluate((motion.duration * i) / 6, 0, new Array<number>(this.kinematics.dof)));
  }

  private direction(view: View, configurations: ArrayLike<number>[]): Vector3 {
    if (view === 'top') return new Vector3(-0.001, 0, 1);
    const front = new Vector3();  // From the bases to the tools, on average.
    const X_WE = new Matrix4();
    for (const q of configurations) {
      this.kinematics.linkPoses(q, this.X_other);
      this.scene.arms.forEach((_, arm) => {
        front.add(new Vector3().setFromMatrixPosition(this.kinematics.toolPose(arm, this.X_other, X_WE)));
        front.sub(new Vector3().setFromMatrixPosition(this.X_other[this.kinematics.baseLink(arm)]));
      });
    }
    front.setZ(0).divideScalar(Math.max(configurations.length, 1));
    // To the nearest eighth of a turn, so that plans of one cell are seen from the same side.
    const eighth = Math.PI / 4;
    const angle = front.length() < 0.05 ? 0 : eighth * Math.round(Math.atan2(front.y, front.x) / eighth);
    front.set(Math.cos(angle), Math.sin(angle), 0);
    if (view === 'front') return front.setZ(0.12);
    if (view === 'side') return front.applyAxisAngle(new Vector3(0, 0, 1), -Math.PI / 2).setZ(0.12);
    return front.applyAxisAngle(new Vector3(0, 0, 1), -0.52).setZ(0.42);
  }

  private robotPoints(configurations: ArrayLike<number>[]): Vector3[] {
    const points = [...this.traces.points];
    const robots = this.scene.bodies.filter((body) => body.kind === 'robot');
    for (const q of configurations) {
      this.kinematics.linkPoses(q, this.X_other);
      for (const body of robots) {
        points.push(...corners(this.parts.box(body)).map((p) => p.applyMatrix4(this.X_other[body.link])));
      }
    }
    return points;
  }

  // ---- building

  /** Called again when a mesh of the link has arrived. */
  buildLink(link: number): void {
    const arm = this.kinematics.armOfLink(link);
    const depth = this.kinematics.depthOfLink(link);
    const dof = arm < 0 ? 1 : this.scene.arms[arm].dof;
    const shell = this.materials.shell(arm, depth >= dof ? 0.92 : 0.1 + (0.35 * depth) / dof);
    const pieces = this.parts.visual(link);
    const attached = this.parts.bodiesOf(link, 'attached');
    this.figures.visual.setLink(link, [
      ...pieces.map(({ geometry, color }) => solid(geometry, color === null ? shell : this.materials.painted(color))),
      ...attached.flatMap((body) => this.bodies.solid(body, this.materials.attached())),
    ]);
    const order = { goal: 10, start: 20 };
    for (const end of ['goal', 'start'] as const) {
      if (arm < 0) continue;
      const material = this.materials.skin(end, arm, end === 'goal' ? 0.34 : 0.2, true);
      this.figures[end].setLink(link, [
        ...pieces.flatMap(({ geometry }) => skin(geometry, material, this.materials.depthOnly, order[end])),
        ...attached.flatMap((body) => this.bodies.skin(body, material, order[end])),
      ]);
    }
    this.stage.moved();
    this.buildVolumes(link);
    const padded = this.parts.bodies.filter((body) => body.link === link && body.padding > 0 && body.kind !== 'obstacle');
    const padding = this.materials.skin('padding', arm, 0.3);
    this.figures.padding.setLink(link, padded.flatMap((body) => this.bodies.skin(body, padding, 40, true)));
    this.changed();
  }

  /** Volumes are solid alone, and a skin over the visual geometry. */
  private buildVolumes(link: number): void {
    const arm = this.kinematics.armOfLink(link);
    const { materials } = this;
    const over = this.on.has('visual');
    const bodies = this.parts.bodies.filter((body) => body.link === link && body.kind !== 'obstacle');
    this.figures.volumes.setLink(link, bodies.flatMap((body) => {
      if (over) return this.bodies.skin(body, materials.skin('volume', arm, 0.45), 30);
      return this.bodies.solid(body, body.kind === 'attached' ? materials.attached() : materials.shell(arm, 0.75));
    }));
  }

  private buildFrames(): void {
    this.frames.add(frameMark(0.25));
    this.scene.arms.forEach((_, arm) => {
      const base = frameMark(0.2);
      base.matrix.copy(this.X_WL[this.kinematics.baseLink(arm)]);
      this.toolFrames[arm] = frameMark(0.12);
      this.frames.add(base, this.toolFrames[arm]);
    });
  }

  private apply(): void {
    const { on, figures } = this;
    figures.visual.visible = on.has('visual');
    figures.volumes.visible = on.has('volumes');
    figures.padding.visible = this.obstacles.padded.visible = on.has('padding');
    figures.start.visible = on.has('start') && Boolean(this.ends[0]);
    figures.goal.visible = on.has('goal') && Boolean(this.ends[1]);
    this.obstacles.visible = on.has('obstacles');
    this.stage.moved();
    this.frames.visible = on.has('frames');
    this.traces.show('motion', on.has('motion'));
    for (const toggle of this.phaseToggles) this.traces.show(toggle.slice('phase:'.length), on.has(toggle));
    this.mark();
  }

  /** Toggles of the phases that were ever offered. */
  readonly phaseToggles = new Set<Toggle>();

  /** The line of least clearance at the current time. */
  private mark(): void {
    const sample = this.on.has('clearance') && this.touching.children.length === 0 ? clearanceAt(this.clearance, this.time) : null;
    this.measure.visible = sample !== null;
    if (!sample) return;
    const color = sample.distance > 0 ? colors.clearance[this.theme] : colors.alert[this.theme];
    this.measure.set(sample.a, sample.b, [formatLength(sample.distance), sample.pair], color, this.theme);
  }
}

function corners({ min, max }: Box3): Vector3[] {
  return [min.x, max.x].flatMap((x) => [min.y, max.y].flatMap((y) => [min.z, max.z].map((z) => new Vector3(x, y, z))));
}
