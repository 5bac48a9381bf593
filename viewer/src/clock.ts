/// The time that is shown: playing, scrubbing, previewing.

export const kSpeeds = [0.1, 0.25, 0.5, 1, 2, 4];
const kHold = 0.9;  // [s] Rest at the end before a loop starts again.

export class Clock {
  duration = 0;
  loop = true;
  speed = 1;
  playing = false;
  private t = 0;
  private held = 0;
  private hovered: number | null = null;
  private readonly listeners: (() => void)[] = [];

  onChange(listener: () => void): void {
    this.listeners.push(listener);
  }

  /** What to show: the time under the pointer while one hovers over a plot, else the current. */
  get shown(): number {
    return this.hovered ?? this.t;
  }

  get time(): number {
    return this.t;
  }

  setTime(t: number): void {
    this.t = Math.min(Math.max(t, 0), this.duration);
    this.held = 0;
    this.hovered = null;
    this.notify();
  }

  /** Shows another time until null is given; while playing there is nothing to preview. */
  preview(t: number | null): void {
    const next = this.playing || t === null ? null : Math.min(Math.max(t, 0), this.duration);
    if (next === this.hovered) return;
    this.hovered = next;
    this.notify();
  }

  play(): void {
    if (this.duration <= 0) return;
    if (this.t >= this.duration) this.t = 0;
    this.playing = true;
    this.hovered = null;
    this.held = 0;
    this.notify();
  }

  pause(): void {
    this.playing = false;
    this.notify();
  }

  toggle(): void {
    if (this.playing) this.pause();
    else this.play();
  }

  setSpeed(speed: number): void {
    this.speed = speed;
    this.notify();
  }

  /** One step up or down the ladder of speeds. */
  changeSpeed(steps: number): void {
    const nearest = kSpeeds.reduce((best, s, i) => (Math.abs(s - this.speed) < Math.abs(kSpeeds[best] - this.speed) ? i : best), 0);
    this.setSpeed(kSpeeds[Math.min(Math.max(nearest + steps, 0), kSpeeds.length - 1)]);
  }

  setLoop(loop: boolean): void {
    this.loop = loop;
    this.notify();
  }

  reset(duration: number): void {
    this.duration = duration;
    this.t = 0;
    this.held = 0;
    this.hovered = null;
    if (duration <= 0) this.playing = false;
    this.notify();
  }

  /** @param seconds of wall time since the last call */
  advance(seconds: number): void {
    if (!this.playing) return;
    if (this.t >= this.duration) {
      this.held += seconds;
      if (!this.loop) this.playing = false;
      else if (this.held >= kHold) this.t = this.held = 0;
      else return;
    } else {
      this.t = Math.min(this.t + seconds * this.speed, this.duration);
    }
    this.notify();
  }

  private notify(): void {
    for (const listener of this.listeners) listener();
  }
}
