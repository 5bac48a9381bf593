/// Forward kinematics of the cell.

import { Matrix4, Quaternion, Vector3 } from 'three';
import type { ArmData, LimitData, LinkData, PoseData, SceneData, Vec3 } from './types';

export function poseMatrix(pose: PoseData): Matrix4 {
  const [w, x, y, z] = pose.quat_wxyz;
  return new Matrix4().compose(
    new Vector3(...pose.xyz),
    new Quaternion(x, y, z, w).normalize(),
    new Vector3(1, 1, 1),
  );
}

export function matrixPose(X: Matrix4): PoseData {
  const p = new Vector3();
  const u = new Quaternion();
  X.decompose(p, u, new Vector3());
  return { xyz: p.toArray() as Vec3, quat_wxyz: [u.w, u.x, u.y, u.z] };
}

interface Node {
  link: LinkData;
  X_PJ: Matrix4;
  axis: Vector3;
  /** The arm whose joints move this link, or -1. */
  arm: number;
}

export class Kinematics {
  readonly dof: number;
  private readonly nodes: Node[];
  private readonly X_LE: Matrix4[];
  private readonly X_JL = new Matrix4();

  constructor(readonly scene: SceneData) {
    this.dof = scene.joints.length;
    this.X_LE = scene.arms.map((arm) => poseMatrix(arm.tool));
    this.nodes = [];
    for (const link of scene.links) {
      const { joint, parent } = link;
      const inherited = parent === undefined ? -1 : this.nodes[parent].arm;
      this.nodes.push({
        link,
        X_PJ: joint ? poseMatrix(joint.pose) : new Matrix4(),
        axis: joint ? new Vector3(...joint.axis) : new Vector3(1, 0, 0),
        arm: joint && joint.entry >= 0 ? armOfEntry(scene.arms, joint.entry) : inherited,
      });
    }
  }

  get linkCount(): number {
    return this.nodes.length;
  }

  /** The arm that moves a link, or -1. */
  armOfLink(link: number): number {
    return this.nodes[link].arm;
  }

  /** How many moving joints of its own arm carry a link. */
  depthOfLink(link: number): number {
    let depth = 0;
    for (let i: number | undefined = link; i !== undefined; i = this.nodes[i].link.parent) {
      if ((this.nodes[i].link.joint?.entry ?? -1) >= 0) ++depth;
    }
    return depth;
  }

  /** The link that carries the first joint of an arm. */
  baseLink(arm: number): number {
    const first = this.scene.arms[arm].first;
    return this.nodes.find((node) => node.link.joint?.entry === first)?.link.parent ?? 0;
  }

  /** Poses X_WL of all links at q; `out` holds one matrix per link. */
  linkPoses(q: ArrayLike<number>, out: Matrix4[]): void {
    for (let i = 0; i < this.nodes.length; ++i) {
      const { link, X_PJ, axis } = this.nodes[i];
      out[i].copy(X_PJ);
      const joint = link.joint;
      if (!joint) continue;
      out[i].premultiply(out[link.parent ?? 0]);
      if (joint.type === 'fixed') continue;
      const value = (joint.entry >= 0 ? joint.multiplier * q[joint.entry] : 0) + joint.offset;
      if (joint.type === 'prismatic') {
        this.X_JL.makeTranslation(axis.x * value, axis.y * value, axis.z * value);
      } else {
        this.X_JL.makeRotationAxis(axis, value);
      }
      out[i].multiply(this.X_JL);
    }
  }

  makePoses(): Matrix4[] {
    return this.nodes.map(() => new Matrix4());
  }

  /** Pose X_WE of the tool of an arm, from link poses. */
  toolPose(arm: number, X_WL: Matrix4[], out: Matrix4): Matrix4 {
    return out.multiplyMatrices(X_WL[this.scene.arms[arm].tip_link], this.X_LE[arm]);
  }
}

function armOfEntry(arms: ArmData[], entry: number): number {
  return arms.findIndex((arm) => entry >= arm.first && entry < arm.first + arm.dof);
}

/** "left/panda_joint4 is at 0.100, its limits are -3.072 to -0.070" for every joint outside. */
export function outsideLimits(joints: LimitData[], q: ArrayLike<number>): string[] {
  const text = (value: number | null): string => (value === null ? 'none' : value.toFixed(3));
  return joints.flatMap((joint, i) =>
    q[i] < (joint.lower ?? -Infinity) || q[i] > (joint.upper ?? Infinity)
      ? [`${joint.name} is at ${text(q[i])}, its limits are ${text(joint.lower)} to ${text(joint.upper)}`]
      : [],
  );
}
