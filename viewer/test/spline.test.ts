import { describe, expect, it } from 'vitest';
import { ArmMotion, CellMotion, clearanceAt, interpolatePath, type Order } from '../src/spline';
import type { ArmData, ClearanceSample, PlanData } from '../src/types';

const here = { xyz: [0, 0, 0], quat_wxyz: [1, 0, 0, 0] } as ArmData['tool'];

// q = 1 + 2 t - t^3 to t = 2, then from there on with other coefficients; and a resting joint.
const left = {
  name: 'left',
  joints: ['a', 'b'],
  knots: [0, 2, 5],
  coefficients: [
    [[1, 2, 0, -1], [0.5, 0, 0, 0]],
    [[-3, -10, -6, 0.25], [0.5, 0, 0, 0]],
  ],
};
const right = { name: 'right', joints: ['c'], knots: [0, 1], coefficients: [[[4, 1, 0, 0]]] };
const arms: ArmData[] = [
  { name: 'left', first: 0, dof: 2, tip_link: 0, tool: here },
  { name: 'right', first: 2, dof: 1, tip_link: 0, tool: here },
];
const plan = { arms: [left, right] } as unknown as PlanData;

describe('one arm', () => {
  const arm = new ArmMotion(left);
  const value = (t: number, order: Order) => {
    const out = [0, 0];
    arm.evaluate(t, order, out, 0);
    return out[0];
  };

  it('finds the segment that holds a time', () => {
    expect([-1, 0, 1.99, 2, 4, 5, 9].map((t) => arm.segmentAt(t))).toEqual([0, 0, 0, 1, 1, 1, 1]);
  });

  it('evaluates the cubic and its derivatives', () => {
    expect(value(1.5, 0)).toBeCloseTo(1 + 3 - 3.375, 12);
    expect(value(1.5, 1)).toBeCloseTo(2 - 3 * 2.25, 12);
    expect(value(1.5, 2)).toBeCloseTo(-9, 12);
    expect(value(1.5, 3)).toBeCloseTo(-6, 12);
    expect(value(4, 0)).toBeCloseTo(-3 - 20 - 24 + 2, 12);
    expect(value(4, 3)).toBeCloseTo(1.5, 12);
  });

  it('has derivatives that agree with differences', () => {
    const h = 1e-5;
    for (const t of [0.3, 1.2, 2.5, 4.9]) {
      for (const order of [0, 1, 2] as const) {
        const slope = (value(t + h, order) - value(t - h, order)) / (2 * h);
        expect(slope).toBeCloseTo(value(t, (order + 1) as Order), 5);
      }
    }
  });
});

describe('one arm along c(t)', () => {
  // c = t^2 to t = 1, then 1 + 2 s - 0.5 s^2 + 0.01 s^5 to t = 2.5.
  const time_map = { knots: [0, 1, 2.5], coefficients: [[0, 0, 1], [1, 2, -0.5, 0, 0, 0.01]] };
  const arm = new ArmMotion({ ...left, time_map });
  const plain = new ArmMotion(left);
  const value = (motion: ArmMotion, t: number, order: Order) => {
    const out = [0, 0];
    motion.evaluate(t, order, out, 0);
    return out[0];
  };

  it('is the spline at the mapped time', () => {
    expect(arm.duration).toBe(2.5);
    for (const t of [0.2, 0.9, 1.3, 2.4]) {
      const c = t < 1 ? t ** 2 : 1 + 2 * (t - 1) - 0.5 * (t - 1) ** 2 + 0.01 * (t - 1) ** 5;
      expect(value(arm, t, 0)).toBeCloseTo(value(plain, c, 0), 12);
    }
  });

  it('has derivatives that agree with differences', () => {
    const h = 1e-5;
    for (const t of [0.3, 0.8, 1.2, 1.9, 2.4]) {
      for (const order of [0, 1, 2] as const) {
        const slope = (value(arm, t + h, order) - value(arm, t - h, order)) / (2 * h);
        expect(slope).toBeCloseTo(value(arm, t, (order + 1) as Order), 4);
      }
    }
  });

  it('breaks at the knots of c and where c passes knots of the spline', () => {
    const passes = arm.breaks.filter((t) => ![0, 1, 2.5].includes(t));
    expect(passes.length).toBe(1);
    const s = passes[0] - 1;
    expect(1 + 2 * s - 0.5 * s ** 2 + 0.01 * s ** 5).toBeCloseTo(2, 12);
  });

  it('waits where c leaves the time of the spline', () => {
    const beyond = new ArmMotion({ ...left, time_map: { knots: [0, 2], coefficients: [[5, 2, -1]] } });
    expect(value(beyond, 1, 0)).toBeCloseTo(value(plain, 5, 0), 12);
    expect(value(beyond, 1, 1)).toBe(0);
    expect(value(beyond, 1, 3)).toBe(0);
  });
});

