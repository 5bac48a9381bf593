/// Planning from the page: choose a query or drag goals, plan, see what came of it.

import { Matrix4 } from 'three';
import { Refusal, type PlanAnswer, type QueryAnswer, type Server } from './api';
import { button, checkbox, el, section, select } from './dom';
import { GoalHandle } from './handle';
import { formatLength } from './markers';
import { matrixPose, outsideLimits } from './model';
import type { CellView } from './scene';
import type { PoseData, Touching } from './types';

const kListed = 6;  // Pairs that are named.

export interface LiveHooks {
  /** What is shown now, to start from. */
  configuration(): number[];
  planned(answer: PlanAnswer): void;
  /** Shows a ghost, whatever its switch says. */
  reveal(end: 'start' | 'goal'): void;
  /** A new start and goal, before there is a plan between them. */
  ends(query: QueryAnswer): void;
}

export class LivePanel {
  readonly element: HTMLElement;
  private readonly handle: GoalHandle;
  private readonly planButton: HTMLButtonElement;
  private readonly result = el('div', { class: 'result', role: 'alert' });
  private readonly armButtons: HTMLButtonElement[];
  private readonly queries: HTMLSelectElement;
  private readonly seed = el('input', { type: 'number', min: 0, step: 1, value: 1 });
  private readonly deadline = el('input', { type: 'number', min: 0.1, max: 60, step: 0.1, value: 5 });
  private readonly preset = select('Preset', [['default', 'default'], ['paper', 'paper']], 'default', () => {});
  private readonly strategy = select('Strategy', [['centralized', 'all arms together'], ['decoupled', 'each arm alone'], ['auto', 'auto']], 'centralized', () => {});
  private readonly fromHere: HTMLLabelElement;
  private query: string | null;
  private start: number[] | null = null;
  private goal: number[] | null = null;
  private arm = -1;
  private wanted: PoseData | null = null;
  private solving = false;
  private planning: AbortController | null = null;

  constructor(private readonly server: Server, private readonly view: CellView, private readonly hooks: LiveHooks) {
    const { scene } = view;
    this.query = scene.queries[0] ?? null;
    this.handle = new GoalHandle(view.stage, (pose) => this.drag(pose), () => view.changed());
    const custom: [string, string] = ['', 'goal of your own'];
    this.queries = select('Query', [...scene.queries.map((name): [string, string] => [name, name]), custom], this.query ?? '', (name) => {
      if (name) void this.choose(name);
    });
    this.armButtons = scene.arms.map(({ name }, arm) => {
      const press = button(`Drag the goal of ${name}`, name, () => this.grab(this.arm === arm ? -1 : arm));
      press.setAttribute('aria-pressed', 'false');
      return press;
    });
    const mode = select('Handle', [['translate', 'move'], ['rotate', 'turn']], 'translate', (value) => this.handle.setMode(value));
    this.fromHere = checkbox('Start from what is shown', false, () => {});
    this.planButton = button('Plan', 'Plan', () => (this.planning ? this.planning.abort() : void this.plan()));
    this.planButton.classList.add('primary', 'wide');
    const field = (label: string, input: HTMLElement) => el('label', { class: 'field' }, el('span', {}, label), input);
    this.element = section(
      'Plan a motion',
      true,
      field('Query', this.queries),
      el('div', { class: 'field' }, el('span', {}, 'Drag goal'), el('div', { class: 'row' }, ...this.armButtons, mode)),
      this.fromHere,
      el('details', { class: 'more' }, el('summary', {}, 'Options'),
        field('Preset', this.preset), field('Strategy', this.strategy), field('Seed', this.seed), field('Deadline [s]', this.deadline)),
      this.planButton,
      this.result,
    );
  }

  /** Where on the page the handle is drawn [px]; null while no goal is being dragged. */
  get handleOnPage(): [number, number] | null {
    return this.handle.onPage;
  }

  /** Takes over the ends of a plan that is shown. */
  follow(query: string, start: number[], goal: number[]): void {
    const known = this.view.scene.queries.includes(query);
    this.query = known ? query : null;
    this.queries.value = known ? query : '';
    this.start = start;
    this.goal = goal;
    this.placeHandle();
  }

  async choose(name: string): Promise<void> {
    this.grab(-1);
    this.clear();
    this.query = name;
    this.queries.value = name;
    try {
      const answer = await this.server.query(name);
      if (this.query !== name) return;
      this.start = answer.start;
      this.goal = answer.goal;
      this.hooks.ends(answer);
      this.placeHandle();
    } catch (error) {
      this.fail(error);
    }
  }

  // ---- goals

