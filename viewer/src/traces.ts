/// Where the tools go: the executed motion, and the paths of the planning phases.

import { Color, Group, InstancedMesh, Matrix4, MeshBasicMaterial, SphereGeometry, Vector3 } from 'three';
import { Line2 } from 'three/examples/jsm/lines/Line2.js';
import { LineGeometry } from 'three/examples/jsm/lines/LineGeometry.js';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';
import type { Kinematics } from './model';
import { armColor, mix, type Theme } from './palette';
import { interpolatePath, type CellMotion } from './spline';
import type { Phase } from './types';

const kSamples = 240;
const kDashes = [[0.012, 0.01], [0.03, 0.012], [0.05, 0.02], [0.004, 0.01]];

interface Stroke {
  line: Line2;
  arm: number;
  /** Share of the ground's colour mixed in. */
  pale: number;
}

export class Traces extends Group {
  private readonly groups = new Map<string, Group>();
  private strokes: Stroke[] = [];
  private dots: { mesh: InstancedMesh; arm: number }[] = [];
  private past: Line2[] = [];
  private duration = 0;

  constructor(
    private readonly kinematics: Kinematics,
    private theme: Theme,
  ) {
    super();
  }

  /** Points that all traces pass, for framing. */
  readonly points: Vector3[] = [];

  set(motion: CellMotion | null, phases: Phase[], visible: (name: string) => boolean): void {
    this.clearAll();
    if (!motion) return;
    this.duration = motion.duration;
    const q = new Array<number>(this.kinematics.dof).fill(0);
    const executed = Array.from({ length: kSamples + 1 }, (_, i) => {
      return [...motion.evaluate((i * motion.duration) / kSamples, 0, q)];
    });
    this.addGroup('motion', visible('motion'), (arm, group) => {
      const positions = this.toolPositions(arm, executed);
      this.points.push(...positions.filter((_, i) => i % 8 === 0));
      this.stroke(group, arm, positions, { linewidth: 2.5, pale: 0.45, opacity: 1 });
      const bold = this.stroke(group, arm, positions, { linewidth: 4.5, pale: 0, opacity: 1 });
      bold.material.polygonOffset = true;  // It lies on the pale line.
      bold.material.polygonOffsetFactor = bold.material.polygonOffsetUnits = -8;
      this.past.push(bold);
    });
    phases.forEach(({ name, path }, k) => {
      this.addGroup(name, visible(name), (arm, group) => {
        const positions = this.toolPositions(arm, interpolatePath(path, 0.03));
        const dash = kDashes[k % kDashes.length];
        this.stroke(group, arm, positions, { linewidth: 2.2, pale: 0.25, opacity: 1, dash });
        this.waypoints(group, arm, this.toolPositions(arm, path));
      });
    });
    this.setTheme(this.theme);
  }

  /** The part of the motion that lies behind is drawn bold. */
  setTime(t: number): void {
    const done = this.duration > 0 ? Math.round((t / this.duration) * kSamples) : 0;
    for (const line of this.past) line.geometry.instanceCount = done;
  }

  show(name: string, on: boolean): void {
    const group = this.groups.get(name);
    if (group) group.visible = on;
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    const ground = theme === 'light' ? '#eef1f5' : '#1a1f26';
    for (const { line, arm, pale } of this.strokes) line.material.color.set(mix(armColor(arm, theme), ground, pale));
    for (const { mesh, arm } of this.dots) {
      (mesh.material as MeshBasicMaterial).color = new Color(mix(armColor(arm, theme), ground, 0.25));
    }
  }

  private addGroup(name: string, visible: boolean, fill: (arm: number, group: Group) => void): void {
    const group = new Group();
    group.visible = visible;
    this.kinematics.scene.arms.forEach((_, arm) => fill(arm, group));
    this.groups.set(name, group);
    this.add(group);
  }

  private stroke(
    group: Group,
    arm: number,
    positions: Vector3[],
    style: { linewidth: number; pale: number; opacity: number; dash?: number[] },
  ): Line2 {
    const { linewidth, opacity, dash } = style;
    const material = new LineMaterial({ linewidth, opacity, transparent: opacity < 1, toneMapped: false });
    if (dash) {
      material.dashed = true;
      [material.dashSize, material.gapSize] = dash;
    }
    const line = new Line2(new LineGeometry().setPositions(positions.flatMap((p) => p.toArray())), material);
    if (dash) line.computeLineDistances();
    line.frustumCulled = false;
    group.add(line);
    this.strokes.push({ line, arm, pale: style.pale });
    return line;
  }

  private waypoints(group: Group, arm: number, positions: Vector3[]): void {
    const mesh = new InstancedMesh(new SphereGeometry(0.007, 12, 8), new MeshBasicMaterial({ toneMapped: false }), positions.length);
    positions.forEach((p, i) => mesh.setMatrixAt(i, new Matrix4().setPosition(p)));
    group.add(mesh);
    this.dots.push({ mesh, arm });
  }

  private toolPositions(arm: number, path: number[][]): Vector3[] {
    const X_WL = this.kinematics.makePoses();
    const X_WE = new Matrix4();
    return path.map((q) => {
      this.kinematics.linkPoses(q, X_WL);
      return new Vector3().setFromMatrixPosition(this.kinematics.toolPose(arm, X_WL, X_WE));
    });
  }

  private clearAll(): void {
    for (const { line } of this.strokes) {
      line.geometry.dispose();
      line.material.dispose();
    }
    for (const { mesh } of this.dots) mesh.dispose();
    this.strokes = [];
    this.dots = [];
    this.past = [];
    this.points.length = 0;
    this.groups.clear();
    this.clear();
  }
}
