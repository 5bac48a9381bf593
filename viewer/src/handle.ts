/// A handle in the scene that moves the goal of one tool.

import { Matrix4, Object3D, Vector3 } from 'three';
import { TransformControls } from 'three/examples/jsm/controls/TransformControls.js';
import { matrixPose, poseMatrix } from './model';
import { colors } from './palette';
import type { Stage } from './stage';
import type { PoseData } from './types';

export class GoalHandle {
  private readonly controls: TransformControls;
  private readonly target = new Object3D();

  constructor(private readonly stage: Stage, moved: (pose: PoseData) => void, changed: () => void) {
    this.controls = new TransformControls(stage.camera, stage.canvas);
    this.controls.setSpace('world');
    this.controls.setColors(...colors.axes, '#888888');
    stage.scene.add(this.target, this.controls.getHelper());
    this.controls.addEventListener('dragging-changed', ({ value }) => {
      stage.orbit.enabled = !value;
    });
    this.controls.addEventListener('objectChange', () => moved(this.pose));
    this.controls.addEventListener('change', changed);
    this.hide();
  }

  get pose(): PoseData {
    this.target.updateMatrix();
    return matrixPose(this.target.matrix);
  }

  /** Where on the page its centre is drawn [px], if it is. */
  get onPage(): [number, number] | null {
    if (!this.controls.enabled) return null;
    const { stage } = this;
    const p = new Vector3().setFromMatrixPosition(this.target.matrixWorld).project(stage.camera);
    const { left, top, width, height } = stage.canvas.getBoundingClientRect();
    return [left + ((1 + p.x) / 2) * width, top + ((1 - p.y) / 2) * height];
  }

  get dragging(): boolean {
    return this.controls.dragging;
  }

  show(pose: PoseData): void {
    this.place(pose);
    // It grows with the canvas by itself; fingers do not.
    this.controls.size = Math.min(Math.max(440 / this.stage.canvas.clientHeight, 0.6), 2);
    this.controls.attach(this.target);
    this.controls.enabled = true;
  }

  place(pose: PoseData): void {
    const X: Matrix4 = poseMatrix(pose);
    X.decompose(this.target.position, this.target.quaternion, this.target.scale);
    this.target.updateMatrixWorld();
  }

  hide(): void {
    this.controls.detach();
    this.controls.enabled = false;
  }

  setMode(mode: 'translate' | 'rotate'): void {
    this.controls.setMode(mode);
    this.controls.setSpace(mode === 'rotate' ? 'local' : 'world');
  }
}
