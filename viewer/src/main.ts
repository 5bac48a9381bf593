/// Puts the page together.

import { openSource, type PlanAnswer, type QueryAnswer, type Source } from './api';
import { captureIfAsked } from './capture';
import { Clock } from './clock';
import { button, byId, el, icon } from './dom';
import { bindKeys, showHelp } from './keys';
import { LivePanel } from './live';
import { MeshStore } from './meshes';
import type { Theme } from './palette';
import { ClearancePanel, JointPanel, type Panel, type Session } from './plots';
import { recordWebm } from './record';
import { reportSection } from './report';
import { CellView, type View } from './scene';
import { CellMotion } from './spline';
import './style.css';
import { Timeline } from './timeline';
import { togglesSection } from './toggles';
import type { ClearanceSample, PlanData } from './types';

const kKeptFrames = 600;
const kSlowFrame = 60;  // [ms]

class App {
  readonly frameTimes: number[] = [];
  readonly clock = new Clock();
  readonly view: CellView;
  private readonly panels: Panel[];
  private readonly timeline: Timeline;
  readonly live: LivePanel | null;
  private readonly session: Session;
  private readonly report = el('div');
  private readonly toggles = el('div');
  private theme: Theme = matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
  private q: number[];
  private scheduled = false;
  private moved = true;
  private last = 0;
  private pace = 0;
  private busy = false;

  constructor(source: Source, draft: boolean) {
    const { scene } = source;
    this.session = { scene, plan: null, motion: null, clearance: [] };
    document.documentElement.dataset.theme = this.theme;
    this.view = new CellView(byId<HTMLCanvasElement>('stage'), scene, this.theme, draft, () => this.invalidate());
    this.q = [...scene.home];
    this.panels = [new JointPanel(scene, this.clock), new ClearancePanel(this.clock)];
    byId('charts').append(...this.panels.map((panel) => panel.element));
    this.timeline = new Timeline(byId('transport'), this.clock, this.tools());
    this.live = source.server && new LivePanel(source.server, this.view, {
      configuration: () => [...this.q],
      planned: (answer) => this.planned(answer),
      reveal: (end) => {
        if (this.view.isOn(end)) return;
        this.view.toggle(end, true);
        this.sections();
      },
      ends: (query) => this.showEnds(query),
    });
    byId('side').append(...(this.live ? [this.live.element] : []), this.report, this.toggles);
    this.viewButtons();
    this.clock.onChange(() => {
      this.moved = true;
      this.timeline.update();
      this.invalidate();
    });
    bindKeys(this.clock, {
      frame: () => this.view.frame(),
      toggleTheme: () => this.setTheme(this.theme === 'light' ? 'dark' : 'light'),
      toggleCharts: () => this.toggleClass('charts'),
      togglePanels: () => this.toggleClass('panels'),
    });
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', (event) => this.setTheme(event.matches ? 'dark' : 'light'));
    new ResizeObserver(() => this.resize()).observe(byId('view'));
    this.resize();
    this.setPlan(source.plan, source.clearance ?? []);
  }

  /** Resolves when everything that the scene names has been loaded and drawn. */
  async load(source: Source): Promise<void> {
    if (!source.plan && this.live && source.scene.queries.length) await this.live.choose(source.scene.queries[0]);
    await this.view.parts.loadMeshes(new MeshStore(source.mesh), (link) => this.view.buildLink(link), (message) => this.notice(message));
    this.draw();
  }

  setPlan(plan: PlanData | null, clearance: ClearanceSample[]): void {
    const { session, view } = this;
    session.motion = plan && new CellMotion(plan, session.scene.arms);
    session.plan = plan;
    session.clearance = clearance;
    this.title();
    this.sections();
    view.setPlan(session.motion, plan?.phases ?? [], clearance);
    view.setEnds(plan?.start ?? null, plan?.goal ?? null);
    if (plan) this.live?.follow(plan.query, plan.start, plan.goal);
    this.timeline.set(session.motion, clearance);
    this.drawPanels();
    this.clock.reset(session.motion?.duration ?? 0);
    this.update();
    view.frameAgain();
  }

