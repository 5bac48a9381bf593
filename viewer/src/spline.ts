/// The motion of a plan: q(t) and its derivatives.

import type { ArmData, ClearanceSample, PlanArm, PlanData } from './types';

/** Order of a derivative: position, velocity, acceleration, jerk. */
export type Order = 0 | 1 | 2 | 3;

/** On segment k, with s = t - knot_k: q = c0 + c1 s + c2 s^2 + c3 s^3 per joint. */
export class ArmMotion {
  readonly knots: number[];
  private readonly coefficients: number[][][];

  constructor(arm: PlanArm) {
    this.knots = arm.knots;
    this.coefficients = arm.coefficients;
  }

  get duration(): number {
    return this.knots[this.knots.length - 1];
  }

  segmentAt(t: number): number {
    let low = 0;
    let high = this.knots.length - 2;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.knots[middle] <= t) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** Writes the derivative of all joints into out[first...]. Past its end the arm stands still. */
  evaluate(t: number, order: Order, out: Float64Array | number[], first: number): void {
    const end = this.duration;
    const k = this.segmentAt(t);
    const s = Math.min(Math.max(t, 0), end) - this.knots[k];
    const still = order > 0 && t > end;
    this.coefficients[k].forEach((c, j) => {
      out[first + j] = still ? 0 : derivative(c, s, order);
    });
  }
}

function derivative([c0, c1, c2, c3]: number[], s: number, order: Order): number {
  switch (order) {
    case 0:
      return c0 + s * (c1 + s * (c2 + s * c3));
    case 1:
      return c1 + s * (2 * c2 + s * 3 * c3);
    case 2:
      return 2 * c2 + 6 * c3 * s;
    case 3:
      return 6 * c3;
  }
}

/** All arms side by side, in the order of the cell's q. */
export class CellMotion {
  readonly arms: ArmMotion[];
  readonly duration: number;

  constructor(
    plan: PlanData,
    private readonly cellArms: ArmData[],
  ) {
    this.arms = cellArms.map((arm) => {
      const planned = plan.arms.find((entry) => entry.name === arm.name);
      if (!planned || planned.joints.length !== arm.dof) {
        throw new Error(`the plan does not fit the cell: it has no arm "${arm.name}" of ${arm.dof} joints`);
      }
      return new ArmMotion(planned);
    });
    this.duration = Math.max(...this.arms.map((arm) => arm.duration));
  }

  evaluate<Values extends Float64Array | number[]>(t: number, order: Order, out: Values): Values {
    this.arms.forEach((arm, i) => arm.evaluate(t, order, out, this.cellArms[i].first));
    return out;
  }

  /** Times for plotting: `count` even steps, and both sides of every knot, where jerk jumps. */
  sampleTimes(count: number): number[] {
    const before = 1e-9 * Math.max(this.duration, 1);
    const times = new Set<number>();
    for (let i = 0; i <= count; ++i) times.add((this.duration * i) / count);
    for (const arm of this.arms) {
      for (const knot of arm.knots) {
        times.add(knot);
        if (knot > before) times.add(knot - before);
        if (knot < this.duration) times.add(knot + before);
      }
    }
    return [...times].sort((a, b) => a - b);
  }
}

/** Configurations along straight edges in joint space, at most `step` apart (largest joint). */
export function interpolatePath(path: number[][], step: number): number[][] {
  const dense = path.slice(0, 1);
  for (let i = 1; i < path.length; ++i) {
    const [a, b] = [path[i - 1], path[i]];
    const length = Math.max(...a.map((value, j) => Math.abs(b[j] - value)));
    const parts = Math.max(1, Math.ceil(length / step));
    for (let k = 1; k <= parts; ++k) {
      dense.push(a.map((value, j) => value + ((b[j] - value) * k) / parts));
    }
  }
  return dense;
}

/** Least clearance at time t: between samples of the same pair linearly, else the nearer sample. */
export function clearanceAt(samples: ClearanceSample[], t: number): ClearanceSample | null {
  if (samples.length === 0) return null;
  let i = samples.findIndex((sample) => sample.t >= t);
  if (i < 0) i = samples.length - 1;
  const next = samples[i];
  const last = samples[Math.max(i - 1, 0)];
  const span = next.t - last.t;
  if (span <= 0 || t >= next.t) return next;
  const w = Math.min(Math.max((t - last.t) / span, 0), 1);
  if (last.pair !== next.pair) return w < 0.5 ? last : next;
  const mix = (a: number, b: number): number => a + w * (b - a);
  const point = (a: number[], b: number[]) =>
    [mix(a[0], b[0]), mix(a[1], b[1]), mix(a[2], b[2])] as [number, number, number];
  return {
    t,
    distance: mix(last.distance, next.distance),
    pair: last.pair,
    a: point(last.a, next.a),
    b: point(last.b, next.b),
  };
}
