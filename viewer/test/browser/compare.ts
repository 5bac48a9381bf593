/// Pictures against references, by what a person could see.

import { existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import pixelmatch from 'pixelmatch';
import { PNG } from 'pngjs';

/** Of the pixels; browsers differ by less, the smallest part of the cell is more. */
export const kTolerance = 0.002;
const kVisible = 0.1;  // Of the way from black to white, by pixelmatch's measure.

const references = resolve(process.cwd(), '../tests/viewer/pictures');
const out = resolve(process.cwd(), process.env.TANDEM_PICTURES ?? 'test/out');

/** Five bits a colour: nobody sees the rest, and files are a third. */
function coarse(bytes: Buffer): Buffer {
  const png = PNG.sync.read(bytes);
  png.data.forEach((value, i) => (png.data[i] = i % 4 === 3 ? value : (value & 0xf8) | 4));
  return PNG.sync.write(png);
}

/**
 * Compares with tests/viewer/pictures/NAME.png. What differs is written: the picture and where it
 * differs. With TANDEM_UPDATE_PICTURES the picture becomes the reference.
 * @param as  what the files are called that are written
 * @return an empty text, or what is wrong and where to look.
 */
export function compare(name: string, bytes: Buffer, as = name): string {
  const reference = join(references, `${name}.png`);
  if (process.env.TANDEM_UPDATE_PICTURES && as === name) {
    mkdirSync(references, { recursive: true });
    writeFileSync(reference, coarse(bytes));
  }
  const save = (kind: string, data: Buffer): string => {
    mkdirSync(out, { recursive: true });
    const file = join(out, `${as}.${kind}.png`);
    writeFileSync(file, data);
    return file;
  };
  if (!existsSync(reference)) return `${reference} does not exist; see it at ${save('actual', bytes)}`;
  const [actual, expected] = [PNG.sync.read(bytes), PNG.sync.read(readFileSync(reference))];
  const { width, height } = expected;
  if (actual.width !== width || actual.height !== height) {
    return `${save('actual', bytes)} is ${actual.width} x ${actual.height}, ${reference} is ${width} x ${height}`;
  }
  const difference = new PNG({ width, height });
  const count = pixelmatch(actual.data, expected.data, difference.data, width, height, { threshold: kVisible });
  const share = count / (width * height);
  if (share <= kTolerance) return '';
  return `${(100 * share).toFixed(2)} % of ${save('actual', bytes)} differ from ${reference}, ` +
    `${100 * kTolerance} % may: see ${save('diff', PNG.sync.write(difference))}`;
}
