import { Matrix4, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { Kinematics, matrixPose, outsideLimits, poseMatrix } from '../src/model';
import type { JointData, LinkData, PoseData, SceneData, Vec3 } from '../src/types';
// Link poses as tandem's own forward kinematics gives them, for two random configurations.
import pandas from './two_pandas.json';

const here: PoseData = { xyz: [0, 0, 0], quat_wxyz: [1, 0, 0, 0] };
const scene = pandas.scene as unknown as SceneData;

function difference(X: Matrix4, pose: PoseData): number {
  const expected = poseMatrix(pose).elements;
  return Math.max(...X.elements.map((value, i) => Math.abs(value - expected[i])));
}

describe('two Pandas', () => {
  const kinematics = new Kinematics(scene);

  it('has the link poses of the C++ model', () => {
    const X_WL = kinematics.makePoses();
    for (const { q, X_WL: expected } of pandas.cases) {
      kinematics.linkPoses(q, X_WL);
      expect(expected.length).toBe(X_WL.length);
      X_WL.forEach((X, i) => expect(difference(X, expected[i] as PoseData)).toBeLessThan(1e-7));
    }
  });

  it('knows which arm moves a link', () => {
    const link = (name: string) => scene.links.findIndex((entry) => entry.name === name);
    expect(kinematics.armOfLink(link('left/panda_link0'))).toBe(-1);
    expect(kinematics.armOfLink(link('left/panda_link1'))).toBe(0);
    expect(kinematics.armOfLink(link('right/panda_leftfinger'))).toBe(1);
    expect(kinematics.depthOfLink(link('right/panda_hand'))).toBe(7);
    expect(kinematics.baseLink(1)).toBe(link('right/panda_link0'));
  });

  it('carries the tool with its tip', () => {
    const X_WL = kinematics.makePoses();
    kinematics.linkPoses(pandas.cases[0].q, X_WL);
    const X_WE = kinematics.toolPose(0, X_WL, new Matrix4());
    const X_LE = X_WL[scene.arms[0].tip_link].clone().invert().multiply(X_WE);
    expect(difference(X_LE, scene.arms[0].tool)).toBeLessThan(1e-12);
  });
});

/** World, a turning link about z, a sliding link along x, a link that mimics the first joint. */
function handmade(): SceneData {
  const joint = (type: JointData['type'], axis: Vec3, xyz: Vec3, drive: Partial<JointData>): JointData => ({
    name: type,
    type,
    axis,
    pose: { xyz, quat_wxyz: [1, 0, 0, 0] },
    entry: -1,
    multiplier: 1,
    offset: 0,
    ...drive,
  });
  const links: LinkData[] = [
    { name: 'world' },
    { name: 'a', parent: 0, joint: joint('revolute', [0, 0, 1], [1, 0, 0], { entry: 0 }) },
    { name: 'b', parent: 1, joint: joint('prismatic', [1, 0, 0], [0, 0, 2], { entry: 1 }) },
    { name: 'c', parent: 2, joint: joint('continuous', [0, 0, 1], [0, 0, 0], { entry: 0, multiplier: -2, offset: 0.5 }) },
    { name: 'd', parent: 2, joint: joint('prismatic', [0, 1, 0], [0, 0, 0], { offset: 0.04 }) },
  ];
  const none = { velocity: null, acceleration: null, jerk: null };
  return {
    name: 'handmade',
    links,
    bodies: [],
    visuals: [],
    arms: [{ name: 'arm', first: 0, dof: 2, tip_link: 2, tool: here }],
    joints: [
      { name: 'turn', lower: null, upper: null, ...none },
      { name: 'slide', lower: 0.1, upper: 0.3, ...none },
    ],
    queries: [],
    home: [0, 0.2],
  };
}

describe('a hand-made chain', () => {
  it('turns, slides, mimics and stands', () => {
    const kinematics = new Kinematics(handmade());
    const X_WL = kinematics.makePoses();
    const angle = Math.PI / 2;
    kinematics.linkPoses([angle, 0.25], X_WL);
    const at = (i: number) => new Vector3().setFromMatrixPosition(X_WL[i]).toArray();
    const near = (p: number[], expected: number[]) => p.forEach((v, i) => expect(v).toBeCloseTo(expected[i], 12));
    near(at(1), [1, 0, 0]);
    near(at(2), [1, 0.25, 2]);
    near(at(4), [1 - 0.04, 0.25, 2]);
    // About z by angle, then by -2 angle + 0.5.
    const x = new Vector3().setFromMatrixColumn(X_WL[3], 0).toArray();
    near(x, [Math.cos(0.5 - angle), Math.sin(0.5 - angle), 0]);
  });

  it('names joints outside of their limits', () => {
    const { joints } = handmade();
    expect(outsideLimits(joints, [100, 0.2])).toEqual([]);
    expect(outsideLimits(joints, [0, 0.4])).toEqual(['slide is at 0.400, its limits are 0.100 to 0.300']);
  });
});

it('poses survive the way to a matrix and back', () => {
  const pose: PoseData = { xyz: [0.1, -2, 3], quat_wxyz: [0.5, 0.5, -0.5, 0.5] };
  const back = matrixPose(poseMatrix(pose));
  back.xyz.forEach((v, i) => expect(v).toBeCloseTo(pose.xyz[i], 12));
  back.quat_wxyz.forEach((v, i) => expect(v).toBeCloseTo(pose.quat_wxyz[i], 12));
});
