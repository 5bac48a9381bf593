/// A plot over time that is linked with the clock.

import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import type { Clock } from './clock';
import { el } from './dom';

export interface Series {
  name: string;
  values: (number | null)[];
  color: string;
  dash: number[];
  width: number;
  fill?: string;
}

/** A horizontal line with a name. */
export interface Level {
  value: number;
  label: string;
  color: string;
}

export interface Drawing {
  times: number[];
  series: Series[];
  levels: Level[];
  /** Values that the axis shows at least. */
  range: [number, number] | null;
  unit: string;
  describe(series: number, index: number): string;
}

export class TimeChart {
  private plot: uPlot | null = null;
  private drawing: Drawing | null = null;
  private readonly playhead = el('div', { class: 'playhead' });
  private readonly tip = el('div', { class: 'tip', hidden: true });
  private readonly sizes: ResizeObserver;
  private focused = -1;
  private only: ((series: number) => boolean) | null = null;

  constructor(private readonly host: HTMLElement, private readonly clock: Clock) {
    this.sizes = new ResizeObserver(() => this.fit());
    this.sizes.observe(host);
  }

  draw(drawing: Drawing | null): void {
    this.plot?.destroy();
    this.plot = null;
    this.drawing = drawing;
    this.focused = -1;
    this.host.replaceChildren();
    if (!drawing) {
      this.host.append(el('p', { class: 'empty' }, 'Shown once there is a plan.'));
      return;
    }
    const data = [drawing.times, ...drawing.series.map((series) => series.values)] as uPlot.AlignedData;
    this.plot = new uPlot(this.options(drawing), data, this.host);
    this.plot.over.append(this.playhead, this.tip);
    this.plot.over.addEventListener('mouseleave', () => this.clock.preview(null));
    this.scrubWith(this.plot);
    this.showOnly(this.only);
    this.setTime(this.clock.shown);
  }

  /** Shows the series that `which` accepts; null shows all. */
  showOnly(which: ((series: number) => boolean) | null): void {
    this.only = which;
    const { plot } = this;
    plot?.batch(() => {
      this.drawing?.series.forEach((_, i) => plot.setSeries(i + 1, { show: which?.(i) ?? true }));
    });
  }

  setTime(t: number): void {
    if (!this.plot || !this.drawing) return;
    this.playhead.style.transform = `translateX(${this.plot.valToPos(t, 'x')}px)`;
  }

  private fit(): void {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (width < 40 || height < 40 || !this.plot) return;
    this.plot.setSize({ width, height });
    this.setTime(this.clock.shown);
  }

  private options(drawing: Drawing): uPlot.Options {
    const style = getComputedStyle(document.documentElement);
    const ink = style.getPropertyValue('--muted').trim();
    const lines = style.getPropertyValue('--line').trim();
    const axis: uPlot.Axis = {
      stroke: ink,
      font: '11px system-ui, sans-serif',
      grid: { stroke: lines, width: 1 },
      ticks: { stroke: lines, width: 1, size: 4 },
    };
    const range: uPlot.Scale.Range = (_, low, high) => {
      const bottom = Math.min(low ?? 0, drawing.range?.[0] ?? Infinity);
      const top = Math.max(high ?? 1, drawing.range?.[1] ?? -Infinity);
      const pad = 0.07 * (top - bottom || 1);
      return [bottom - pad, top + pad];
    };
    return {
      width: Math.max(this.host.clientWidth, 80),
      height: Math.max(this.host.clientHeight, 60),
      padding: [6, 10, 0, 0],
      legend: { show: false },
      focus: { alpha: 0.22 },
      cursor: {
        y: false,
        drag: { x: false, y: false, setScale: false },
        focus: { prox: 22 },
        points: { show: false },
      },
      scales: { x: { time: false, range: () => [0, drawing.times[drawing.times.length - 1] || 1] }, y: { range } },
      axes: [
        { ...axis, size: 26, gap: 3, space: 60, values: (_, ticks) => ticks.map((t) => `${+t.toFixed(3)} s`) },
        { ...axis, size: 50, gap: 3, space: 28 },
      ],
      series: [{}, ...drawing.series.map((series): uPlot.Series => ({
        stroke: series.color,
        width: series.width,
        dash: series.dash,
        fill: series.fill,
        points: { show: false },
      }))],
      hooks: {
        draw: [(plot) => drawLevels(plot, drawing.levels)],
        setSeries: [(_, i) => this.focus(i)],
        setCursor: [(plot) => this.hover(plot)],
      },
    };
  }

  private focus(series: number | null): void {
    this.focused = (series ?? 0) - 1;
    if (this.plot) this.hover(this.plot);
  }

  private hover(plot: uPlot): void {
    const { left = -1, idx } = plot.cursor;
    const inside = left >= 0 && idx !== null && idx !== undefined;
    this.tip.hidden = !inside;
    if (!inside || !this.drawing) return;
    const t = plot.posToVal(left, 'x');
    this.clock.preview(t);
    const only = this.drawing.series.length === 1 ? 0 : this.focused;
    this.tip.textContent = only >= 0 ? this.drawing.describe(only, idx) : `${t.toFixed(3)} s`;
    const half = plot.over.clientWidth / 2;
    this.tip.style.transform = left > half ? `translateX(calc(${left - 8}px - 100%))` : `translateX(${left + 8}px)`;
  }

  private scrubWith(plot: uPlot): void {
    const { over } = plot;
    const go = (event: PointerEvent) => {
      const x = event.clientX - over.getBoundingClientRect().left;
      this.clock.setTime(plot.posToVal(x, 'x'));
    };
    over.addEventListener('pointerdown', (event) => {
      over.setPointerCapture(event.pointerId);
      this.clock.pause();
      go(event);
    });
    over.addEventListener('pointermove', (event) => {
      if (over.hasPointerCapture(event.pointerId)) go(event);
    });
  }
}

function drawLevels(plot: uPlot, levels: Level[]): void {
  const g = plot.ctx;
  const ratio = devicePixelRatio;
  g.save();
  g.font = `${11 * ratio}px system-ui, sans-serif`;
  g.textAlign = 'right';
  for (const { value, label, color } of levels) {
    const y = plot.valToPos(value, 'y', true);
    if (!(y >= plot.bbox.top && y <= plot.bbox.top + plot.bbox.height)) continue;
    g.strokeStyle = g.fillStyle = color;
    g.lineWidth = 1.5 * ratio;
    g.setLineDash([6 * ratio, 4 * ratio]);
    g.beginPath();
    g.moveTo(plot.bbox.left, y);
    g.lineTo(plot.bbox.left + plot.bbox.width, y);
    g.stroke();
    g.textBaseline = y < plot.bbox.top + 16 * ratio ? 'top' : 'bottom';
    g.fillText(label, plot.bbox.left + plot.bbox.width - 4 * ratio, y + (g.textBaseline === 'top' ? 2 : -2) * ratio);
  }
  g.restore();
}
