/// What the server and an exported page hand over. SI units; quaternions are w, x, y, z.

export type Vec3 = [number, number, number];

export interface PoseData {
  xyz: Vec3;
  quat_wxyz: [number, number, number, number];
}

/** The value of the joint is multiplier * q[entry] + offset, or the offset where entry is -1. */
export interface JointData {
  name: string;
  type: 'fixed' | 'revolute' | 'continuous' | 'prismatic';
  pose: PoseData;
  axis: Vec3;
  entry: number;
  multiplier: number;
  offset: number;
}

/** A parent comes before its children; the root has no joint. */
export interface LinkData {
  name: string;
  parent?: number;
  joint?: JointData;
}

export type CoreType = 'point' | 'segment' | 'triangle' | 'rectangle' | 'box' | 'cylinder';

/** All points within `radius` of a core; see src/tandem/geometry/shape.h. */
export interface RoundedData {
  core: CoreType;
  origin: Vec3;
  extents: [Vec3, Vec3, Vec3];
  core_radius: number;
  radius: number;
}

/** Vertices are in the frame of origin and extents, faces counter-clockwise seen from outside. */
export interface ConvexData {
  core: 'convex';
  origin: Vec3;
  extents: [Vec3, Vec3, Vec3];
  vertices: Vec3[];
  faces: number[][];
  radius: number;
}

export type ShapeData = RoundedData | ConvexData;

/** A mesh, or without triangles a cloud: every triangle or point swept by `radius`. */
export interface SurfaceData {
  pose: PoseData;
  radius: number;
  /** Base64 of float32, three a vertex. */
  vertices: string;
  /** Base64 of uint32, three a triangle. */
  triangles?: string;
}

export interface BodyData {
  name: string;
  kind: 'robot' | 'obstacle' | 'attached';
  link: number;
  padding: number;
  shapes: ShapeData[];
  surfaces: SurfaceData[];
}

export interface VisualData {
  link: number;
  pose: PoseData;
  box?: Vec3;
  sphere?: number;
  cylinder?: { radius: number; length: number };
  mesh?: { index: number; type: string; scale: Vec3 };
}

export interface ArmData {
  name: string;
  first: number;
  dof: number;
  tip_link: number;
  tool: PoseData;
}

/** Limits; null stands for none. */
export interface LimitData {
  name: string;
  lower: number | null;
  upper: number | null;
  velocity: number | null;
  acceleration: number | null;
  jerk: number | null;
}

export interface SceneData {
  name: string;
  links: LinkData[];
  bodies: BodyData[];
  visuals: VisualData[];
  arms: ArmData[];
  joints: LimitData[];
  queries: string[];
  /** Where the arms stand while nothing else says. */
  home: number[];
}

/** c(t), from real time to the local time of an arm's spline. */
export interface TimeMap {
  knots: number[];
  /** coefficients[segment] = [c0, c1, ...], up to c5 */
  coefficients: number[][];
}

export interface PlanArm {
  name: string;
  joints: string[];
  knots: number[];
  /** coefficients[segment][joint] = [c0, c1, c2, c3] */
  coefficients: number[][][];
  time_map?: TimeMap;
}

export interface Phase {
  name: string;
  path: number[][];
}

export interface PlanData {
  schema_version: number;
  tandem_version: string;
  workcell: string;
  query: string;
  seed: number;
  options: { preset: string; strategy: string; plpp: boolean };
  start: number[];
  goal: number[];
  arms: PlanArm[];
  phases: Phase[];
  report: {
    motion_duration_s: number;
    least_clearance_m: number | null;
    times_ms: Record<string, number>;
    counts: Record<string, number>;
    arms: Record<string, Record<string, number>>;
    rungs: Record<string, number>;
  };
}

export interface ClearanceSample {
  t: number;
  distance: number;
  pair: string;
  a: Vec3;
  b: Vec3;
}

export type End = 'start' | 'goal';

/** Two bodies that touch, with witness points in the world. */
export interface Touching {
  /** Of the motion that was asked for; what a dragged goal touches has none. */
  end?: End;
  pair: string;
  distance: number;
  a: Vec3;
  b: Vec3;
}

export interface ErrorData {
  code: string;
  message: string;
  touching?: Touching[];
}

/** The content of the page's `tandem-data` element. */
export interface PageData {
  scene: SceneData;
  plan: PlanData | null;
  clearance: ClearanceSample[] | null;
  meshes?: Record<string, string>;
}
