/// The cell in three dimensions: robots, furniture, ghosts, traces and marks.

import { Box3, EdgesGeometry, Group, LineBasicMaterial, LineSegments, Matrix4, Mesh, Vector3, type Object3D } from 'three';
import { Figure, skin, solid } from './figure';
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
  private readonly obstacles = new Group();
  private readonly paddedObstacles = new Group();
  private readonly edges = new LineBasicMaterial({ transparent: true, opacity: 0.3, toneMapped: false });
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

  constructor(canvas: HTMLCanvasElement, readonly scene: SceneData, private theme: Theme, readonly changed: () => void) {
    this.stage = new Stage(canvas, changed);
    this.kinematics = new Kinematics(scene);
    this.parts = new Parts(scene);
    this.materials = new Materials(theme);
    this.traces = new Traces(this.kinematics, theme);
    this.X_WL = this.kinematics.makePoses();
    this.X_other = this.kinematics.makePoses();
    const figure = () => new Figure(scene.links.length);
    this.figures = { visual: figure(), volumes: figure(), padding: figure(), start: figure(), goal: figure(), alert: figure() };
    this.buildObstacles();
    this.buildFrames();
    scene.links.forEach((_, link) => this.buildLink(link));
    this.stage.scene.add(
      this.obstacles, this.paddedObstacles, this.frames, this.traces, this.measure, this.touching,
      ...Object.values(this.figures),
    );
    this.show(this.kinematics.restingPosition(), 0);
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
    return this.scene.bodies.some((body) => body.padding > 0);
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    this.stage.setTheme(theme);
    this.materials.setTheme(theme);
    this.traces.setTheme(theme);
    this.edges.color.set(theme === 'light' ? '#2c3640' : '#c9d4df');
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
    for (const body of this.scene.bodies) {
      if (names.has(body.name)) links.set(body.link, [...(links.get(body.link) ?? []), body]);
    }
    for (const [link, bodies] of links) {
      const meshes = bodies.flatMap((body) => skin(this.parts.volume(body), this.materials.alert(body.kind === 'obstacle'), this.materials.depthOnly, 50));
      this.figures.alert.setLink(link, meshes);
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
        const hull = corners(geometryBox(this.parts.volume(body)));
        points.push(...hull.map((p) => p.applyMatrix4(this.X_other[body.link])));
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
    const attached = this.parts.bodiesOf(link, 'attached').map((body) => this.parts.volume(body));
    this.figures.visual.setLink(link, [
      ...pieces.map(({ geometry, color }) => solid(geometry, color === null ? shell : this.materials.painted(color))),
      ...attached.map((geometry) => solid(geometry, this.materials.attached())),
    ]);
    const surfaces = [...pieces.map((piece) => piece.geometry), ...attached];
    const order = { goal: 10, start: 20 };
    for (const end of ['goal', 'start'] as const) {
      if (arm < 0) continue;
      const material = this.materials.skin(end, arm, end === 'goal' ? 0.34 : 0.2, true);
      this.figures[end].setLink(link, surfaces.flatMap((g) => skin(g, material, this.materials.depthOnly, order[end])));
    }
    this.stage.moved();
    this.buildVolumes(link);
    const padded = this.scene.bodies.filter((body) => body.link === link && body.padding > 0 && body.kind !== 'obstacle');
    this.figures.padding.setLink(link, padded.flatMap((body) => this.paddedSkin(body)));
    this.changed();
  }

  /** Volumes are solid alone, and a skin over the visual geometry. */
  private buildVolumes(link: number): void {
    const arm = this.kinematics.armOfLink(link);
    const { materials, parts } = this;
    const bodies = this.scene.bodies.filter((body) => body.link === link && body.kind !== 'obstacle');
    const over = this.on.has('visual');
    const objects = bodies.flatMap((body) => {
      const geometry = parts.volume(body);
      if (over) return skin(geometry, materials.skin('volume', arm, 0.45), materials.depthOnly, 30);
      return [solid(geometry, body.kind === 'attached' ? materials.attached() : materials.shell(arm, 0.75))];
    });
    this.figures.volumes.setLink(link, objects);
  }

  private paddedSkin(body: BodyData): Mesh[] {
    const material = this.materials.skin('padding', this.kinematics.armOfLink(body.link), 0.3);
    return skin(this.parts.volume(body, true), material, this.materials.depthOnly, 40);
  }

  private buildObstacles(): void {
    const X_WL = this.kinematics.makePoses();
    this.kinematics.linkPoses(this.kinematics.restingPosition(), X_WL);
    let ground = 0;
    this.scene.bodies.filter((body) => body.kind === 'obstacle').forEach((body, i) => {
      const geometry = this.parts.volume(body);
      const outline = new LineSegments(new EdgesGeometry(geometry, 35), this.edges);
      const box = geometryBox(geometry);
      let shown: Object3D = outline;
      if (isGround(box)) ground = box.max.z;  // The stage draws it; its outline says how far it goes.
      else shown = solid(geometry, this.materials.furniture(i)).add(outline);
      shown.applyMatrix4(X_WL[body.link]);
      this.obstacles.add(shown);
      if (body.padding <= 0) return;
      for (const surface of this.paddedSkin(body)) {
        surface.applyMatrix4(X_WL[body.link]);
        this.paddedObstacles.add(surface);
      }
    });
    this.stage.setGround(ground);
  }

  private buildFrames(): void {
    const X_WL = this.kinematics.makePoses();
    this.kinematics.linkPoses(this.kinematics.restingPosition(), X_WL);
    this.frames.add(frameMark(0.25));
    this.scene.arms.forEach((_, arm) => {
      const base = frameMark(0.2);
      base.matrix.copy(X_WL[this.kinematics.baseLink(arm)]);
      this.toolFrames[arm] = frameMark(0.12);
      this.frames.add(base, this.toolFrames[arm]);
    });
  }

  private apply(): void {
    const { on, figures } = this;
    figures.visual.visible = on.has('visual');
    figures.volumes.visible = on.has('volumes');
    figures.padding.visible = this.paddedObstacles.visible = on.has('padding');
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

function geometryBox(geometry: { boundingBox: Box3 | null; computeBoundingBox(): void }): Box3 {
  if (!geometry.boundingBox) geometry.computeBoundingBox();
  return geometry.boundingBox!.clone();
}

/** A wide, flat slab near the height of the world's origin is a floor, not furniture. */
function isGround(box: Box3): boolean {
  const size = box.getSize(new Vector3());
  return size.x * size.y > 1.5 && size.z < 0.25 && Math.abs(box.max.z) < 0.05;
}

function corners({ min, max }: Box3): Vector3[] {
  return [min.x, max.x].flatMap((x) => [min.y, max.y].flatMap((y) => [min.z, max.z].map((z) => new Vector3(x, y, z))));
}