  private grab(arm: number): void {
    this.arm = arm;
    this.armButtons.forEach((press, i) => press.setAttribute('aria-pressed', String(i === arm)));
    if (arm < 0) {
      this.handle.hide();
      return;
    }
    this.goal ??= this.hooks.configuration();
    this.start ??= this.hooks.configuration();
    this.hooks.reveal('goal');
    this.view.setEnds(this.start, this.goal);
    this.handle.show(this.toolPose(arm, this.goal));
  }

  private toolPose(arm: number, q: number[]): PoseData {
    const { kinematics } = this.view;
    const X_WL = kinematics.makePoses();
    kinematics.linkPoses(q, X_WL);
    return matrixPose(kinematics.toolPose(arm, X_WL, new Matrix4()));
  }

  private placeHandle(): void {
    if (this.arm >= 0 && this.goal && !this.handle.dragging) this.handle.place(this.toolPose(this.arm, this.goal));
  }

  /** One request at a time; of what came meanwhile only the last counts. */
  private drag(pose: PoseData): void {
    this.wanted = pose;
    if (this.query !== null) this.view.setObjects([]);  // A goal of one's own is planned in the cell of the scene.
    this.query = null;
    this.queries.value = '';
    if (!this.solving) void this.solve();
  }

  private async solve(): Promise<void> {
    this.solving = true;
    const { arms } = this.view.scene;
    while (this.wanted && this.arm >= 0 && this.goal) {
      const pose = this.wanted;
      this.wanted = null;
      try {
        const { q, touching } = await this.server.ik(arms[this.arm].name, this.goal, pose);
        this.goal = q;
        this.view.setEnds(this.start, q);
        this.clear();
        if (touching.length) this.report('The goal touches:', touching, q);
      } catch (error) {
        this.fail(error);
      }
    }
    this.solving = false;
  }

  // ---- planning

  private async plan(): Promise<void> {
    const start = this.fromHere.querySelector('input')!.checked ? this.hooks.configuration() : null;
    const common = { seed: this.seed.valueAsNumber || 0, preset: this.preset.value, strategy: this.strategy.value, deadline: this.deadline.valueAsNumber || 5 };
    this.clear();
    if (this.goal && (start || !this.query)) this.start = start ?? this.start;
    const ends = this.query && !start ? { query: this.query } : { start: this.start ?? undefined, goal: this.goal ?? undefined };
    this.planning = new AbortController();
    const begun = performance.now();
    const tick = () => (this.planButton.textContent = `Stop (${((performance.now() - begun) / 1000).toFixed(1)} s)`);
    const timer = setInterval(tick, 100);
    tick();
    try {
      const answer = await this.server.plan({ ...ends, ...common }, this.planning.signal);
      this.grab(-1);
      this.hooks.planned(answer);
      const ms = answer.plan.report.times_ms.total;
      this.result.className = 'result good';
      this.result.textContent = `Planned in ${ms.toFixed(ms < 10 ? 1 : 0)} ms.`;
    } catch (error) {
      this.fail(error);
    } finally {
      clearInterval(timer);
      this.planning = null;
      this.planButton.textContent = 'Plan';
    }
  }

  // ---- answers

  private clear(): void {
    this.result.className = 'result';
    this.result.replaceChildren();
    this.view.setTouching([], null);
  }

  private fail(error: unknown): void {
    const { message } = error as Error;
    const all = error instanceof Refusal ? error.touching : [];
    // Of one end at a time: there is one figure to mark it on.
    const end = all[0]?.end ?? 'goal';
    if (all.length) this.hooks.reveal(end);
    this.report(message, all.filter((pair) => (pair.end ?? end) === end), end === 'start' ? this.start : this.goal);
  }

  private report(message: string, touching: Touching[], q: number[] | null): void {
    const ends = [this.start, this.goal].filter((end) => end !== null);
    const outside = [...new Set(ends.flatMap((end) => outsideLimits(this.view.scene.joints, end)))];
    const deepestFirst = [...touching].sort((a, b) => a.distance - b.distance);
    const lines = [
      ...outside,
      ...deepestFirst.map(({ pair, distance }) => `${pair}: ${formatLength(Math.abs(distance))} ${distance < 0 ? 'deep' : 'apart'}`),
    ];
    const more = lines.splice(kListed).length;
    if (more) lines.push(`and ${more} more`);
    this.result.className = 'result bad';
    this.result.replaceChildren(el('p', {}, message), ...(lines.length ? [el('ul', {}, ...lines.map((line) => el('li', {}, line)))] : []));
    this.view.setTouching(touching, q);
  }
}