  setTheme(theme: Theme): void {
    this.theme = theme;
    document.documentElement.dataset.theme = theme;
    this.view.setTheme(theme);
    this.sections();
    this.drawPanels();
  }

  /** Moves everything to the time that is to be shown. */
  update(): void {
    this.moved = false;
    const t = this.clock.shown;
    this.session.motion?.evaluate(t, 0, this.q);
    this.view.show(this.q, t);
    for (const panel of this.panels) panel.setTime(t);
  }

  draw(): void {
    if (this.moved) this.update();
    this.view.render();
  }

  notice(message: string): void {
    const box = byId('notice');
    box.append(el('p', {}, message));
    setTimeout(() => box.firstChild?.remove(), 9000);
  }

  // ---- pictures

  async capture(width: number, height: number): Promise<Blob> {
    return this.alone(() => this.view.stage.at(width, height, () => {
      this.view.frameAgain();
      this.draw();
      return new Promise<Blob>((resolve, reject) => {
        this.view.stage.canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error('the picture could not be encoded'))), 'image/png');
      });
    }));
  }

  /** The whole motion once, at `speed` times its pace. */
  async record(fps: number, speed: number, width = 1280, height = 720): Promise<Blob> {
    const { clock, view } = this;
    const count = Math.max(1, Math.ceil((clock.duration / speed) * fps) + 1);
    [width, height] = [width - (width % 2), height - (height % 2)];  // Encoders halve the colours.
    return this.alone(() => view.stage.at(width, height, () => {
      view.frameAgain();
      return recordWebm(view.stage.canvas, {
        width,
        height,
        fps,
        count,
        draw: (i) => {
          clock.setTime((i * speed) / fps);
          this.draw();
        },
      });
    }));
  }

  /** Nothing else draws or moves meanwhile. */
  private async alone<Value>(work: () => Promise<Value>): Promise<Value> {
    if (this.busy) throw new Error('a picture is already being made');
    const playing = this.clock.playing;
    this.clock.pause();
    this.view.stage.setEconomy(0);
    this.busy = true;
    try {
      return await work();
    } finally {
      this.busy = false;
      this.view.frameAgain();
      if (playing) this.clock.play();
      this.invalidate();
    }
  }

  // ---- the frame

  invalidate(): void {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame((now) => this.frame(now));
  }

  private frame(now: number): void {
    this.scheduled = false;
    if (this.busy) return;
    const begun = performance.now();
    const seconds = Math.min((now - this.last) / 1000, 0.1);
    this.keepPace(now - this.last);
    this.last = now;
    this.clock.advance(seconds);
    this.view.stage.orbit.update();
    this.draw();
    this.frameTimes.push(performance.now() - begun);
    if (this.frameTimes.length > kKeptFrames) this.frameTimes.shift();
    if (this.clock.playing) this.invalidate();
  }

  /** Draws less well while playing where frames take long, and as well as possible when it stands. */
  private keepPace(interval: number): void {
    const { stage } = this.view;
    if (!this.clock.playing) {
      this.pace = 0;
      stage.setEconomy(0);
      return;
    }
    this.pace = 0.85 * this.pace + 0.15 * Math.min(interval, 400);
    if (this.pace < kSlowFrame || stage.economy === 2) return;
    this.pace = 0;
    stage.setEconomy(stage.economy + 1);
  }

  // ---- parts of the page

  private planned({ plan, clearance, objects }: PlanAnswer): void {
    this.view.setObjects(objects);
    this.setPlan(plan, clearance ?? []);
    this.clock.play();
  }

  private showEnds({ start, goal, objects }: QueryAnswer): void {
    this.view.setObjects(objects);
    this.setPlan(null, []);
    this.q = [...start];
    this.view.setEnds(start, goal);
    this.update();
    this.view.frameAgain();
  }

  private title(): void {
    const { scene, plan } = this.session;
    const [name, detail] = byId('title').children;
    name.textContent = scene.name;
    detail.textContent = plan?.query ?? '';
    document.title = plan ? `${scene.name}: ${plan.query} · tandem` : `${scene.name} · tandem`;
  }

  private sections(): void {
    const { plan } = this.session;
    this.report.replaceChildren(reportSection(plan));
    this.toggles.replaceChildren(togglesSection(this.view, plan, this.theme));
  }

  private drawPanels(): void {
    document.body.classList.toggle('no-charts', !this.panels.some((panel) => panel.available(this.session)));
    for (const panel of this.panels) {
      const available = panel.available(this.session);
      panel.element.hidden = !available;
      if (available) panel.draw(this.session, this.theme);
    }
  }

  private tools(): HTMLElement[] {
    return [
      button('Plots', icon('charts'), () => this.toggleClass('charts'), 'c'),
      button('Panels', icon('panels'), () => this.toggleClass('panels'), 'p'),
      button('Light or dark', icon('theme'), () => this.setTheme(this.theme === 'light' ? 'dark' : 'light'), 'd'),
      button('Help', icon('help'), showHelp, '?'),
    ];
  }

  private viewButtons(): void {
    const views: [View, string][] = [['home', 'Frame the robots'], ['front', 'Front'], ['side', 'Side'], ['top', 'Top']];
    for (const [view, label] of views) {
      const content = view === 'home' ? icon('home') : label;
      byId('views').append(button(view === 'home' ? label : `${label} view`, content, () => this.view.frame(view), view === 'home' ? 'f' : ''));
    }
  }

  /** On a small screen plots and panels begin hidden, so the class means the other way round. */
  private toggleClass(part: 'charts' | 'panels'): void {
    document.body.classList.toggle(`flip-${part}`);
  }

  private resize(): void {
    const { clientWidth, clientHeight } = byId('view');
    if (clientWidth === 0 || clientHeight === 0 || this.busy) return;
    this.view.stage.resize(clientWidth, clientHeight);
    this.view.frameAgain();
    this.draw();  // At once: a resized canvas is empty until then.
  }
}

