/// The keyboard, and the page that explains it.

import type { Clock } from './clock';
import { byId, el } from './dom';

const kFrame = 1 / 60;

export interface Actions {
  frame(): void;
  toggleTheme(): void;
  toggleCharts(): void;
  togglePanels(): void;
}

const keys: [string, string][] = [
  ['Space', 'play or pause'],
  ['← →', 'one frame back or on; with Shift 0.1 s'],
  ['Home End', 'to the start, to the end'],
  ['+ −', 'faster, slower'],
  ['L', 'loop'],
  ['F', 'frame the robots'],
  ['C', 'plots on and off'],
  ['P', 'panels on and off'],
  ['D', 'light or dark'],
  ['?', 'this help'],
];

const pointer: [string, string][] = [
  ['Drag', 'turn the view; with the right button, or two fingers, move it'],
  ['Wheel', 'zoom; with two fingers, pinch'],
  ['Plots', 'hover to look at a time, click to go there, drag to scrub'],
];

export function bindKeys(clock: Clock, actions: Actions): void {
  window.addEventListener('keydown', (event) => {
    const target = event.target as HTMLElement;
    if (event.ctrlKey || event.metaKey || event.altKey || target.closest('dialog')) return;
    if (target.closest('select, input:not([type=range]):not([type=checkbox])')) return;
    const isControl = target.closest('button, summary, input[type=checkbox]') !== null;
    if (isControl && (event.key === ' ' || event.key === 'Enter')) return;
    if (handle(event, clock, actions)) event.preventDefault();
  });
}

function handle({ key, shiftKey }: KeyboardEvent, clock: Clock, actions: Actions): boolean {
  const step = (direction: number) => {
    clock.pause();
    clock.setTime(clock.time + direction * (shiftKey ? 0.1 : kFrame));
  };
  const table: Record<string, () => void> = {
    ' ': () => clock.toggle(),
    ArrowLeft: () => step(-1),
    ArrowRight: () => step(1),
    Home: () => clock.setTime(0),
    End: () => clock.setTime(clock.duration),
    '+': () => clock.changeSpeed(1),
    '=': () => clock.changeSpeed(1),
    '-': () => clock.changeSpeed(-1),
    l: () => clock.setLoop(!clock.loop),
    f: () => actions.frame(),
    c: () => actions.toggleCharts(),
    p: () => actions.togglePanels(),
    d: () => actions.toggleTheme(),
    '?': () => showHelp(),
  };
  const action = table[key.length === 1 ? key.toLowerCase() : key];
  action?.();
  return action !== undefined;
}

export function showHelp(): void {
  const dialog = byId<HTMLDialogElement>('help');
  if (dialog.open) return;
  const rows = (entries: [string, string][]) =>
    entries.map(([key, what]) => el('tr', {}, el('th', { scope: 'row' }, el('kbd', {}, key)), el('td', {}, what)));
  dialog.replaceChildren(
    el('h2', { id: 'help-title' }, 'Keys and pointer'),
    el('table', {}, ...rows(keys), ...rows(pointer)),
    el('form', { method: 'dialog' }, el('button', { autofocus: true }, 'Close')),
  );
  dialog.showModal();
}
