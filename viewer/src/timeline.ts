/// The transport bar: play, scrub, speed, loop.

import type { Clock } from './clock';
import { kSpeeds } from './clock';
import { button, el, icon, select } from './dom';
import type { CellMotion } from './spline';
import type { ClearanceSample } from './types';

const kTicks = 10000;  // Steps of the slider.

export class Timeline {
  private readonly playButton: HTMLButtonElement;
  private readonly loopButton: HTMLButtonElement;
  private readonly slider: HTMLInputElement;
  private readonly marks = el('div', { class: 'marks', 'aria-hidden': 'true' });
  private readonly readout = el('output', { class: 'time', 'aria-label': 'Time' });
  private readonly speed: HTMLSelectElement;
  private icon: 'play' | 'pause' = 'play';

  constructor(host: HTMLElement, private readonly clock: Clock, tools: HTMLElement[]) {
    this.playButton = button('Play', icon('play'), () => clock.toggle(), 'space');
    this.playButton.classList.add('primary');
    this.loopButton = button('Loop', icon('loop'), () => clock.setLoop(!clock.loop), 'l');
    this.slider = el('input', { type: 'range', min: 0, max: kTicks, value: 0, step: 1, 'aria-label': 'Time of the motion' });
    this.slider.addEventListener('input', () => {
      const t = (this.slider.valueAsNumber / kTicks) * clock.duration;
      clock.pause();
      clock.setTime(t);
    });
    const speeds = kSpeeds.map((s): [string, string] => [String(s), `${s}×`]);
    this.speed = select('Speed', speeds, '1', (value) => clock.setSpeed(Number(value)));
    host.append(
      button('To the start', icon('first'), () => clock.setTime(0), 'home'),
      this.playButton,
      el('div', { class: 'scrub' }, this.marks, this.slider),
      this.readout,
      this.speed,
      this.loopButton,
      ...tools,
    );
    this.update();
  }

  /** Marks the knots of the motion and the time of least clearance. */
  set(motion: CellMotion | null, clearance: ClearanceSample[]): void {
    this.marks.replaceChildren();
    if (!motion || motion.duration <= 0) return;
    const place = (t: number) => `left:${((100 * t) / motion.duration).toFixed(3)}%`;
    const knots = new Set(motion.arms.flatMap((arm) => arm.breaks));
    for (const t of knots) this.marks.append(el('i', { style: place(t) }));
    if (clearance.length === 0) return;
    const least = clearance.reduce((best, sample) => (sample.distance < best.distance ? sample : best));
    this.marks.append(el('b', { style: place(least.t) }));
  }

  update(): void {
    const { clock } = this;
    const active = clock.duration > 0;
    const wanted = clock.playing ? 'pause' : 'play';
    if (wanted !== this.icon) {
      this.icon = wanted;
      this.playButton.replaceChildren(icon(wanted));
      this.playButton.setAttribute('aria-label', clock.playing ? 'Pause' : 'Play');
    }
    this.playButton.disabled = this.slider.disabled = !active;
    this.loopButton.setAttribute('aria-pressed', String(clock.loop));
    this.slider.value = String(active ? (kTicks * clock.shown) / clock.duration : 0);
    this.slider.style.setProperty('--done', `${active ? (100 * clock.shown) / clock.duration : 0}%`);
    this.slider.setAttribute('aria-valuetext', `${clock.shown.toFixed(2)} seconds`);
    this.readout.textContent = active ? `${clock.shown.toFixed(2)} / ${clock.duration.toFixed(2)} s` : 'no plan';
    this.speed.value = String(clock.speed);
  }
}
