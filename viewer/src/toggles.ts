/// Switches for what the scene shows.

import { checkbox, el, section } from './dom';
import { armColor, type Theme } from './palette';
import type { CellView, Toggle } from './scene';
import type { PlanData } from './types';

const names: [Toggle, string][] = [
  ['visual', 'Robots'],
  ['volumes', 'Volumes'],
  ['padding', 'Padding'],
  ['obstacles', 'Obstacles'],
  ['frames', 'Frames'],
  ['clearance', 'Clearance'],
  ['goal', 'Goal'],
  ['start', 'Start'],
];

export function togglesSection(view: CellView, plan: PlanData | null, theme: Theme): HTMLElement {
  const box = ([toggle, label]: [Toggle, string]) => {
    const line = checkbox(label, view.isOn(toggle), (on) => view.toggle(toggle, on));
    line.dataset.toggle = toggle;
    if (toggle === 'padding' && !view.hasPadding) {
      line.classList.add('off');
      line.title = 'No body of this cell is padded';
      line.querySelector('input')!.disabled = true;
    }
    return line;
  };
  const grid = el('div', { class: 'grid' }, ...names.map(box));
  const arms = el('ul', { class: 'arms', 'aria-label': 'Colours of the arms' });
  view.scene.arms.forEach(({ name }, arm) => {
    arms.append(el('li', {}, el('i', { style: `background:${armColor(arm, theme)}` }), name));
  });
  const traces: [Toggle, string][] = [['motion', 'executed']];
  for (const { name } of plan?.phases ?? []) {
    view.phaseToggles.add(`phase:${name}`);
    traces.push([`phase:${name}`, name.replaceAll('_', ' ')]);
  }
  const paths = el('fieldset', {}, el('legend', {}, 'Tool paths'), el('div', { class: 'grid' }, ...traces.map(box)));
  return section('Show', true, arms, grid, ...(plan ? [paths] : []));
}
