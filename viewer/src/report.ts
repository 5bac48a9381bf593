/// What the planner says about its plan, in the side panel.

import { el, section } from './dom';
import { formatLength } from './markers';
import { moduleColors } from './palette';
import type { PlanData } from './types';

const words = (key: string): string => (key === 'plpp' ? 'path shortening' : key.replaceAll('_', ' '));

/** Modules that ran, in order, with what is left of the total as "other" [ms]. */
export function moduleTimes(times: Record<string, number>): [string, number][] {
  const parts = Object.entries(times).filter(([key, ms]) => key !== 'total' && key !== 'distance' && ms > 0);
  const rest = (times.total ?? 0) - parts.reduce((sum, [, ms]) => sum + ms, 0);
  if (rest > 0.01 * (times.total ?? 0)) parts.push(['other', rest]);
  return parts;
}

function milliseconds(ms: number): string {
  return ms >= 100 ? `${ms.toFixed(0)} ms` : ms >= 1 ? `${ms.toFixed(1)} ms` : `${ms.toFixed(2)} ms`;
}

function table(rows: [string, string][]): HTMLElement {
  return el('dl', {}, ...rows.flatMap(([key, value]) => [el('dt', {}, key), el('dd', {}, value)]));
}

function timeBar(times: Record<string, number>): HTMLElement {
  const parts = moduleTimes(times);
  const total = parts.reduce((sum, [, ms]) => sum + ms, 0) || 1;
  const text = parts.map(([key, ms]) => `${words(key)} ${milliseconds(ms)}`).join(', ');
  const color = (key: string) => moduleColors[key] ?? moduleColors.other;
  const bar = el('div', { class: 'bar', role: 'img', 'aria-label': text });
  const legend = el('ul', { class: 'modules' });
  for (const [key, ms] of parts) {
    const share = (100 * ms) / total;
    bar.append(el('i', { style: `width:${share}%;background:${color(key)}`, title: `${words(key)} ${milliseconds(ms)}` }));
    legend.append(el('li', {}, el('i', { style: `background:${color(key)}` }), el('span', {}, words(key)), el('b', {}, milliseconds(ms))));
  }
  const box = el('div', { class: 'times' }, bar, legend);
  if (times.distance) box.append(el('p', { class: 'hint' }, `${milliseconds(times.distance)} of it in distance computations`));
  return box;
}

export function reportSection(plan: PlanData | null): HTMLElement {
  if (!plan) return section('Plan', true, el('p', { class: 'hint' }, 'There is no plan yet.'));
  const { report, options } = plan;
  const clearance = report.least_clearance_m;
  const rungs = Object.entries(report.rungs).map(([name, count]) => `${words(name)} ×${count}`);
  const summary = table([
    ['Motion', `${report.motion_duration_s.toFixed(3)} s`],
    ['Planned in', milliseconds(report.times_ms.total ?? 0)],
    ['Certified clearance', clearance === null ? 'no pair to check' : clearance > 0 ? `≥ ${formatLength(clearance)}` : 'not certified'],
    ['Strategy', `${options.strategy}, ${options.preset}, seed ${plan.seed}`],
    ...(rungs.length ? [['Fallbacks', rungs.join(', ')] as [string, string]] : []),
  ]);
  const counts = table(Object.entries(report.counts).map(([key, count]) => [words(key), count.toLocaleString('en')]));
  const lengths = Object.entries(report.arms).map(([arm, { L_before, L_after, joint_length }]) => [
    arm,
    `${L_before.toFixed(2)} → ${L_after.toFixed(2)}, joints ${joint_length.toFixed(2)} rad`,
  ] as [string, string]);
  const more = el('details', { class: 'more' }, el('summary', {}, 'Counts and lengths'), counts, table(lengths));
  return section('Plan', true, summary, timeBar(report.times_ms), more);
}
