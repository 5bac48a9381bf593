import { describe, expect, it } from 'vitest';
import { Clock } from '../src/clock';
import { formatLength } from '../src/markers';
import { armColor, jointColor, mix } from '../src/palette';
import { limitScale } from '../src/plots';
import { moduleTimes } from '../src/report';
import { writeWebm } from '../src/webm';

describe('the clock', () => {
  const make = (duration = 2) => {
    const clock = new Clock();
    clock.reset(duration);
    return clock;
  };

  it('plays at its speed, rests at the end and begins again', () => {
    const clock = make();
    clock.setSpeed(2);
    clock.play();
    clock.advance(0.5);
    expect(clock.time).toBe(1);
    clock.advance(0.7);
    expect(clock.time).toBe(2);
    clock.advance(0.5);
    expect(clock.time).toBe(2);
    clock.advance(0.5);
    expect(clock.time).toBe(0);
    expect(clock.playing).toBe(true);
  });

  it('stops at the end without a loop, and plays from the start again', () => {
    const clock = make();
    clock.setLoop(false);
    clock.play();
    clock.advance(3);
    clock.advance(0.1);
    expect([clock.time, clock.playing]).toEqual([2, false]);
    clock.toggle();
    expect([clock.time, clock.playing]).toEqual([0, true]);
  });

  it('previews only while standing', () => {
    const clock = make();
    clock.setTime(0.5);
    clock.preview(1.5);
    expect([clock.shown, clock.time]).toEqual([1.5, 0.5]);
    clock.preview(null);
    expect(clock.shown).toBe(0.5);
    clock.play();
    clock.preview(1.5);
    expect(clock.shown).toBe(0.5);
  });

  it('keeps to its time and its speeds', () => {
    const clock = make();
    clock.setTime(9);
    expect(clock.time).toBe(2);
    clock.setTime(-1);
    expect(clock.time).toBe(0);
    for (let i = 0; i < 9; ++i) clock.changeSpeed(1);
    expect(clock.speed).toBe(4);
    clock.changeSpeed(-1);
    expect(clock.speed).toBe(2);
    const empty = make(0);
    empty.play();
    expect(empty.playing).toBe(false);
  });
});

it('measures values by their limits', () => {
  const limits = { name: 'j', lower: -1, upper: 3, velocity: 2, acceleration: 5, jerk: null };
  expect(limitScale(limits, 0)).toEqual({ middle: 1, half: 2 });
  expect(limitScale({ ...limits, upper: null }, 0)).toBeNull();
  expect(limitScale(limits, 1)).toEqual({ middle: 0, half: 2 });
  expect(limitScale(limits, 3)).toBeNull();
});

it('splits the planning time by module', () => {
  const times = { path_planning: 6, simplification: 2, plpp: 0, distance: 7, total: 10 };
  expect(moduleTimes(times)).toEqual([['path_planning', 6], ['simplification', 2], ['other', 2]]);
});

it('says lengths in units that fit', () => {
  expect([0, 3.14e-6, 0.00002, 0.0058, -0.0123, 0.25].map(formatLength)).toEqual(['0.00 mm', '3.1 µm', '0.02 mm', '5.8 mm', '-12.3 mm', '25.0 cm']);
});

it('mixes colours and tells arms and joints apart', () => {
  expect(mix('#000000', '#ff8000', 0.5)).toBe('#804000');
  expect(armColor(0, 'light')).not.toBe(armColor(1, 'light'));
  expect(jointColor(0, 0, 7, 'light')).toBe(armColor(0, 'light'));
  expect(new Set([0, 1, 2, 3, 4, 5, 6].map((j) => jointColor(1, j, 7, 'dark'))).size).toBe(7);
});

describe('WebM', () => {
  const frames = [0, 40, 80, 120].map((time, i) => ({ data: new Uint8Array([i, 9]), time, key: i % 2 === 0 }));
  const file = Uint8Array.from(writeWebm(frames, 'V_VP9', 640, 360, 160).flatMap((part) => [...part]));

  /** Elements at one level, as [id, content]. */
  function parse(bytes: Uint8Array): [number, Uint8Array][] {
    const found: [number, Uint8Array][] = [];
    for (let at = 0; at < bytes.length;) {
      const width = Math.clz32(bytes[at]) - 23;
      const id = bytes.slice(at, at + width).reduce((sum, byte) => sum * 256 + byte, 0);
      at += width;
      expect(bytes[at]).toBe(1);
      const length = bytes.slice(at + 1, at + 8).reduce((sum, byte) => sum * 256 + byte, 0);
      at += 8;
      expect(at + length).toBeLessThanOrEqual(bytes.length);
      found.push([id, bytes.slice(at, at + length)]);
      at += length;
    }
    return found;
  }

  it('nests exactly and starts a cluster at every key frame', () => {
    const [[header], [segment, content]] = parse(file);
    expect([header, segment]).toEqual([0x1a45dfa3, 0x18538067]);
    const parts = parse(content);
    expect(parts.map(([id]) => id)).toEqual([0x1549a966, 0x1654ae6b, 0x1f43b675, 0x1f43b675]);
    const [time, first, second] = parse(parts[3][1]);
    expect(time).toEqual([0xe7, new Uint8Array([80])]);
    expect(first).toEqual([0xa3, new Uint8Array([0x81, 0, 0, 0x80, 2, 9])]);
    expect(second).toEqual([0xa3, new Uint8Array([0x81, 0, 40, 0, 3, 9])]);
  });

  it('says its size and duration', () => {
    const [, [, content]] = parse(file);
    const [[, info], [, tracks]] = parse(content);
    const duration = parse(info).find(([id]) => id === 0x4489)![1];
    expect(new DataView(duration.buffer).getFloat64(0)).toBe(160);
    const video = parse(parse(tracks)[0][1]).find(([id]) => id === 0xe0)![1];
    expect(parse(video).map(([, value]) => [...value])).toEqual([[2, 128], [1, 104]]);
  });
});
