/// The panels under the scene: joints against their limits, clearance over time.

import { TimeChart, type Drawing, type Series } from './chart';
import type { Clock } from './clock';
import { el, select } from './dom';
import { formatLength } from './markers';
import { colors, jointColor, type Theme } from './palette';
import type { CellMotion, Order } from './spline';
import type { ClearanceSample, LimitData, PlanData, SceneData } from './types';

/** What is being looked at. */
export interface Session {
  scene: SceneData;
  plan: PlanData | null;
  motion: CellMotion | null;
  clearance: ClearanceSample[];
}

/** A plot in the row under the scene; one that is not available takes no room. */
export interface Panel {
  readonly element: HTMLElement;
  available(session: Session): boolean;
  draw(session: Session, theme: Theme): void;
  setTime(t: number): void;
}

const kSamples = 500;
const quantities: { name: string; unit: string }[] = [
  { name: 'position', unit: '' },
  { name: 'velocity', unit: '/s' },
  { name: 'acceleration', unit: '/s²' },
  { name: 'jerk', unit: '/s³' },
];
const kDashes = [[], [7, 3], [2, 2.5], [], [10, 3, 2, 3], [4, 3], []];

function panel(title: string, tools: Node[], body: HTMLElement, legend?: HTMLElement): HTMLElement {
  const head = el('header', {}, el('h2', {}, title), ...tools);
  return el('section', { class: 'chart', 'aria-label': title }, head, body, ...(legend ? [legend] : []));
}

/** Centre and half range that a joint's values are measured by; null where it has no limit. */
export function limitScale(limits: LimitData, order: Order): { middle: number; half: number } | null {
  if (order === 0) {
    const { lower, upper } = limits;
    return lower === null || upper === null ? null : { middle: (lower + upper) / 2, half: (upper - lower) / 2 };
  }
  const bound = [limits.velocity, limits.acceleration, limits.jerk][order - 1];
  return bound === null ? null : { middle: 0, half: bound };
}

export class JointPanel implements Panel {
  readonly element: HTMLElement;
  private readonly plot = el('div', { class: 'plot' });
  private readonly legend = el('div', { class: 'legend', role: 'group', 'aria-label': 'Joints' });
  private readonly note = el('span', { class: 'note' });
  private readonly chart: TimeChart;
  private arm = -1;
  private order: Order = 1;
  private normalised = true;
  private only = -1;
  private session: Session | null = null;
  private theme: Theme = 'light';

  constructor(scene: SceneData, clock: Clock) {
    this.chart = new TimeChart(this.plot, clock);
    const arms: [string, string][] = [['-1', 'all arms'], ...scene.arms.map((arm, i): [string, string] => [String(i), arm.name])];
    const tools = [
      select('Quantity', quantities.map(({ name }, i): [string, string] => [String(i), name]), '1', (value) => {
        this.order = Number(value) as Order;
        this.redraw();
      }),
      select('Arm', arms, '-1', (value) => {
        this.arm = Number(value);
        this.only = -1;
        this.redraw();
      }),
      select('Scale', [['limit', 'of limit'], ['absolute', 'absolute']], 'limit', (value) => {
        this.normalised = value === 'limit';
        this.redraw();
      }),
      this.note,
    ];
    this.element = panel('Joints', tools, this.plot, this.legend);
  }

  available(session: Session): boolean {
    return session.motion !== null;
  }

  draw(session: Session, theme: Theme): void {
    this.session = session;
    this.theme = theme;
    this.redraw();
  }

  setTime(t: number): void {
    this.chart.setTime(t);
  }

  private redraw(): void {
    const { session, order, theme } = this;
    const motion = session?.motion;
    this.legend.replaceChildren();
    this.note.textContent = '';
    if (!session || !motion) return this.chart.draw(null);
    const { scene } = session;
    const chosen = scene.arms.flatMap((arm, i) =>
      this.arm === -1 || this.arm === i ? Array.from({ length: arm.dof }, (_, j) => ({ arm: i, joint: j, entry: arm.first + j })) : [],
    );
    const scales = chosen.map(({ entry }) => limitScale(scene.joints[entry], order));
    const normalised = this.normalised && scales.some((scale) => scale !== null);
    const missing = scales.filter((scale) => scale === null).length;
    const what = quantities[order].name;
    if (this.normalised && !normalised) this.note.textContent = `no ${what} limits`;
    else if (normalised && missing) this.note.textContent = `${missing} joints have no ${what} limit`;
    const times = motion.sampleTimes(kSamples);
    const q = new Array<number>(scene.joints.length).fill(0);
    const values = times.map((t) => [...motion.evaluate(t, order, q)]);
    const series = chosen.map(({ arm, joint, entry }, k): Series => {
      const scale = scales[k];
      const shown = (value: number): number | null => {
        if (!normalised) return value;
        return scale ? (value - scale.middle) / scale.half : null;
      };
      return {
        name: scene.joints[entry].name,
        values: values.map((row) => shown(row[entry])),
        color: jointColor(arm, joint, scene.arms[arm].dof, theme),
        dash: kDashes[joint % kDashes.length],
        width: 2,
      };
    });
    const unit = unitOf(scene, chosen.map(({ entry }) => entry), order);
    this.chart.draw({
      times,
      series,
      unit,
      range: normalised ? [-1, 1] : null,
      levels: normalised ? [1, -1].map((value) => ({ value, label: value > 0 ? 'limit' : '−limit', color: colors.alert[theme] })) : [],
      describe: (k, i) => describe(scene.joints[chosen[k].entry], values[i][chosen[k].entry], times[i], scales[k], unit),
    });
    this.fillLegend(session, chosen, series);
  }