/** "#t=0.5&paused&draft": the time to show, whether to stand still, and whether to draw coarsely. */
function readHash(): { t: number | null; paused: boolean; draft: boolean } {
  const values = new URLSearchParams(location.hash.slice(1));
  const t = Number.parseFloat(values.get('t') ?? '');
  return { t: Number.isFinite(t) ? t : null, paused: values.has('paused'), draft: values.has('draft') };
}

async function begin(): Promise<void> {
  const source = await openSource();
  const app = new App(source, readHash().draft);
  const { clock } = app;
  const follow = (first: boolean) => {
    const { t, paused } = readHash();
    if (t !== null) clock.setTime(t);
    if (paused) clock.pause();
    else if (first && !matchMedia('(prefers-reduced-motion: reduce)').matches) {
      const resume = clock.time;
      clock.play();
      if (t !== null) clock.setTime(resume);
    }
  };
  follow(true);
  window.addEventListener('hashchange', () => follow(false));
  Object.assign(window.tandem, {
    setTime: (t: number) => {
      clock.setTime(t);
      app.update();
    },
    play: () => clock.play(),
    pause: () => clock.pause(),
    frameTimes: () => [...app.frameTimes],
    handle: () => app.live?.handleOnPage ?? null,
    capture: (width: number, height: number) => app.capture(width, height),
    record: (fps: number, speed: number, width?: number, height?: number) => app.record(fps, speed, width, height),
  });
  Object.defineProperties(window.tandem, {
    duration: { get: () => clock.duration },
    time: { get: () => clock.shown },
    playing: { get: () => clock.playing },
  });
  await app.load(source);
}

declare global {
  interface Window {
    tandem: {
      ready: Promise<void>;
      setTime(t: number): void;
      play(): void;
      pause(): void;
      readonly duration: number;
      readonly time: number;
      readonly playing: boolean;
      frameTimes(): number[];
      /** Where on the page the goal's handle is drawn [px]. */
      handle(): [number, number] | null;
      capture(width: number, height: number): Promise<Blob>;
      record(fps: number, speed: number, width?: number, height?: number): Promise<Blob>;
    };
  }
}

const ready = Promise.resolve().then(begin);
window.tandem = { ready } as Window['tandem'];
ready.catch((error: Error) => {
  document.body.classList.add('failed');
  byId('notice').replaceChildren(el('p', { role: 'alert' }, error.message));
});
void captureIfAsked();
