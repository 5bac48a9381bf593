/// The motion of a plan: q(t) and its derivatives.

import type { ArmData, ClearanceSample, PlanArm, PlanData, TimeMap } from './types';

/** Order of a derivative: position, velocity, acceleration, jerk. */
export type Order = 0 | 1 | 2 | 3;

/** On segment k, with s = t - knot_k: q = c0 + c1 s + c2 s^2 + c3 s^3 per joint; or q(c(t)), if c(t) is given. */
export class ArmMotion {
  readonly duration: number;
  /** Real times between which every joint is one polynomial, both ends included. */
  readonly breaks: number[];
  private readonly knots: number[];
  private readonly coefficients: number[][][];
  private readonly map?: TimeMap;

  constructor(arm: PlanArm) {
    this.knots = arm.knots;
    this.coefficients = arm.coefficients;
    this.map = arm.time_map;
    const times = this.map?.knots ?? this.knots;
    this.duration = times[times.length - 1];
    this.breaks = this.map ? [...times, ...crossings(this.map, this.knots)].sort((a, b) => a - b) : times;
  }

  segmentAt(t: number): number {
    return segmentAt(this.knots, t);
  }

  /** Writes the derivative of all joints into out[first...]. Past its end the arm stands still. */
  evaluate(t: number, order: Order, out: Float64Array | number[], first: number): void {
    const real = Math.min(Math.max(t, 0), this.duration);
    const c = this.map ? derivatives(this.map.coefficients, this.map.knots, real) : [real, 1, 0, 0];
    const end = this.knots[this.knots.length - 1];
    const still = order > 0 && (t > this.duration || c[0] < 0 || c[0] > end);
    const k = this.segmentAt(c[0]);
    const s = Math.min(Math.max(c[0], 0), end) - this.knots[k];
    this.coefficients[k].forEach((q, j) => {
      out[first + j] = still ? 0 : composed(taylor(q, s), c, order);
    });
  }
}

function segmentAt(knots: number[], t: number): number {
  let low = 0;
  let high = knots.length - 2;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (knots[middle] <= t) low = middle;
    else high = middle - 1;
  }
  return low;
}

/** A polynomial and its first three derivatives. */
function taylor(coefficients: number[], s: number): number[] {
  const t = [0, 0, 0, 0];
  for (let i = coefficients.length - 1; i >= 0; --i) {
    for (let n = 3; n > 0; --n) t[n] = t[n] * s + t[n - 1];
    t[0] = t[0] * s + coefficients[i];
  }
  return [t[0], t[1], 2 * t[2], 6 * t[3]];
}

function derivatives(segments: number[][], knots: number[], t: number): number[] {
  const k = segmentAt(knots, t);
  return taylor(segments[k], t - knots[k]);
}

/** Derivative of q(c(t)) from those of q and c, by the chain rule. */
function composed(q: number[], c: number[], order: Order): number {
  switch (order) {
    case 0:
      return q[0];
    case 1:
      return q[1] * c[1];
    case 2:
      return q[2] * c[1] ** 2 + q[1] * c[2];
    case 3:
      return q[3] * c[1] ** 3 + 3 * q[2] * c[1] * c[2] + q[1] * c[3];
  }
}

/** Where c(t) passes knots, found between steps of its segments. */
function crossings(map: TimeMap, knots: number[]): number[] {
  const steps = 16;
  const found: number[] = [];
  map.coefficients.forEach((segment, k) => {
    const begin = map.knots[k];
    const h = map.knots[k + 1] - begin;
    const value = (s: number) => taylor(segment, s)[0];
    for (let i = 0; i < steps; ++i) {
      const low = (h * i) / steps;
      const high = (h * (i + 1)) / steps;
      for (const knot of knots) {
        const rises = value(low) < knot;
        if (rises === value(high) < knot) continue;
        let [from, to] = [low, high];
        for (let n = 0; n < 50; ++n) {
          const middle = (from + to) / 2;
          if (value(middle) < knot === rises) from = middle;
          else to = middle;
        }
        found.push(begin + to);
      }
    }
  });
  return found;
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
      for (const knot of arm.breaks) {
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