  /** Press a joint to see it alone, again to see all. */
  private fillLegend(session: Session, chosen: { arm: number; joint: number }[], series: Series[]): void {
    session.scene.arms.forEach(({ name }, arm) => {
      const keys = chosen.map((entry, k) => ({ ...entry, k })).filter((entry) => entry.arm === arm);
      if (keys.length === 0) return;
      const group = el('span', { class: 'keys' }, el('span', { class: 'arm' }, name));
      this.legend.append(group);
      for (const { joint, k } of keys) {
        const key = el('button', { type: 'button', title: series[k].name, 'aria-label': `Only ${series[k].name}`, 'aria-pressed': 'false' });
        key.append(swatch(series[k]), String(joint + 1));
        key.addEventListener('click', () => {
          this.only = this.only === k ? -1 : k;
          this.applyOnly();
        });
        group.append(key);
      }
    });
    this.applyOnly();
  }

  private applyOnly(): void {
    const { only } = this;
    this.chart.showOnly(only < 0 ? null : (k) => k === only);
    this.legend.querySelectorAll('button').forEach((key, k) => key.setAttribute('aria-pressed', String(k === only)));
  }
}

function swatch({ color, dash }: Series): SVGSVGElement {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', '0 0 18 6');
  svg.setAttribute('class', 'swatch');
  svg.setAttribute('aria-hidden', 'true');
  svg.innerHTML = `<path d="M0 3h18" stroke="${color}" stroke-width="3" stroke-dasharray="${dash.join(' ')}"/>`;
  return svg;
}

function unitOf(scene: SceneData, entries: number[], order: Order): string {
  const sliding = (entry: number) => scene.links.some(({ joint }) => joint?.entry === entry && joint.multiplier === 1 && joint.type === 'prismatic');
  const kinds = new Set(entries.map((entry) => (sliding(entry) ? 'm' : 'rad')));
  return [...kinds].join(' or ') + quantities[order].unit;
}

function describe(joint: LimitData, value: number, t: number, scale: ReturnType<typeof limitScale>, unit: string): string {
  const share = scale ? `, ${((100 * (value - scale.middle)) / scale.half).toFixed(0)} % of its limit` : '';
  return `${joint.name}  ${value.toPrecision(3)} ${unit}${share}  at ${t.toFixed(3)} s`;
}

export class ClearancePanel implements Panel {
  readonly element: HTMLElement;
  private readonly plot = el('div', { class: 'plot' });
  private readonly least = el('span', { class: 'note' });
  private readonly chart: TimeChart;

  constructor(clock: Clock) {
    this.chart = new TimeChart(this.plot, clock);
    this.element = panel('Clearance', [this.least], this.plot);
  }

  available(session: Session): boolean {
    return session.clearance.length > 0;
  }

  draw({ clearance }: Session, theme: Theme): void {
    if (clearance.length === 0) return this.chart.draw(null);
    const color = colors.clearance[theme];
    const millimetres = clearance.map((sample) => sample.distance * 1e3);
    const least = clearance.reduce((best, sample) => (sample.distance < best.distance ? sample : best));
    this.least.textContent = `least ${formatLength(least.distance)} at ${least.t.toFixed(2)} s`;
    this.least.title = least.pair;
    const drawing: Drawing = {
      times: clearance.map((sample) => sample.t),
      series: [{ name: 'clearance', values: millimetres, color, dash: [], width: 2, fill: `${color}22` }],
      unit: 'mm',
      range: [0, 0],
      levels: [{ value: 0, label: 'contact', color: colors.alert[theme] }],
      describe: (_, i) => `${formatLength(clearance[i].distance)}  ${clearance[i].pair}  at ${clearance[i].t.toFixed(2)} s`,
    };
    this.chart.draw(drawing);
  }

  setTime(t: number): void {
    this.chart.setTime(t);
  }
}