describe('a cell', () => {
  const motion = new CellMotion(plan, arms);

  it('lets the shorter arm wait at its end', () => {
    expect(motion.duration).toBe(5);
    expect(motion.evaluate(1, 0, [0, 0, 0])[2]).toBe(5);
    expect(motion.evaluate(3, 0, [0, 0, 0])[2]).toBe(5);
    expect(motion.evaluate(1, 1, [0, 0, 0])[2]).toBe(1);
    expect(motion.evaluate(3, 1, [0, 0, 0])[2]).toBe(0);
  });

  it('stands at its ends outside its time', () => {
    expect(motion.evaluate(-1, 0, [0, 0, 0])).toEqual(motion.evaluate(0, 0, [0, 0, 0]));
    expect(motion.evaluate(9, 0, [0, 0, 0])).toEqual(motion.evaluate(5, 0, [0, 0, 0]));
  });

  it('samples both sides of every knot, in order', () => {
    const times = motion.sampleTimes(10);
    expect(times[0]).toBe(0);
    expect(times[times.length - 1]).toBe(5);
    times.slice(1).forEach((t, i) => expect(t).toBeGreaterThan(times[i]));
    const jerks = times.filter((t) => Math.abs(t - 2) < 1e-6).map((t) => motion.evaluate(t, 3, [0, 0, 0])[0]);
    expect(jerks).toEqual([-6, 1.5, 1.5]);
  });

  it('refuses a plan of other arms', () => {
    const other = { arms: [{ ...left, name: 'middle' }, right] } as unknown as PlanData;
    expect(() => new CellMotion(other, arms)).toThrow(/no arm "left" of 2 joints/);
  });
});

it('interpolates paths with bounded steps', () => {
  const dense = interpolatePath([[0, 0], [1, -0.5], [1, -0.5]], 0.3);
  expect(dense).toEqual([[0, 0], [0.25, -0.125], [0.5, -0.25], [0.75, -0.375], [1, -0.5], [1, -0.5]]);
  expect(interpolatePath([], 0.1)).toEqual([]);
});

describe('clearance', () => {
  const sample = (t: number, distance: number, pair: string): ClearanceSample => ({
    t, distance, pair, a: [t, 0, 0], b: [t, distance, 0],
  });
  const samples = [sample(0, 0.1, 'x'), sample(1, 0.3, 'x'), sample(2, 0.2, 'y')];

  it('is interpolated within a pair only', () => {
    expect(clearanceAt(samples, 0.25)).toMatchObject({ distance: expect.closeTo(0.15, 12), pair: 'x', a: [0.25, 0, 0] });
    expect(clearanceAt(samples, 1.4)).toBe(samples[1]);
    expect(clearanceAt(samples, 1.6)).toBe(samples[2]);
  });

  it('is that of the ends outside the samples', () => {
    expect(clearanceAt(samples, -1)?.distance).toBeCloseTo(0.1, 12);
    expect(clearanceAt(samples, 9)).toBe(samples[2]);
    expect(clearanceAt([], 0)).toBeNull();
  });
});
